#include "app/bench/replay.h"

#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <lcm/lcm-cpp.hpp>
#include <tautline/command_t.hpp>
#include <tautline/mission_chunk_t.hpp>
#include <tautline/params_t.hpp>

#include "app/station/telemetry.h"
#include "common/error.h"
#include "common/toml/config_file.h"
#include "lcmtypes/channels.h"

namespace tautline::bench {
namespace {

Time timeOf(std::int64_t ns) noexcept { return Time(Duration(ns)); }

template <class T>
void fill(Sample<T>& sample, std::int64_t time_ns, std::int32_t sequence, bool valid) noexcept {
  sample.time = timeOf(time_ns);
  sample.sequence = static_cast<std::uint32_t>(sequence);
  sample.valid = valid;
}

std::optional<double> optional(bool has, double value) noexcept {
  return has ? std::optional(value) : std::nullopt;
}

/// A COMMAND without its hash and utime: what was commanded.
std::vector<std::uint8_t> payloadOf(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kHeader = 16;
  return bytes.size() < kHeader ? std::vector<std::uint8_t>{}
                                : std::vector<std::uint8_t>(bytes.begin() + kHeader, bytes.end());
}

/// Keeps the COMMAND that a Telemetry encodes last.
class CommandCatcher final : public TelemetrySink {
 public:
  bool publish(const char* channel, std::int64_t /*utime*/,
               std::span<const std::uint8_t> bytes) noexcept override {
    if (std::strcmp(channel, channel::kCommand) == 0) last_ = payloadOf(bytes);
    return true;
  }
  [[nodiscard]] const std::vector<std::uint8_t>& last() const noexcept { return last_; }

 private:
  std::vector<std::uint8_t> last_;
};

using ChunkKey = std::pair<std::int64_t, std::int32_t>;

/// What a first pass over the log collects.
struct Contents {
  std::optional<StationConfig> config;
  std::map<ChunkKey, tautline::mission_chunk_t> chunks;
  std::vector<tautline::station_input_t> inputs;
  std::map<std::int64_t, std::vector<std::uint8_t>> commands;  ///< Payloads by utime.
};

Contents readLog(const std::filesystem::path& path) {
  lcm::LogFile log(path.string(), "r");
  if (!log.good())
    throw InputError({.file = path.string(), .problem = "cannot be read as an LCM log"});
  Contents out;
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    const auto* data = static_cast<const std::uint8_t*>(event->data);
    const auto decode = [&](auto& message) {
      return message.decode(event->data, 0, event->datalen) >= 0;
    };
    tautline::params_t params;
    tautline::mission_chunk_t chunk;
    tautline::station_input_t input;
    if (event->channel == channel::kParams && !out.config && decode(params)) {
      out.config = parseConfig<StationConfig>(params.toml, path.string() + " (PARAMS)");
    } else if (event->channel == channel::kMissionChunk && decode(chunk)) {
      out.chunks[{chunk.session, chunk.sequence}] = chunk;
    } else if (event->channel == channel::kStationInput && decode(input)) {
      out.inputs.push_back(input);
    } else if (event->channel == channel::kCommand) {
      tautline::command_t command;
      if (decode(command))
        out.commands[command.utime] = payloadOf({data, static_cast<std::size_t>(event->datalen)});
    }
  }
  if (!out.config || out.inputs.empty()) {
    throw InputError({.file = path.string(),
                      .problem = "has no PARAMS or no STATION_INPUT messages",
                      .remedy = "record all channels from the station's start on"});
  }
  return out;
}

}  // namespace

StepInput inputOf(const tautline::station_input_t& m) noexcept {
  StepInput in;
  in.now = timeOf(m.now_ns);
  in.consecutive_overruns = m.loop_overruns;
  if (m.has_command) {
    in.command =
        OperatorCommand{m.command_session, m.command_sequence, static_cast<Request>(m.command_verb),
                        static_cast<std::uint64_t>(m.command_mission_hash)};
  }
  SensorFrame& f = in.sensors;
  fill(f.reel, m.reel_time_ns, m.reel_sequence, m.reel_valid);
  f.reel.value = {m.reel_counts, m.reel_length_m, optional(m.reel_has_tension, m.reel_tension_n)};
  fill(f.angles, m.angles_time_ns, m.angles_sequence, m.angles_valid);
  f.angles.value = {m.elevation_rad, m.azimuth_rad, optional(m.has_altitude, m.altitude_m)};
  fill(f.attitude, m.attitude_time_ns, m.attitude_sequence, m.attitude_valid);
  const double(&q)[4] = m.attitude_wxyz;
  f.attitude.value.R_WB = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
  fill(f.gimbal, m.gimbal_time_ns, m.gimbal_sequence, m.gimbal_valid);
  f.gimbal.value.pitch = m.gimbal_pitch_rad;
  fill(f.vehicle, m.vehicle_time_ns, m.vehicle_sequence, m.vehicle_valid);
  f.vehicle.value = {static_cast<VehiclePhase>(m.vehicle_phase),
                     static_cast<std::uint8_t>(m.flight_mode),
                     static_cast<std::uint16_t>(m.vehicle_flags), m.backup_battery_v};
  fill(f.ground, m.ground_time_ns, m.ground_sequence, m.ground_valid);
  f.ground.value = {static_cast<std::uint8_t>(m.ground_mode), m.ground_battery_v};
  f.link = {m.link_connected != 0,
            static_cast<std::uint64_t>(m.link_bytes_in),
            static_cast<std::uint64_t>(m.link_bytes_out),
            static_cast<std::uint32_t>(m.link_lines_ok),
            static_cast<std::uint32_t>(m.link_lines_bad),
            static_cast<std::uint32_t>(m.link_bytes_dropped),
            static_cast<std::uint32_t>(m.link_reconnects)};
  return in;
}

ReplayResult replay(const std::filesystem::path& path) {
  const Contents log = readLog(path);
  const auto station = std::make_unique<Station>(log.config->core);
  CommandCatcher catcher;
  // State messages every cycle: whichever cycle a recorded command is from, it can be compared.
  Telemetry telemetry(catcher, log.config->run_mode, Duration::zero(), Duration::zero());

  ReplayResult result;
  for (const tautline::station_input_t& message : log.inputs) {
    StepInput in = inputOf(message);
    if (message.chunk_sequence != 0) {
      const auto chunk = log.chunks.find({message.chunk_session, message.chunk_sequence});
      if (chunk == log.chunks.end())
        throw InputError({.file = path.string(), .problem = "a MISSION_CHUNK is missing"});
      in.chunk = &chunk->second;
    }
    telemetry.publish(in, station->step(in));
    ++result.cycles;
    const auto recorded = log.commands.find(message.utime);
    if (recorded == log.commands.end()) continue;
    ++result.commands_compared;
    if (catcher.last() == recorded->second) continue;
    if (result.differences++ == 0)
      result.first_difference = "COMMAND at utime " + std::to_string(message.utime);
  }
  return result;
}

}  // namespace tautline::bench
