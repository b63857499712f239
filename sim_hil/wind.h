#pragma once

/// @file
/// Indoor air: a steady wind plus first-order coloured gusts (Dryden's longitudinal spectrum in the
/// time domain), stronger near walls and more so between them: in corners and shafts the rotors'
/// own air comes back from several sides.

#include <Eigen/Core>

#include "common/fields.h"
#include "sim_hil/random.h"

namespace tautline::sim {

struct WindConfig {
  Eigen::Vector3d mean{Eigen::Vector3d::Zero()};  ///< [m/s] in W.
  double gust{0.1};                               ///< Standard deviation of each component [m/s].
  double gust_time{1.5};                          ///< Correlation time [s].
  double wall_factor{1.0};                        ///< Extra gust at a wall, relative to `gust`;
                                                  ///< each side with a wall adds to it.
  double wall_distance{0.5};                      ///< Over which that extra decays by e [m].

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("mean_mps", mean, Range{-20, 20}, "steady wind in W");
    v.field("gust_mps", gust, Range{0, 10}, "standard deviation of each component");
    v.field("gust_time_s", gust_time, Range{0.05, 60}, "correlation time");
    v.field("wall_factor", wall_factor, Range{0, 10},
            "extra gust at a wall, relative to gust_mps; each wall adds");
    v.field("wall_distance_m", wall_distance, Range{0.01, 10}, "decay length of that extra");
  }
};

class Wind {
 public:
  explicit Wind(const WindConfig& config) noexcept : config_(config) {}

  /// Draws the air for the next h [s] where there is `confinement` (Obstacles::confinement).
  /// Real-time safe: no allocation, no locks, no exceptions.
  void step(double h, double confinement, Random& random) noexcept {
    const double keep = std::exp(-h / config_.gust_time);
    const double sigma = config_.gust * (1.0 + config_.wall_factor * confinement);
    gust_ = keep * gust_ + sigma * std::sqrt(1.0 - keep * keep) * random.normal3();
  }

  /// Air velocity in W [m/s].
  [[nodiscard]] Eigen::Vector3d velocity() const noexcept { return config_.mean + gust_; }

 private:
  WindConfig config_;
  Eigen::Vector3d gust_{Eigen::Vector3d::Zero()};
};

}  // namespace tautline::sim
