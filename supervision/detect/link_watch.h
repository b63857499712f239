#pragma once

/// @file
/// How much of what the device sends is damaged.

#include <cstdint>
#include <optional>

#include "common/fields.h"
#include "common/time.h"
#include "supervision/detect/findings.h"

namespace tautline {

struct LinkWatchConfig {
  double bad_fraction{0.1};
  double window_s{2.0};
  int least_messages{20};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("bad_fraction", bad_fraction, Range{0, 1}, "of all messages: more are too many");
    v.field("window_s", window_s, Range{0.1, 60}, "counted over this time");
    v.field("least_messages", least_messages, Range{1, 100000},
            "in that time; of fewer nothing is said");
  }
};

/// kCrcRate. Real-time safe: no allocation, no locks, no exceptions.
class LinkWatch {
 public:
  explicit LinkWatch(const LinkWatchConfig& config) noexcept : config_(config) {}

  /// Messages since start, as the driver counts them.
  void update(Time now, std::uint32_t good, std::uint32_t bad, Findings& out) noexcept;

 private:
  struct Count {
    Time time{};
    std::uint32_t good{0};
    std::uint32_t bad{0};
  };

  LinkWatchConfig config_;
  std::optional<Count> start_;  ///< Of the present window.
  double fraction_{0.0};        ///< Bad ones in the last whole window.
};

}  // namespace tautline
