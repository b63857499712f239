#pragma once

/// @file
/// How the tether touches obstacles: it is bent round edges, and it lies on faces.

#include <array>

#include <Eigen/Core>

#include "sim_hil/obstacles.h"

namespace tautline::sim {

inline constexpr int kMaxLinks = 64;
inline constexpr int kMaxEdgeContacts = 24;
inline constexpr int kMaxFaceContacts = 64;

/// One number for each node (or link) of the chain, reel first.
using NodeScalars = std::array<double, kMaxLinks + 1>;

/// A link is bent round an edge of a solid; the tether slides through this point.
struct EdgeContact {
  int link{0};
  int solid{0};
  int feature{0};
  SolidEdge edge;
  double along{0.0};  ///< Of the point on the edge [m].

  [[nodiscard]] Eigen::Vector3d point() const noexcept {
    return edge.start + along * edge.direction;
  }
};

/// A straight link touches a face, or is just about to be bent round an edge. A stiff one-sided
/// spring with friction.
struct FaceContact {
  int link{0};
  double s{0.0};  ///< On the link, in [0, 1].
  int solid{0};
  int feature{0};
  Eigen::Vector3d normal{Eigen::Vector3d::UnitY()};
  double offset{0.0};
  double force{0.0};     ///< Normal force at the end of the step [N].
  double friction{0.0};  ///< Friction as a viscous coefficient for this step [N s/m].
  double flow{0.0};      ///< Speed of the material past the chain's frame, towards the drone [m/s].
};

}  // namespace tautline::sim
