#pragma once

/// @file
/// The shipped paths of points.

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace tautline::planning {

/// x y z [m] of each line that begins with them. `file` is relative to config/; empty if there is
/// no such file.
inline std::vector<Eigen::Vector3d> shippedPath(const std::string& file) {
  std::ifstream in(std::string(TAUTLINE_SOURCE_DIR) + "/config/" + file);
  std::vector<Eigen::Vector3d> points;
  for (std::string line; std::getline(in, line);) {
    std::istringstream row(line);
    Eigen::Vector3d p;
    if (row >> p.x() >> p.y() >> p.z()) points.push_back(p);
  }
  return points;
}

}  // namespace tautline::planning
