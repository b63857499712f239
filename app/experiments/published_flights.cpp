#include "app/experiments/published_flights.h"

#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <system_error>

#include <fmt/format.h>

#include "common/error.h"
#include "common/tether_geometry.h"

namespace tautline::experiments {
namespace {

namespace fs = std::filesystem;

constexpr int kRemoteControlled = 10;
constexpr int kIdle = 1;
constexpr int kFlies = 2;

/// Of all that is out.
std::string groundLine(double seconds, double length) {
  return fmt::format("!GSStatus {},{:.1f},16.4,{:.0f}\r\n", kRemoteControlled, seconds,
                     length / kLoggedMetresPerCount);
}

std::string positionLine(double elevation, double azimuth) {
  return fmt::format("!Pos {:.2f},{:.2f},0.00\r\n", kLoggedQuarterTurn - elevation, azimuth);
}

std::string flightLine(double seconds, int mode) {
  return fmt::format("!FlightStatus {},{:.1f},8.3,0\r\n", mode, seconds);
}

/// Runs a program without a shell; true if it ended well.
bool runs(std::vector<std::string> words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  int status = 0;
  return ::posix_spawnp(&child, arguments[0], nullptr, nullptr, arguments.data(), environ) == 0 &&
         ::waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

std::optional<fs::path> publishedLogs() {
  const char* const data = std::getenv("TAUTLINE_DATA");
  fs::path archive = fs::path(data != nullptr ? data : "../shared/data") / "fotokite_flight_logs" /
                     "2018-01_02.tar.xz";
  if (!fs::exists(archive)) return std::nullopt;
  return archive;
}

std::vector<fs::path> unpackLogs(const fs::path& archive, const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed || !runs({"tar", "-xJf", archive.string(), "-C", folder.string()})) {
    throw InputError({.file = archive.string(),
                      .problem = "cannot be unpacked into " + folder.string(),
                      .remedy = "install tar and xz-utils; make room there"},
                     ExitCode::kFailed);
  }
  std::vector<fs::path> logs;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".txt") logs.push_back(entry.path());
  std::sort(logs.begin(), logs.end());
  return logs;
}

std::vector<Telegram> telegramsOf(const Recording& recording, Duration parked,
                                  const Eigen::Vector3d& home) {
  std::vector<Telegram> telegrams;
  const Time first = recording.cycles.front().now;
  const TetherCoordinates at_home = toTether(home);
  const double azimuth_at_home = wrapAngle(at_home.phi - std::numbers::pi / 2.0);
  constexpr Duration kSecond = std::chrono::seconds(1);
  for (Time t = first; t < first + parked; t += kSecond) {
    const double seconds = toSeconds(t - first);
    telegrams.push_back({t, groundLine(seconds, at_home.L) +
                                positionLine(at_home.theta, azimuth_at_home) +
                                flightLine(seconds, kIdle)});
  }
  std::uint32_t reel = 0;
  std::uint32_t angles = 0;
  for (std::size_t i = 0; i < recording.cycles.size(); ++i) {
    const RecordedCycle& cycle = recording.cycles[i];
    const FlightLogRow& row = recording.poses[i].row;
    const double seconds = toSeconds(cycle.now - first + parked);
    std::string lines;
    if (cycle.sensors.reel.sequence != reel) lines += groundLine(seconds, row.length);
    if (cycle.sensors.angles.sequence != angles) {
      lines += flightLine(seconds, kFlies) + positionLine(row.elevation, row.azimuth);
    }
    reel = cycle.sensors.reel.sequence;
    angles = cycle.sensors.angles.sequence;
    if (!lines.empty()) telegrams.push_back({cycle.now + parked, lines});
  }
  return telegrams;
}

void TelegramPort::poll(Time now) noexcept {
  while (!telegrams_.empty() && telegrams_.front().time <= now) {
    due_ += telegrams_.front().line;
    telegrams_.pop_front();
  }
}

ReadResult TelegramPort::read(std::span<std::uint8_t> buffer) noexcept {
  const std::size_t count = std::min(buffer.size(), due_.size());
  std::copy_n(due_.begin(), count, buffer.begin());
  due_.erase(0, count);
  counters_.bytes_in += count;
  return {.count = count};
}

WriteResult TelegramPort::write(std::span<const std::uint8_t> message) noexcept {
  counters_.bytes_out += message.size();
  return {.accepted = true};
}

}  // namespace tautline::experiments
