#pragma once

/// @file
/// The pull on the tether from the drone's lean alone, for supervision: eq. (4) of
/// docs/tether_model.md on a low-passed lean, without a prior, so that a pull that is gone shows as
/// one. The localizer's tension, which always returns to its nominal value, cannot show that.

#include <cstdint>
#include <numbers>
#include <optional>

#include "common/time.h"
#include "common/vehicle.h"

namespace tautline {

/// Real-time safe: no allocation, no locks, no exceptions.
class LeanTension {
 public:
  /// @param time_constant of the low pass [s], > 0. @param least_angle between thrust and tether
  /// below which nothing is said [rad]. @param G weight of the vehicle [N].
  LeanTension(double time_constant, double least_angle, double G) noexcept
      : time_constant_(time_constant), least_angle_(least_angle), G_(G) {}

  /// Takes a new attitude sample, if `attitude` is one; `theta`, `phi` as estimated [rad].
  void update(const Sample<AttitudeReading>& attitude, double theta, double phi) noexcept;

  /// beta - theta [rad], in the tether's plane.
  [[nodiscard]] double angle() const noexcept { return beta_ - theta_; }

  /// At the drone [N]; 0 where the drone leans towards the anchor. Empty: not observable here, or
  /// no attitude yet.
  [[nodiscard]] std::optional<double> tension() const noexcept;

  /// By how much `tension` [N] is wrong where the lean is wrong by `error` [rad]: the slope of
  /// (12). Grows without bound towards the pole.
  [[nodiscard]] double tensionError(double tension, double error) const noexcept;

 private:
  double time_constant_;
  double least_angle_;
  double G_;
  std::uint32_t sequence_{0};
  Time time_{};
  double beta_{std::numbers::pi / 2.0};  ///< Low-passed [rad].
  double theta_{0.0};
};

}  // namespace tautline
