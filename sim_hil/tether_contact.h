#pragma once

/// @file
/// Where the tether rests on an obstacle, and the constants that chain and mesh share.

#include <array>
#include <cstddef>

#include <Eigen/Core>

namespace tautline::sim {

inline constexpr int kMaxLinks = 64;
inline constexpr int kMaxChainContacts = 64;

/// One number for each node (or link) of the chain, reel first.
using NodeScalars = std::array<double, kMaxLinks + 1>;

struct TetherContact {
  int link{0};
  double s{0.0};  ///< On the link, in [0, 1].
  int solid{0};
  int feature{0};
  Eigen::Vector3d normal{Eigen::Vector3d::UnitY()};
  double offset{0.0};
  double force{0.0};  ///< Normal force at the end of the step [N].
  bool at_node{false};  ///< A node rests on this edge: the material slides through the node.
  double friction{0.0};  ///< Friction as a viscous coefficient for this step [N s/m].
  double flow{0.0};  ///< Speed of the material past the chain's frame, towards the drone [m/s].
};

}  // namespace tautline::sim
