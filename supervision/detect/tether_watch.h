#pragma once

/// @file
/// What the pull on the tether tells: slack, too much of it, caught, broken. Equations (D1)–(D4) of
/// docs/supervisor.md.

#include <optional>

#include <Eigen/Core>

#include "common/fields.h"
#include "common/time.h"
#include "supervision/detect/findings.h"

namespace tautline {

struct TetherWatchConfig {
  double max_tension_n{4.0};
  double slack_excess_m{0.1};
  double slack_fraction{0.03};
  double reel_margin_m{0.1};
  double snag_tension_n{3.0};
  double snag_motion_m{0.3};
  double snag_fraction{0.3};
  double snag_window_s{2.0};
  double broken_tension_n{0.05};
  double broken_time_s{1.5};
  double broken_pay_out_m{0.1};
  double settle_s{5.0};
  double elevation_high_rad{1.396};
  double least_lean_angle_rad{0.17};
  double lean_error_rad{0.01};
  double lean_time_s{1.0};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("max_tension_n", max_tension_n, Range{0.1, 1000}, "a harder pull is over-tension");
    v.field("slack_excess_m", slack_excess_m, Range{0.01, 10},
            "tether beyond the straight line that is slack ...");
    v.field("slack_fraction", slack_fraction, Range{0, 1}, "... plus this part of the free length");
    v.field("reel_margin_m", reel_margin_m, Range{0, 10},
            "so much before core.limits.tether_length_m the reel is at its end");
    v.field("snag_tension_n", snag_tension_n, Range{0.1, 1000},
            "a pull like this while nothing moves is a snag ...");
    v.field("snag_motion_m", snag_motion_m, Range{0.05, 10},
            "... when this much motion was commanded ...");
    v.field("snag_fraction", snag_fraction, Range{0, 1},
            "... and less than this part came of it ...");
    v.field("snag_window_s", snag_window_s, Range{0.5, 60}, "... over this time");
    v.field("broken_tension_n", broken_tension_n, Range{0.001, 100}, "a weaker pull is none ...");
    v.field("broken_time_s", broken_time_s, Range{0.1, 60}, "... and for this long ...");
    v.field("broken_pay_out_m", broken_pay_out_m, Range{0.01, 10},
            "... without so much paid out, a broken tether");
    v.field("settle_s", settle_s, Range{0, 60}, "after take-off before the pull is judged");
    v.field("elevation_high_rad", elevation_high_rad, Range{0.5, 1.57},
            "elevation that the Jacobian law cannot fly");
    v.field("least_lean_angle_rad", least_lean_angle_rad, Range{0.01, 1.5},
            "between thrust and tether; below it the lean tells no tension");
    v.field("lean_error_rad", lean_error_rad, Range{0, 0.5},
            "of attitude and drag: slack is only what no lean within it explains");
    v.field("lean_time_s", lean_time_s, Range{0.01, 60}, "low pass of the lean");
  }
};

struct TetherWatchInput {
  bool flying{false};
  double L_total{0.0};             ///< Sensed [m].
  double L_max{0.0};               ///< On the reel [m].
  double L_free{0.0};              ///< Anchor to drone [m].
  double theta{0.0};               ///< Tangent elevation at the drone [rad].
  double phi{0.0};                 ///< [rad]
  double lean_angle{1.5708};       ///< Thrust to tether, beta - theta [rad].
  std::optional<double> T_lean{};  ///< At the drone, from its lean [N]; 0: no pull. Absent: not
                                   ///< observable.
  double T_lean_error{0.0};        ///< It may be off by this much [N].
  std::optional<double> T_reel{};  ///< Of the reel's own sensor [N].
  double w{0.06};                  ///< Weight per length [N/m].
  double length_rate{0.0};         ///< Commanded [m/s], as are the following.
  double elevation_rate{0.0};      ///< [rad/s]
  double azimuth_rate{0.0};        ///< [rad/s]
};

/// kTetherSlack, kOverTension, kTetherSnagged, kTetherBroken, kReelLimit, kTensionUnobservable,
/// kElevationHigh. Real-time safe: no allocation, no locks, no exceptions.
class TetherWatch {
 public:
  explicit TetherWatch(const TetherWatchConfig& config) noexcept : config_(config) {}

  void update(Time now, const TetherWatchInput& in, Findings& out) noexcept;

 private:
  using Motion = Eigen::Vector3d;  ///< Along the tether, up and across it [m].

  void watchSlack(const TetherWatchInput& in, std::optional<double> T_most,
                  Findings& out) const noexcept;
  void watchSnag(double dt, const TetherWatchInput& in, std::optional<double> T,
                 Findings& out) noexcept;
  void watchBreak(Time now, const TetherWatchInput& in, std::optional<double> T,
                  Findings& out) noexcept;

  TetherWatchConfig config_;
  std::optional<Time> last_;
  std::optional<Time> flying_since_;
  std::optional<TetherWatchInput> before_;
  Motion commanded_{Motion::Zero()};  ///< Over the last snag_window_s, forgotten exponentially.
  Motion moved_{Motion::Zero()};
  Time pulled_{};           ///< When there was a pull last, ...
  double pulled_length_{};  ///< ... and the length then [m].
  bool has_pulled_{false};  ///< Since take-off.
};

}  // namespace tautline
