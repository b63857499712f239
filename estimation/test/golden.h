#pragma once

/// @file
/// Vectors of an independent reference implementation (estimation/test/golden/*.json; conventions
/// inside each file).

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace tautline::golden {

struct Lean {
  double G, T, theta, beta, F, dlnT_dbeta;
};

struct Map {
  double G, beta, theta, T_prior, sigma_T, sigma_beta, T_map, sigma_map;
};

struct Attitude {
  Eigen::Quaterniond R_WB;
  Eigen::Vector3d n;
  double beta;
};

struct Literal {
  double L_x, L_y, theta_r, L_r, L_s;
};
struct LiteralCase {
  double theta, T, w;
  Literal horizontal;  ///< T_0 = T cos theta
  Literal as_stated;   ///< T_0 = T
};

[[nodiscard]] std::vector<Lean> loadLean();
[[nodiscard]] std::vector<Map> loadMap();
[[nodiscard]] std::vector<Attitude> loadAttitude();
[[nodiscard]] std::vector<LiteralCase> loadLiteral();

}  // namespace tautline::golden
