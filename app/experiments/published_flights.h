#pragma once

/// @file
/// The flight logs that the dissertation's authors published: where they are, and one of them as
/// what the device said, line by line. docs/real_logs.md. Not real-time safe.

#include <deque>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/station/recording.h"
#include "drivers/byte_port.h"

namespace tautline::experiments {

/// The archive of logs in the folder of TAUTLINE_DATA (default: ../shared/data); nothing if it is
/// not there.
[[nodiscard]] std::optional<std::filesystem::path> publishedLogs();

/// Unpacks the archive into `folder` (made if it is not there). Returns its logs by name. Throws
/// InputError.
[[nodiscard]] std::vector<std::filesystem::path> unpackLogs(const std::filesystem::path& archive,
                                                            const std::filesystem::path& folder);

/// What the machine that wrote the logs took for the length of a count [m].
inline constexpr double kLoggedMetresPerCount = 0.00406;
/// What its program took for a quarter of a turn: logged elevations have two decimals, as the wire
/// has, which pi/2 minus a wire value would not [rad].
inline constexpr double kLoggedQuarterTurn = 1.57;

/// A line that the device sent, with its end, and when.
struct Telegram {
  Time time{};
  std::string line;
};

/// A length or direction that is new in the recording, as the line that brought it: whole counts,
/// angles of two decimals; in flight the vehicle's status comes with every direction. Before them,
/// for `parked`, which all of them are late by, the lines of a vehicle that stands at `home` with
/// its tether taut, once a second.
/// What the logs do not have is not made up, but for the fields that a line must have: voltages of
/// a full battery, run time, height 0; so attitude and barometer must not be used. Pre-condition:
/// text log.
[[nodiscard]] std::vector<Telegram> telegramsOf(const Recording& recording, Duration parked,
                                                const Eigen::Vector3d& home);

/// The device's end of a cable that brings telegrams when they are due, and takes whatever is sent.
class TelegramPort final : public BytePort {
 public:
  explicit TelegramPort(std::vector<Telegram> telegrams)
      : telegrams_(telegrams.begin(), telegrams.end()) {}

  void poll(Time now) noexcept override;
  [[nodiscard]] ReadResult read(std::span<std::uint8_t> buffer) noexcept override;
  WriteResult write(std::span<const std::uint8_t> message) noexcept override;
  [[nodiscard]] bool connected() const noexcept override { return true; }
  [[nodiscard]] PortCounters counters() const noexcept override { return counters_; }
  [[nodiscard]] LinkFault fault() const noexcept override { return LinkFault::kNone; }

 private:
  std::deque<Telegram> telegrams_;
  std::string due_;
  PortCounters counters_;
};

}  // namespace tautline::experiments
