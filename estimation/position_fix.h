#pragma once

/// @file
/// Memoryless localizers: one set of readings to one position. Section 3 of docs/tether_model.md.
///
/// `exact` is the sag model of common/catenary.h. The others are kept so that what was published
/// can be reproduced and compared; none of them is a default. The dissertation takes the vertex of
/// the catenary at the reel and never uses the measured length for the angle, which makes its
/// correction scale-free:
///     theta_r = atan((sec theta - 1)/asinh(tan theta)),   45 deg -> 25.2 deg at any tension and
///     any length.
/// Everything here is real-time safe: no allocation, no locks, no exceptions.

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "common/fields.h"

namespace tautline {

enum class FixVariant : std::uint8_t {
  kExact,            ///< Eqs. (5)-(7).
  kStraight,         ///< Eq. (1) on the sensed values: the dissertation's preliminary localizer.
  kAsPublishedText,  ///< Dissertation section 5.1.3: angle and length both from the model with T_0
                     ///< = T.
  kAsPublishedCode,  ///< What flew: the angle from the model, the length as measured.
};
inline constexpr std::array<EnumName<FixVariant>, 4> kFixVariantNames{
    {{FixVariant::kExact, "exact"},
     {FixVariant::kStraight, "straight"},
     {FixVariant::kAsPublishedText, "as-published-text"},
     {FixVariant::kAsPublishedCode, "as-published-code"}}};

struct FixInput {
  double L{};      ///< Free arc length A to D [m], >= 0.
  double theta{};  ///< Tangent elevation at D [rad], in [-pi/2, pi/2].
  double phi{};    ///< Azimuth [rad].
  double T{};      ///< Tension at D [N]; only `exact` and `as-published-text` use it.
  double w{};      ///< Weight per length [N/m], >= 0; > 0 for `as-published-text`.
};

struct PositionFix {
  bool ok{false};  ///< False: input outside its domain or not finite.
  Eigen::Vector3d p_AD{Eigen::Vector3d::Zero()};  ///< D from A, in W's axes [m].
};

[[nodiscard]] PositionFix fixPosition(FixVariant variant, const FixInput& in) noexcept;

/// The dissertation's corrected length and angle, eq. (14).
struct PublishedCatenary {
  double theta_r{};  ///< "Real" elevation [rad]; does not depend on T_0 or w.
  double L_x{};      ///< a asinh(tan theta) [m], a = T_0/w.
  double L_y{};      ///< a (sec theta - 1) [m].
  double L_r{};      ///< "Real" tether length [m].
  double L_s{};      ///< Arc length of the model's tether [m]; not the measured one.
};

/// Verbatim model for the tension T_0 [N] at the vertex. The equations say T_0 = T cos theta, the
/// implementation section T_0 = T: the caller chooses. |theta| < pi/2 rad, T_0 >= 0, w > 0.
[[nodiscard]] PublishedCatenary publishedCatenary(double theta, double T_0, double w) noexcept;

}  // namespace tautline
