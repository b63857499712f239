#pragma once

/// @file
/// The extended Kalman filter behind the localizer: state, prediction with commanded rates, and one
/// update for each kind of reading. Equations (15)-(23) of docs/tether_model.md. It knows no
/// samples, clocks or health; estimation/localizer.h does.
///
/// State x, 11 numbers: p_WD, v_WD, ln T, reel scale s, azimuth zero, elevation bias, altitude
/// offset. SI, radians. Everything here is real-time safe: no allocation, no locks, no exceptions.

#include <Eigen/Core>

#include "common/estimate.h"
#include "common/tether_geometry.h"
#include "common/time.h"
#include "common/vehicle.h"
#include "estimation/localizer_config.h"

namespace tautline {

/// The free segment that reaches a point at a tension, with the derivatives the updates need.
struct TetherSegment {
  double L{};                  ///< Arc length [m].
  double theta_D{};            ///< Tangent elevation at D [rad].
  double phi{};                ///< Azimuth of D about A [rad].
  double T{};                  ///< Tension at D that was used: at least kTensionMargin T_min [N].
  Eigen::RowVector3d L_p;      ///< dL/dp_WD
  Eigen::RowVector3d theta_p;  ///< dtheta_D/dp_WD [rad/m]
  Eigen::RowVector3d phi_p;    ///< cos(theta_D) dphi/dp_WD [rad/m]: finite at the pole.
  double L_log_T{};            ///< dL/d(ln T)
  double theta_log_T{};        ///< dtheta_D/d(ln T)
};

/// Segment from the anchor to p_AD at tension T [N] (raised to kTensionMargin T_min) and weight per
/// length w. Within 5 cm of the anchor it is that of the point 5 cm away in the same direction
/// (upwards at the anchor itself).
[[nodiscard]] TetherSegment segmentTo(const Eigen::Vector3d& p_AD, double T, double w) noexcept;

/// What an update did.
struct Innovation {
  bool accepted{false};  ///< False: beyond the gate or not finite; the state is as before.
  double nis{0.0};       ///< Normalized innovation squared, per degree of freedom.
};

class TetherFilter {
 public:
  static constexpr int kSize = 11;
  using State = Eigen::Matrix<double, kSize, 1>;
  using Covariance = Eigen::Matrix<double, kSize, kSize>;
  /// Where each quantity starts in the state.
  enum Index : int {
    kP = 0,
    kV = 3,
    kLogT = 6,
    kScale = 7,
    kAzimuthZero = 8,
    kElevationBias = 9,
    kAltitudeOffset = 10
  };

  explicit TetherFilter(const LocalizerConfig& config) noexcept;

  /// Prior of section 5 at rest at p0_WD; height readings are relative to it.
  void reset(const Eigen::Vector3d& p0_WD) noexcept;

  /// At rest at p_WD with position uncertainty `sigma_p` and velocity uncertainty `sigma_v`; what
  /// was learned about the sensors and the tension is kept.
  void restart(const Eigen::Vector3d& p_WD, double sigma_p, double sigma_v) noexcept;

  /// Adds independent position uncertainty [m].
  void addPositionUncertainty(double sigma_p) noexcept;

  /// Eq. (16) over dt [s] >= 0, with the rates that are in effect.
  void predict(double dt, const TetherRates& commanded, const Anchor& anchor) noexcept;

  /// Updates of readings that are `age` [s] old, eqs. (17)-(22). `weight` >= 1 multiplies the noise
  /// variance (see LocalizerNoiseConfig).
  Innovation updateLength(double L_total, double age, double weight, const Anchor& anchor) noexcept;
  /// Eq. (17) with the drone parked where reset() has put it and the tether perhaps a little slack:
  /// what tells the scale of an uncalibrated reel. Once a flight: its error does not average out.
  Innovation updateParkedLength(double L_total, const Anchor& anchor) noexcept;
  Innovation updateAngles(double theta, double phi, double age, double weight,
                          const Anchor& anchor) noexcept;
  Innovation updateAltitude(double altitude, double age, double weight,
                            const Anchor& anchor) noexcept;
  Innovation updateLean(const Eigen::Quaterniond& R_WB, double age, double weight,
                        const Anchor& anchor) noexcept;
  Innovation updateReelTension(double T_reel, double age, double weight,
                               const Anchor& anchor) noexcept;

  [[nodiscard]] const State& x() const noexcept { return x_; }
  [[nodiscard]] const Covariance& P() const noexcept { return P_; }
  [[nodiscard]] Eigen::Vector3d p() const noexcept { return x_.segment<3>(kP); }
  [[nodiscard]] Eigen::Vector3d v() const noexcept { return x_.segment<3>(kV); }
  [[nodiscard]] double T() const noexcept;

 private:
  template <int M>
  struct Linearized {
    Eigen::Matrix<double, M, 1> residual;  // reading minus prediction
    Eigen::Matrix<double, M, kSize> H;     // d prediction / d x
  };
  template <int M, class Model>
  Innovation update(const Model& model, const Eigen::Matrix<double, M, M>& R, double age,
                    const Anchor& anchor, int iterations) noexcept;
  Innovation updateLength(double L_total, double variance, double age, const Anchor& anchor,
                          int iterations) noexcept;
  void clamp(const Anchor& anchor) noexcept;

  LocalizerConfig config_;
  State x_{State::Zero()};
  Covariance P_{Covariance::Identity()};
  double takeoff_height_{0.0};
};

}  // namespace tautline
