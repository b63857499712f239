#pragma once

/// @file
/// Makes up for a band of commanded length rates in which the reel does not move.

#include "common/fields.h"
#include "common/time.h"

namespace tautline {

/// The reference device stands still when told to reel in at 120 to 200 counts/s, at 2.85 mm per
/// count. min_rate = max_rate: no band.
struct ReelDeadZoneConfig {
  double min_rate_mps{-0.570};
  double max_rate_mps{-0.342};
  double dwell_s{0.2};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("min_rate_mps", min_rate_mps, Range{-30.0, 30.0},
            "lower edge of the band, pay-out positive");
    v.field("max_rate_mps", max_rate_mps, Range{-30.0, 30.0}, "upper edge of the band");
    v.field("dwell_s", dwell_s, Range{0.0, 5.0},
            "least time on one edge: shorter than the reel can follow is no use");
  }
};

/// A rate inside the band becomes a switching between the rates next to it that do work (the band's
/// edges, or rest where the band touches zero), so that the paid-out length is right on average,
/// eq. (C11). Rates outside pass unchanged. The output never exceeds the band's edges, and rest
/// stays rest.
class ReelDeadZone {
 public:
  explicit ReelDeadZone(const ReelDeadZoneConfig& config) noexcept : config_(config) {}

  /// `rate` and result [m/s]; not finite gives 0. Real-time safe: no allocation, no locks, no
  /// exceptions.
  [[nodiscard]] double compensate(Duration dt, double rate) noexcept;

  /// Real-time safe: no allocation, no locks, no exceptions.
  void reset() noexcept;

 private:
  ReelDeadZoneConfig config_;
  double owed_{0.0};  ///< Length asked for and not yet paid out [m].
  double output_{0.0};
  double dwelt_{0.0};  ///< Time on the present output [s].
  bool active_{false};
};

}  // namespace tautline
