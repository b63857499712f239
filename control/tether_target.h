#pragma once

/// @file
/// A Cartesian target as tether variables, by either of two models of the free tether.

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "common/fields.h"
#include "common/tether_geometry.h"

namespace tautline {

enum class TetherModel : std::uint8_t {
  kStraight,  ///< As published: chord and its elevation, eq. (2).
  kCatenary,  ///< Exact: arc length and tangent elevation at the drone, eq. (9).
};
inline constexpr std::array<EnumName<TetherModel>, 2> kTetherModelNames{
    {{TetherModel::kStraight, "straight"}, {TetherModel::kCatenary, "catenary"}}};

struct TetherModelConfig {
  TetherModel model{TetherModel::kStraight};
  double weight_n_per_m{0.059841};  ///< w
  double nominal_tension_n{0.3};    ///< Where the estimate has no tension.

  template <class Visitor>
  void fields(Visitor& v) {
    v.choice("model", model, kTetherModelNames, "shape of the free tether in targets");
    v.field("weight_n_per_m", weight_n_per_m, Range{0.0, 10.0}, "tether weight per length");
    v.field("nominal_tension_n", nominal_tension_n, Range{0.01, 100.0},
            "tension where the estimate has none");
  }
};

struct TetherTarget {
  bool reachable{false};  ///< False: no static shape reaches the point at this tension; `q` is then
                          ///< the straight line.
  TetherCoordinates q;    ///< L [m], theta and phi [rad], relative to A.
};

/// Tether variables with the drone at p_AD [m] and the tension T at the drone [N]; T <= 0: the
/// nominal one. Not reachable also for input that is not finite. Real-time safe: no allocation, no
/// locks, no exceptions.
[[nodiscard]] TetherTarget tetherTarget(const TetherModelConfig& config,
                                        const Eigen::Vector3d& p_AD, double T) noexcept;

}  // namespace tautline
