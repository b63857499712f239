#include "app/log/flight_recorder.h"

#include <algorithm>
#include <cstring>
#include <ctime>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <tautline/mission_status_t.hpp>
#include <tautline/station_state_t.hpp>

#include "app/log/log_folder.h"
#include "app/log/message_decoder.h"
#include "common/error.h"
#include "common/mission/mission_file.h"
#include "common/vehicle.h"
#include "control/motion_executor.h"
#include "lcmtypes/channels.h"
#include "supervision/supervisor.h"

namespace tautline {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;

constexpr Duration kSilence = seconds(3);
constexpr Duration kRetry = seconds(1);
// Messages; an endless flood must not take all memory.
constexpr std::size_t kRingLimit = 200'000;
constexpr std::size_t kLastingLimit = 256;  // the longest mission has fewer pieces

constexpr const char* kNoMission = "no-mission";

/// What a message of a rarely sent kind is of: the program of PARAMS, the piece of a mission. The
/// last one of each is put in front of every log. Empty: another kind.
std::string lastingKey(const std::string& channel, std::span<const std::uint8_t> data) {
  const bool params = channel == channel::kParams;
  if (!params && channel != channel::kMissionChunk) return {};
  const MessageInfo* info = findMessage(data);
  const auto message = info == nullptr ? std::nullopt : decode(*info, data);
  if (!message) return {};
  if (params && message->contains("program"))
    return channel + (*message)["program"].get<std::string>();
  if (!params && message->contains("mission_hash"))
    return channel + ((*message)["kind"].dump() + '/' + (*message)["first"].dump());
  return {};
}

}  // namespace

FlightRecorder::FlightRecorder(FlightRecorderConfig config,
                               std::function<void(const std::string&)> say)
    : config_(std::move(config)), say_(std::move(say)) {}

FlightRecorder::~FlightRecorder() { close(); }

void FlightRecorder::onMessage(const std::string& channel, std::int64_t utime,
                               std::span<const std::uint8_t> data, Time now) {
  if (channel == channel::kStationState) onState(utime, data, now);
  if (channel == channel::kMissionStatus && log_ && !named_) onMission(data);
  if (log_) append(channel, utime, data, now);
  keepForStart(channel, utime, data, now);
}

void FlightRecorder::keepForStart(const std::string& channel, std::int64_t utime,
                                  std::span<const std::uint8_t> data, Time now) {
  Message message{channel, utime, {data.begin(), data.end()}, now};
  const std::string key = lastingKey(channel, data);
  if (!key.empty() && (lasting_.size() < kLastingLimit || lasting_.contains(key)))
    lasting_[key] = message;
  ring_.push_back(std::move(message));
  while (ring_.front().heard < now - config_.before || ring_.size() > kRingLimit) ring_.pop_front();
}

void FlightRecorder::onState(std::int64_t utime, std::span<const std::uint8_t> data, Time now) {
  tautline::station_state_t state;
  if (state.decode(data.data(), 0, static_cast<int>(data.size())) < 0) return;
  if (silent_) say_("the station is heard again");
  silent_ = false;
  last_state_ = now;
  const auto mode = static_cast<Mode>(state.mode);
  run_mode_ = nameOf(static_cast<RunMode>(state.run_mode), kRunModeNames);
  if (mode != Mode::kStandby) {
    standby_since_.reset();
    if (!log_) begin(utime, now);
  } else if (log_ && !standby_since_) {
    standby_since_ = now;
  }
}

void FlightRecorder::onMission(std::span<const std::uint8_t> data) {
  tautline::mission_status_t status;
  if (status.decode(data.data(), 0, static_cast<int>(data.size())) < 0) return;
  // One that does not run may be that of an earlier flight.
  if (static_cast<MissionState>(status.state) == MissionState::kRunning)
    nameByMission(status.mission_hash);
}

fs::path FlightRecorder::freeName(const std::string& mission) const {
  fs::path path = config_.folder / fmt::format("{}_{}_{}.lcm", start_time_, mission, run_mode_);
  // A machine without a clock of its own may live through the same second twice.
  for (int i = 2; fs::exists(path); ++i)
    path = config_.folder / fmt::format("{}_{}_{}_{}.lcm", start_time_, mission, run_mode_, i);
  return path;
}

void FlightRecorder::begin(std::int64_t utime, Time now) {
  if (now < next_try_) return;
  start_time_ = fmt::format("{:%Y-%m-%dT%H-%M-%SZ}",
                            fmt::gmtime(static_cast<std::time_t>(utime / 1'000'000)));
  named_ = false;
  enforceQuota();
  try {
    const fs::path path = freeName(kNoMission);
    log_ = std::make_unique<EventLogWriter>(path);
    file_ = path;
  } catch (const InputError& error) {
    say_(std::string("not recording: ") + error.what());
    next_try_ = now + kRetry;
    return;
  }
  say_("recording " + file_.string());
  for (const auto& [key, message] : lasting_) {
    if (message.heard < now - config_.before)
      append(message.channel, message.utime, message.data, now);
  }
  for (const Message& message : ring_) append(message.channel, message.utime, message.data, now);
}

void FlightRecorder::append(const std::string& channel, std::int64_t utime,
                            std::span<const std::uint8_t> data, Time now) {
  if (disk_full_ && now < next_try_) {
    log_->skip();
  } else if (!log_->write(channel, utime, data)) {
    onDisk(false, now);
  }
}

void FlightRecorder::nameByMission(std::int64_t mission_hash) {
  if (mission_hash == 0) return;
  constexpr std::size_t kDigits = 8;
  const fs::path path =
      freeName(hashText(static_cast<std::uint64_t>(mission_hash)).substr(0, kDigits));
  std::error_code error;
  fs::rename(file_, path, error);
  named_ = true;
  if (error) {
    say_(fmt::format("{} keeps its name: {}", file_.string(), error.message()));
    return;
  }
  file_ = path;
  say_("mission known: " + file_.string());
}

void FlightRecorder::onDisk(bool good, Time now) {
  if (good) {
    if (!disk_full_) return;
    disk_full_ = false;
    say_(fmt::format("there is room on the disk again; {} events of {} are lost", log_->lost(),
                     file_.string()));
    return;
  }
  next_try_ = now + kRetry;
  if (disk_full_) return;
  disk_full_ = true;
  say_(fmt::format("{} cannot be written: {}; what comes is counted as lost until there is room",
                   file_.string(), std::strerror(errno)));
}

void FlightRecorder::enforceQuota() {
  for (const fs::path& path : keepQuota(config_.folder, config_.quota))
    say_(fmt::format("quota of {} bytes: deleted {}", config_.quota, path.string()));
}

void FlightRecorder::tick(Time now) {
  if (started_ == Time{}) started_ = now;
  if (!silent_ && now - last_state_.value_or(started_) > kSilence) {
    silent_ = true;
    say_(log_ ? "the station is silent in flight; recording goes on"
              : "no station is heard; waiting for one");
  }
  if (!log_) return;
  // With nothing to write, a full disk would pass for one with room.
  if (now >= next_sync_ && log_->unflushed() > 0) {
    onDisk(log_->sync(), now);
    next_sync_ = now + config_.sync_period;
    enforceQuota();
  }
  if (standby_since_ && now - *standby_since_ >= config_.after) close();
}

void FlightRecorder::close() {
  if (!log_) return;
  log_->sync();
  say_(fmt::format("closed {}: {} events, {} lost", file_.string(), log_->written(), log_->lost()));
  lost_before_ += log_->lost();
  log_.reset();
  file_.clear();
  standby_since_.reset();
  disk_full_ = false;
}

}  // namespace tautline
