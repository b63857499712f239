#include "planning_offline/tether/test/string_line.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tautline::planning {

double depth(const VoxelMap& map, const Eigen::Vector3d& p_M) {
  const Eigen::Vector3d p = (p_M - map.origin) / map.resolution;
  const Eigen::Vector3i at = p.array().floor().cast<int>();
  const auto occupied = [&map](const Eigen::Vector3i& cell) {
    return map.shape.contains(cell) &&
           map.cells[static_cast<std::size_t>(map.shape.index(cell))] == CellState::kOccupied;
  };
  if (!occupied(at)) return 0.0;
  double least = 1.0;
  for (int n = 0; n < 27; ++n) {
    const Eigen::Vector3i cell = at + Eigen::Vector3i(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
    if (occupied(cell)) continue;
    const Eigen::Vector3d low = cell.cast<double>();
    const Eigen::Vector3d out = (low - p).cwiseMax(p - low - Eigen::Vector3d::Ones());
    least = std::min(least, std::max(out.maxCoeff(), 0.0));
  }
  return least;
}

std::vector<Eigen::Vector3d> stringLine(const Eigen::Vector3d& reel,
                                        const std::vector<Eigen::Vector3d>& contacts,
                                        const Eigen::Vector3d& end) {
  std::vector<Eigen::Vector3d> line{reel};
  line.insert(line.end(), contacts.begin(), contacts.end());
  line.push_back(end);
  return line;
}

double deepest(const VoxelMap& map, const std::vector<Eigen::Vector3d>& line) {
  double most = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Eigen::Vector3d d = line[i] - line[i - 1];
    const int samples = 1 + static_cast<int>(d.norm() / (0.04 * map.resolution));
    for (int k = 0; k <= samples; ++k) {
      most = std::max(most, depth(map, line[i - 1] + d * k / samples));
    }
  }
  return most;
}

int windings(const std::vector<Eigen::Vector3d>& closed, int axis, const Eigen::Vector3d& centre) {
  const auto angle = [&](const Eigen::Vector3d& p) {
    const Eigen::Vector3d r = p - centre;
    return std::atan2(r[(axis + 2) % 3], r[(axis + 1) % 3]);
  };
  double sum = 0.0;
  for (std::size_t i = 0; i < closed.size(); ++i) {
    const double turn = angle(closed[(i + 1) % closed.size()]) - angle(closed[i]);
    sum += std::remainder(turn, 2.0 * std::numbers::pi);
  }
  return static_cast<int>(std::lround(sum / (2.0 * std::numbers::pi)));
}

}  // namespace tautline::planning
