#include "app/bench/replay.h"

#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <tautline/command_t.hpp>
#include <tautline/mission_chunk_t.hpp>
#include <tautline/params_t.hpp>

#include "app/log/event_log_reader.h"
#include "app/log/log_version.h"
#include "app/station/input_message.h"
#include "app/station/telemetry.h"
#include "common/error.h"
#include "common/toml/config_file.h"
#include "lcmtypes/channels.h"

namespace tautline::bench {
namespace {

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

using ChunkKey = std::pair<std::int64_t, std::int64_t>;

/// Whether that program's PARAMS are a station's configuration; a simulator has one, too.
bool isStation(const tautline::params_t& params) {
  return params.program == "tautline-station" || params.program == "tautline-bench";
}

/// What a first pass over the log collects.
struct Contents {
  StationConfig config;
  std::map<ChunkKey, tautline::mission_chunk_t> chunks;
  std::vector<tautline::station_input_t> inputs;
  std::map<std::int64_t, std::vector<std::uint8_t>> commands;  ///< Payloads by utime.
  std::string damage;  ///< Of the file, as ReplayResult has it.
};

Contents readLog(const std::filesystem::path& path) {
  EventLogReader log(path);
  Contents out;
  std::optional<std::string> config;
  LogVersion version;
  while (const auto event = log.next()) {
    const auto decode = [&](auto& message) {
      return version.fits<std::remove_reference_t<decltype(message)>>(*event) &&
             message.decode(event->data.data(), 0, static_cast<int>(event->data.size())) >= 0;
    };
    tautline::params_t params;
    tautline::mission_chunk_t chunk;
    tautline::station_input_t input;
    if (event->channel == channel::kParams && !config && decode(params) && isStation(params)) {
      config = params.toml;
    } else if (event->channel == channel::kMissionChunk && decode(chunk)) {
      out.chunks[{chunk.session, chunk.sequence}] = chunk;
    } else if (event->channel == channel::kStationInput && decode(input)) {
      out.inputs.push_back(input);
    } else if (event->channel == channel::kCommand) {
      tautline::command_t command;
      if (decode(command)) out.commands[command.utime] = payloadOf(event->data);
    }
  }
  version.check(path);
  out.damage = summary(log.damage());
  if (!config || out.inputs.empty()) {
    throw InputError({.file = path.string(),
                      .problem = "has no PARAMS or no STATION_INPUT messages",
                      .remedy = "record all channels from the station's start on"});
  }
  out.config = parseConfig<StationConfig>(*config, path.string() + " (PARAMS)");
  return out;
}

}  // namespace

ReplayResult replay(const std::filesystem::path& path, const Playback& playback) {
  const Contents log = readLog(path);
  const auto station = std::make_unique<Station>(log.config.core);
  CommandCatcher catcher;
  // State messages every cycle: whichever cycle a recorded command is from, it can be compared.
  Telemetry telemetry(catcher, log.config.run_mode, Duration::zero(), Duration::zero());

  ReplayResult result;
  result.damage = log.damage;
  PlaybackClock clock(playback);
  for (const tautline::station_input_t& message : log.inputs) {
    StepInput in = inputOf(message);
    if (message.chunk_sequence != 0) {
      const auto chunk = log.chunks.find({message.chunk_session, message.chunk_sequence});
      if (chunk == log.chunks.end())
        throw InputError({.file = path.string(), .problem = "a MISSION_CHUNK is missing"});
      in.chunk = &chunk->second;
    }
    const StepOutput& out = station->step(in);
    telemetry.publish(in, out);
    clock.cycle(Duration(message.now_ns - log.inputs.front().now_ns), out.estimate);
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
