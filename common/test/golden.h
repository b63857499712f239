#pragma once

/// @file
/// Vectors of an independent reference implementation (common/test/golden/*.json; conventions
/// inside each file).

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace tautline::golden {

struct Polar {
  Eigen::Vector3d p;
  double L, theta, phi;
  Eigen::Matrix3d J;
};

struct Forward {
  double L, theta_D, T_D, w, phi;
  double r, h, H, V_D, V_A, T_A, theta_A, chord, chord_elevation;
  Eigen::Vector3d p;
  std::optional<Eigen::Matrix<double, 2, 3>> J;
};

struct Inverse {
  double r, h, T, w;
  bool at_drone, feasible;
  std::optional<double> T_min;              // absent for a vertical tether
  double L, H, theta_D, theta_A, T_D, T_A;  // only if feasible
};

struct Reel {
  double L, theta_D, T_A, w;
  bool feasible;
  double T_D, r, h;  // only if feasible
};

[[nodiscard]] std::vector<Polar> loadPolar();
[[nodiscard]] std::vector<Forward> loadForward();
[[nodiscard]] std::vector<Inverse> loadInverse();
[[nodiscard]] std::vector<Reel> loadReel();

}  // namespace tautline::golden
