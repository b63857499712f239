#pragma once

/// @file
/// With the drone parked at home the sensors must say so: a reel whose zero is wrong, or an azimuth
/// turned round, is found before the first flight.

#include <cmath>
#include <optional>

#include <Eigen/Core>

#include "common/fields.h"
#include "common/tether_geometry.h"
#include "supervision/detect/findings.h"

namespace tautline {

struct ParkedCheckConfig {
  double length_tolerance_m{0.3};
  double azimuth_tolerance_rad{0.3};
  double least_reach_m{0.3};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("length_tolerance_m", length_tolerance_m, Range{0.01, 100},
            "between the parked tether length and home");
    v.field("azimuth_tolerance_rad", azimuth_tolerance_rad, Range{0.01, 4},
            "between the parked azimuth and home's");
    v.field("least_reach_m", least_reach_m, Range{0.05, 10},
            "a home horizontally nearer to the reel has no azimuth to compare with");
  }
};

/// kLengthUncalibrated, kAzimuthUncalibrated. Real-time safe: no allocation, no locks, no
/// exceptions.
class ParkedCheck {
 public:
  ParkedCheck(const ParkedCheckConfig& config, const Eigen::Vector3d& home_W) noexcept
      : config_(config), home_(home_W) {}

  /// Good readings while parked: total length [m], azimuth about the reel [rad]; absent otherwise.
  void update(std::optional<double> L_total, std::optional<double> phi,
              Findings& out) const noexcept {
    if (L_total) {
      out.reportAbove(Condition::kLengthUncalibrated, std::abs(*L_total - home_.norm()),
                      config_.length_tolerance_m);
    }
    if (phi && std::hypot(home_.x(), home_.z()) >= config_.least_reach_m) {
      out.reportAbove(Condition::kAzimuthUncalibrated,
                      std::abs(wrapAngle(*phi - std::atan2(home_.x(), home_.z()))),
                      config_.azimuth_tolerance_rad);
    }
  }

 private:
  ParkedCheckConfig config_;
  Eigen::Vector3d home_;
};

}  // namespace tautline
