#pragma once

/// @file
/// What is wrong with a link that is there: from what arrives and how much of it means anything.

#include <cstdint>
#include <span>

#include "common/time.h"
#include "common/vehicle.h"

namespace tautline {

/// Totals since the start; a device fills in what its protocol has.
struct LinkTraffic {
  bool connected{false};
  std::uint64_t bytes{0};
  std::uint64_t text_bytes{0};  ///< Of these, printable characters and line ends.
  std::uint32_t good{0};        ///< Messages that were used.
  std::uint32_t bad{0};         ///< Messages that were not.
  std::uint32_t foreign{0};     ///< Whole messages of something else.
};

/// How many of `bytes` are printable ASCII or white space. Real-time safe: no allocation, no locks,
/// no exceptions.
[[nodiscard]] inline std::uint64_t countText(std::span<const std::uint8_t> bytes) noexcept {
  std::uint64_t count = 0;
  for (const std::uint8_t b : bytes)
    count += (b >= 0x20 && b < 0x7F) || b == '\n' || b == '\r' || b == '\t' ? 1U : 0U;
  return count;
}

/// Judges once a window. What is heard ends a silence, or a row of garbage, at once.
class LinkMonitor {
 public:
  /// `window`: longer than the slowest of the device's messages takes.
  explicit LinkMonitor(Duration window) noexcept : window_(window) {}

  /// Once a cycle. Of the faults of LinkFault only kSilent, kGarbage, kOtherProtocol and
  /// kUnreliable come from here; kNone while not connected. Real-time safe: no allocation, no
  /// locks, no exceptions.
  [[nodiscard]] LinkFault update(Time now, const LinkTraffic& total) noexcept;

 private:
  [[nodiscard]] LinkFault judge(const LinkTraffic& total) const noexcept;

  Duration window_;
  bool started_{false};
  Time window_start_{};
  LinkTraffic at_start_;
  LinkFault fault_{LinkFault::kNone};
};

}  // namespace tautline
