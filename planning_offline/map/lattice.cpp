#include "planning_offline/map/lattice.h"

#include <cmath>
#include <utility>

#include "common/error.h"

namespace tautline::planning {
namespace {

constexpr int kCentre = 13;  // of the 27 steps, (0, 0, 0)

std::array<Eigen::Vector3i, kDirections> makeSteps() {
  std::array<Eigen::Vector3i, kDirections> steps;
  for (int n = 0; n < 27; ++n) {
    if (n == kCentre) continue;
    steps[static_cast<std::size_t>(n < kCentre ? n : n - 1)] = {n % 3 - 1, n / 3 % 3 - 1,
                                                                n / 9 - 1};
  }
  return steps;
}

int axesOf(Direction d) { return stepOf(d).cwiseAbs().sum(); }

/// True if the move from `from` stays on the map and every cell of the box it spans is free.
bool allowed(const GridShape& shape, const std::vector<std::uint8_t>& free,
             const Eigen::Vector3i& from, Direction d) {
  const Eigen::Vector3i& step = stepOf(d);
  if (!shape.contains(from + step)) return false;
  const Eigen::Vector3i lo = from + step.cwiseMin(0);
  const Eigen::Vector3i hi = from + step.cwiseMax(0);
  for (int z = lo.z(); z <= hi.z(); ++z) {
    for (int y = lo.y(); y <= hi.y(); ++y) {
      for (int x = lo.x(); x <= hi.x(); ++x) {
        if (free[static_cast<std::size_t>(shape.index({x, y, z}))] == 0) return false;
      }
    }
  }
  return true;
}

}  // namespace

const Eigen::Vector3i& stepOf(Direction d) noexcept {
  static const std::array<Eigen::Vector3i, kDirections> steps = makeSteps();
  return steps[static_cast<std::size_t>(d)];
}

Direction directionOf(const Eigen::Vector3i& step) noexcept {
  const int n = step.x() + 1 + 3 * (step.y() + 1) + 9 * (step.z() + 1);
  return n < kCentre ? n : n - 1;
}

double stepLength(Direction d) noexcept { return std::sqrt(static_cast<double>(axesOf(d))); }

std::vector<Direction> directionsOf(Connectivity connectivity, bool planar) {
  const int axes_max = 1 + static_cast<int>(connectivity);
  std::vector<Direction> directions;
  for (Direction d = 0; d < kDirections; ++d) {
    if (axesOf(d) <= axes_max && !(planar && stepOf(d).y() != 0)) directions.push_back(d);
  }
  return directions;
}

Lattice::Lattice(GridShape shape, Connectivity connectivity, std::vector<std::uint8_t> free)
    : shape_(shape),
      connectivity_(connectivity),
      directions_(directionsOf(connectivity, shape.planar())),
      free_(std::move(free)),
      moves_(shape.size(), 0) {
  TAUTLINE_CHECK(free_.size() == shape.size());
  for (const Direction d : directions_) {
    const Eigen::Vector3i& step = stepOf(d);
    offset_[static_cast<std::size_t>(d)] = (step.z() * shape.ny + step.y()) * shape.nx + step.x();
  }
  for (std::size_t i = 0; i < free_.size(); ++i) {
    if (free_[i] == 0) continue;
    ++free_count_;
    const Eigen::Vector3i cell = shape.cell(static_cast<CellIndex>(i));
    for (const Direction d : directions_) {
      if (allowed(shape_, free_, cell, d)) moves_[i] |= std::uint32_t{1} << d;
    }
  }
}

}  // namespace tautline::planning
