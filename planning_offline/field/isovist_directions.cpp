#include <cmath>
#include <limits>
#include <numbers>

#include "planning_offline/field/isovist.h"

namespace tautline::planning {

std::vector<Eigen::Vector3d> isovistDirections(int count, bool planar) {
  const int half = (count + 1) / 2;
  const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
  std::vector<Eigen::Vector3d> directions;
  directions.reserve(2 * static_cast<std::size_t>(half));
  for (int i = 0; i < half; ++i) {
    const double y = planar ? 0.0 : (i + 0.5) / half;
    const double angle = planar ? std::numbers::pi * (i + 0.5) / half : golden_angle * i;
    const double r = std::sqrt(1.0 - y * y);
    directions.emplace_back(r * std::sin(angle), y, r * std::cos(angle));
    directions.emplace_back(-directions.back());
  }
  return directions;
}

std::uint32_t isovistUnits(double length, double cap) noexcept {
  return static_cast<std::uint32_t>(std::lround(std::fmin(length / cap, 1.0) * kIsovistUnits));
}

std::vector<RayStep> raySteps(const Eigen::Vector3d& direction, double length) {
  // Where the ray crosses the next plane of each axis: (½ + planes crossed) / |component|.
  const Eigen::Array3d planes = direction.array().abs().inverse();
  const Eigen::Array3i sign = direction.array().sign().cast<int>();
  Eigen::Array3i crossed = Eigen::Array3i::Zero();
  std::vector<RayStep> steps;
  while (true) {
    const Eigen::Array3d next = (crossed.cast<double>() + 0.5) * planes;
    const double nearest = next.minCoeff();
    if (nearest >= length) return steps;
    crossed += (next == nearest).cast<int>();
    steps.push_back({(crossed * sign).matrix(), nearest});
  }
}

}  // namespace tautline::planning
