#pragma once

/// @file
/// With the drone parked at home the sensors must say so: a reel whose zero is wrong, or an azimuth
/// turned round, is found before the first flight.

#include <cmath>
#include <optional>

#include <Eigen/Core>

#include "common/fields.h"
#include "common/tether_geometry.h"
#include "common/time.h"
#include "supervision/detect/findings.h"

namespace tautline {

struct ParkedCheckConfig {
  double length_tolerance_m{0.3};
  double azimuth_tolerance_rad{0.3};
  double least_reach_m{0.3};
  double azimuth_time_s{1.0};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("length_tolerance_m", length_tolerance_m, Range{0.01, 100},
            "between the parked tether length and home");
    v.field("azimuth_tolerance_rad", azimuth_tolerance_rad, Range{0.01, 4},
            "between the parked azimuth and home's");
    v.field("least_reach_m", least_reach_m, Range{0.05, 10},
            "a home horizontally nearer to the reel has no azimuth to compare with");
    v.field("azimuth_time_s", azimuth_time_s, Range{0.01, 60},
            "low pass of the azimuth: a tether that lies slack sways");
  }
};

/// kLengthUncalibrated, kAzimuthUncalibrated. Real-time safe: no allocation, no locks, no
/// exceptions.
class ParkedCheck {
 public:
  ParkedCheck(const ParkedCheckConfig& config, const Eigen::Vector3d& home_W) noexcept
      : config_(config), home_(home_W) {}

  /// Good readings while parked: total length [m], azimuth about the reel [rad]; absent otherwise.
  void update(Time now, std::optional<double> L_total, std::optional<double> phi,
              Findings& out) noexcept {
    if (L_total) {
      out.reportAbove(Condition::kLengthUncalibrated, std::abs(*L_total - home_.norm()),
                      config_.length_tolerance_m);
    }
    if (!phi || std::hypot(home_.x(), home_.z()) < config_.least_reach_m) {
      last_.reset();
      return;
    }
    const Eigen::Vector2d direction(std::sin(*phi), std::cos(*phi));
    const double dt = last_ ? toSeconds(now - *last_) : 0.0;
    const double gain = last_ ? 1.0 - std::exp(-dt / config_.azimuth_time_s) : 1.0;
    last_ = now;
    direction_ += gain * (direction - direction_);
    const double mean = std::atan2(direction_.x(), direction_.y());
    out.reportAbove(Condition::kAzimuthUncalibrated,
                    std::abs(wrapAngle(mean - std::atan2(home_.x(), home_.z()))),
                    config_.azimuth_tolerance_rad);
  }

 private:
  ParkedCheckConfig config_;
  Eigen::Vector3d home_;
  std::optional<Time> last_;
  Eigen::Vector2d direction_{Eigen::Vector2d::Zero()};  ///< Low-passed (sin, cos) of the azimuth.
};

}  // namespace tautline
