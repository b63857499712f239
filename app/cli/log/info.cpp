// `tautline log info`: what is in a log, without looking at the flight itself (that is `report`).

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <tautline/mission_status_t.hpp>
#include <tautline/station_state_t.hpp>

#include "app/cli/log/log_command.h"
#include "app/log/event_log_reader.h"
#include "app/log/message_decoder.h"
#include "common/mission/mission_file.h"
#include "common/vehicle.h"
#include "control/motion_executor.h"
#include "lcmtypes/channels.h"
#include "supervision/supervisor.h"

namespace tautline::cli {
namespace {

struct Options {
  std::string log;
  bool json{false};
};

struct ChannelInfo {
  std::int64_t messages{};
  std::int64_t bytes{};
  std::int64_t first_utime{};
  std::int64_t last_utime{};
  std::string type;

  /// Between the first message and the last one [Hz]; 0 for a single one.
  [[nodiscard]] double rate() const {
    const auto span = static_cast<double>(last_utime - first_utime) * 1e-6;
    return span > 0.0 ? static_cast<double>(messages - 1) / span : 0.0;
  }
};

struct LogInfo {
  std::uint64_t bytes{};
  std::int64_t first_utime{};
  std::int64_t last_utime{};
  std::map<std::string, ChannelInfo, std::less<>> channels;
  std::vector<std::string> run_modes;  ///< In the order of their first appearance;
  std::vector<std::string> missions;   ///< so are these, hashes of what was flown.
  std::vector<std::string> modes;      ///< Every change.
  std::string damage;

  [[nodiscard]] double seconds() const {
    return static_cast<double>(last_utime - first_utime) * 1e-6;
  }
};

void addOnce(std::vector<std::string>& list, const std::string& item) {
  if (std::find(list.begin(), list.end(), item) == list.end()) list.push_back(item);
}

void addState(LogInfo& info, std::span<const std::uint8_t> data) {
  tautline::station_state_t state;
  if (state.decode(data.data(), 0, static_cast<int>(data.size())) < 0) return;
  addOnce(info.run_modes, nameOf(static_cast<RunMode>(state.run_mode), kRunModeNames));
  const std::string mode = nameOf(static_cast<Mode>(state.mode), kModeNames);
  if (info.modes.empty() || info.modes.back() != mode) info.modes.push_back(mode);
}

void addMission(LogInfo& info, std::span<const std::uint8_t> data) {
  tautline::mission_status_t status;
  if (status.decode(data.data(), 0, static_cast<int>(data.size())) < 0) return;
  // Take-off and landing run without a mission.
  if (status.mission_hash != 0 && static_cast<MissionState>(status.state) == MissionState::kRunning)
    addOnce(info.missions, hashText(static_cast<std::uint64_t>(status.mission_hash)));
}

LogInfo read(const std::string& file) {
  EventLogReader reader(file);
  LogInfo info;
  info.bytes = reader.fileSize();
  bool first = true;
  while (const auto event = reader.next()) {
    if (first) info.first_utime = info.last_utime = event->utime;
    first = false;
    info.first_utime = std::min(info.first_utime, event->utime);
    info.last_utime = std::max(info.last_utime, event->utime);
    ChannelInfo& channel = info.channels[std::string(event->channel)];
    if (channel.messages++ == 0) {
      channel.first_utime = event->utime;
      const MessageInfo* type = findMessage(event->data);
      channel.type = type == nullptr ? "unknown" : type->name;
    }
    channel.last_utime = event->utime;
    channel.bytes += static_cast<std::int64_t>(event->data.size());
    if (event->channel == channel::kStationState) addState(info, event->data);
    if (event->channel == channel::kMissionStatus) addMission(info, event->data);
  }
  info.damage = summary(reader.damage());
  return info;
}

std::string timeText(std::int64_t utime) {
  return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC",
                     fmt::gmtime(static_cast<std::time_t>(utime / 1'000'000)));
}

std::string joined(const std::vector<std::string>& items, const char* between) {
  return items.empty() ? "none" : fmt::format("{}", fmt::join(items, between));
}

void printJson(const Options& options, const LogInfo& info) {
  nlohmann::ordered_json channels = nlohmann::ordered_json::array();
  for (const auto& [name, c] : info.channels)
    channels.push_back({{"channel", name},
                        {"type", c.type},
                        {"messages", c.messages},
                        {"rate_hz", c.rate()},
                        {"bytes", c.bytes}});
  fmt::print("{}\n", nlohmann::ordered_json{{"log", options.log},
                                            {"bytes", info.bytes},
                                            {"start_utime_us", info.first_utime},
                                            {"end_utime_us", info.last_utime},
                                            {"duration_s", info.seconds()},
                                            {"run_modes", info.run_modes},
                                            {"missions", info.missions},
                                            {"modes", info.modes},
                                            {"damage", info.damage},
                                            {"channels", channels}}
                         .dump());
}

void print(const Options& options, const LogInfo& info) {
  fmt::print("{}\n", options.log);
  fmt::print("  {:10} {} to {}, {:.1f} s\n", "time", timeText(info.first_utime),
             timeText(info.last_utime), info.seconds());
  fmt::print("  {:10} {} bytes, {}\n", "file", info.bytes,
             info.damage.empty() ? "whole" : info.damage);
  fmt::print("  {:10} {}\n", "run mode", joined(info.run_modes, ", "));
  fmt::print("  {:10} {}\n", "missions", joined(info.missions, ", "));
  fmt::print("  {:10} {}\n", "modes", joined(info.modes, " > "));
  fmt::print("  {:18} {:28} {:>9} {:>9} {:>11}\n", "channel", "type", "messages", "Hz", "bytes");
  for (const auto& [name, c] : info.channels)
    fmt::print("  {:18} {:28} {:9} {:9.2f} {:11}\n", name, c.type, c.messages, c.rate(), c.bytes);
}

ExitCode run(const Options& options) {
  const LogInfo info = read(options.log);
  options.json ? printJson(options, info) : print(options, info);
  return ExitCode::kOk;
}

}  // namespace

void addLogInfo(CLI::App& log, ExitCode& result) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb =
      log.add_subcommand("info", "Time, channels, run mode, missions and modes of a log");
  verb->add_option("log", options->log, "LCM log, whole or damaged")->required()->type_name("LOG");
  verb->add_flag("--json", options->json, "One JSON object for machines");
  verb->footer(
      "Example: tautline log info flight.lcm\nWhat happened in the flight: tautline report");
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace tautline::cli
