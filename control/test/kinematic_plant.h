#pragma once

/// @file
/// The simplest vehicle that still shows what a tether does to control: no forces, but lag,
/// latency, limits and noise. Tests only. 20 Hz.

#include <array>
#include <random>

#include <Eigen/Core>

#include "common/estimate.h"
#include "control/controller.h"

namespace tautline::testing {

struct PlantConfig {
  enum class Kind {
    kRate,  ///< Commanded rates move the drone from where it is.
    kRef,   ///< Commanded rates move set-points, which the drone follows: a tether-stabilized
            ///< vehicle.
  };
  Kind kind{Kind::kRef};
  /// True: elevation ends at 89.5 deg (kRef), or folds over at the pole (kRate). False: it goes on,
  /// azimuth stays.
  bool stops_at_pole{true};
  double lag{0.25};      ///< First order [s].
  int latency_steps{3};  ///< Of 50 ms, commands.
  double noise{0.5};     ///< Direction noise, each of two axes [deg].
  VehicleLimits limits{
      .length_rate_mps = 0.6, .elevation_rate_radps = 0.6, .azimuth_rate_radps = 1.0};
  Eigen::Vector3d p_WA{Eigen::Vector3d::Zero()};
};

inline constexpr double kPlantStep = 0.05;  ///< [s]

class KinematicPlant {
 public:
  KinematicPlant(const PlantConfig& config, const Eigen::Vector3d& p_WD, unsigned seed);

  /// Moves on by kPlantStep under this command (as it was `latency_steps` ago).
  void step(const RateCommand& command);

  /// What a localizer would say now.
  [[nodiscard]] Estimate measure();

  [[nodiscard]] Eigen::Vector3d position() const { return config_.p_WA + p_AD_; }

 private:
  void moveByRates(const Eigen::Vector3d& u, double dt);
  void moveSetPoints(const Eigen::Vector3d& u, double dt);

  PlantConfig config_;
  Eigen::Vector3d p_AD_;
  Eigen::Vector3d q_;  ///< L, theta, phi: set-points, or the unfolded state.
  Eigen::Vector3d u_{Eigen::Vector3d::Zero()};  ///< Rates after the lag (kRate).
  std::array<Eigen::Vector3d, 16> queue_{};     ///< Commands under way.
  std::size_t head_{0};
  std::mt19937 random_;
};

}  // namespace tautline::testing
