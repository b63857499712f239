#pragma once

/// @file
/// What estimation tells control, supervision and telemetry: where the drone is and how far that
/// can be trusted.

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "common/fields.h"
#include "common/time.h"

namespace tautline {

/// The active anchor A: the reel outlet, or the last contact point of the contact stack.
struct Anchor {
  Eigen::Vector3d p_WA{Eigen::Vector3d::Zero()};  ///< [m] in W.
  double L_static{0.0};  ///< Tether along the contacts, reel to A [m], >= 0.
  int contact_count{0};  ///< 0 = the reel outlet itself.
};

enum class EstimateHealth : std::uint8_t {
  kOk,
  kDegraded,  ///< Usable, with less than the full model: nominal tension, straight line, or samples
              ///< getting old.
  kLost,      ///< Do not act on it.
};
inline constexpr std::array<EnumName<EstimateHealth>, 3> kEstimateHealthNames{
    {{EstimateHealth::kOk, "ok"},
     {EstimateHealth::kDegraded, "degraded"},
     {EstimateHealth::kLost, "lost"}}};

/// Output of the localizer for one cycle.
struct Estimate {
  bool valid{false};  ///< False: no position has ever been available; all else is then meaningless.
  EstimateHealth health{EstimateHealth::kLost};
  Eigen::Vector3d p_WD{Eigen::Vector3d::Zero()};            ///< Drone in W [m].
  Eigen::Vector3d v_WD{Eigen::Vector3d::Zero()};            ///< [m/s]
  Eigen::Matrix3d P_position{Eigen::Matrix3d::Identity()};  ///< Covariance of p_WD [m^2].
  double L_free{0.0};         ///< Free tether arc length A to D, scale-corrected [m].
  double theta_tangent{0.0};  ///< Tangent elevation at D, bias-corrected [rad].
  double phi{0.0};            ///< Azimuth of D about A, zero-corrected [rad], in (-pi, pi].
  double T{0.0};              ///< Tether tension at D [N].
  double sigma_T{0.0};        ///< Its standard deviation [N].
  double reel_scale{1.0};     ///< True metres per nominal metre of the encoder.
  double sigma_reel_scale{0.0};
  double elevation_bias{0.0};  ///< Sensed minus true tangent elevation [rad].
  double azimuth_zero{0.0};    ///< Sensed minus true azimuth [rad].
  double nis{0.0};  ///< Normalized innovation squared of the last update, low-passed; about 1 per
                    ///< degree of freedom.

  /// May be acted on. Real-time safe: no allocation, no locks, no exceptions.
  [[nodiscard]] bool usable() const noexcept { return valid && health != EstimateHealth::kLost; }
};

}  // namespace tautline
