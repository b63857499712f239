#pragma once

/// @file
/// Published velocity control (dissertation section 5.2.2): straight at the segment's end with
/// constant speed, through the inverse Jacobian. Trapped at the pole (docs/control.md); kept for
/// comparison.

#include "control/controller.h"

namespace tautline {

struct VelocityLawConfig {
  double speed_mps{0.1};
  double stop_distance_m{0.1};
  bool total_length{false};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("speed_mps", speed_mps, Range{0.01, 2.0}, "alpha, the one speed of this law");
    v.field("stop_distance_m", stop_distance_m, Range{0.0, 2.0},
            "slow down within this distance of a point to stop at");
    v.field("total_length", total_length,
            "as the published code: total instead of free length in the Jacobian");
  }
};

/// u = J^-1 alpha e/|e|, each rate clamped by itself, eq. (C2).
class VelocityLaw final : public Controller {
 public:
  explicit VelocityLaw(const VelocityLawConfig& config) noexcept : config_(config) {}

  [[nodiscard]] RateCommand update(Duration dt, const ControlInput& in) noexcept override;
  void reset() noexcept override {}
  [[nodiscard]] const char* name() const noexcept override { return "velocity"; }

 private:
  VelocityLawConfig config_;
};

}  // namespace tautline
