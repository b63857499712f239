#include "planning_offline/planner/contact_bound.h"

#include <algorithm>
#include <utility>

#include "planning_offline/field/line_of_sight.h"

namespace tautline::planning {
namespace {

constexpr int kMost = 100;                 // beyond it nothing is looked for
constexpr std::size_t kTests = 3'000'000;  // tests of lines, about 0.2 s

}  // namespace

ContactBound::ContactBound(const VoxelMap& map, const Eigen::Vector3d& reel)
    : map_(&map), known_(map.shape.size(), -1), tests_left_(kTests) {
  needSightSize(map);
  occupied_.reserve(map.shape.size());
  for (const CellState state : map.cells) {
    occupied_.push_back(state == CellState::kOccupied ? 1 : 0);
  }
  layers_.push_back({inCells(reel)});
  if (map.shape.planar()) rest_ = convexCorners(layers_[0][0].y());
}

int ContactBound::at(CellIndex cell) {
  std::int8_t& known = known_[static_cast<std::size_t>(cell)];
  if (known >= 0) return known;
  const Eigen::Vector3d centre = inCells(map_->centre(cell));
  int contacts = 0;
  while (contacts < kMost && haveLayer(static_cast<std::size_t>(contacts))) {
    if (sees(layers_[static_cast<std::size_t>(contacts)], centre)) break;
    ++contacts;
  }
  known = static_cast<std::int8_t>(contacts);
  return contacts;
}

/// The next layer is what the last one sees of the corners that are left. False if that is nothing,
/// or too much work to find out.
bool ContactBound::haveLayer(std::size_t k) {
  if (k > 0 && tests_left_ == 0) return false;
  if (k == layers_.size()) {
    const Points& last = layers_.back();
    if (last.size() * rest_.size() > tests_left_) {
      tests_left_ = 0;
      return false;
    }
    const auto seen = std::stable_partition(
        rest_.begin(), rest_.end(), [&](const Eigen::Vector3d& c) { return !sees(last, c); });
    Points next(seen, rest_.end());
    rest_.erase(seen, rest_.end());
    layers_.push_back(std::move(next));
  }
  return !layers_[k].empty();
}

bool ContactBound::sees(const Points& from, const Eigen::Vector3d& to) {
  for (const Eigen::Vector3d& point : from) {
    if (tests_left_ > 0) --tests_left_;
    if (lineOfSight(map_->shape, occupied_, point, to)) return true;
  }
  return false;
}

Eigen::Vector3d ContactBound::inCells(const Eigen::Vector3d& point) const {
  return (point - map_->origin) / map_->resolution;
}

bool ContactBound::occupied(int x, int z) const {
  const Eigen::Vector3i cell(x, 0, z);
  return map_->shape.contains(cell) &&
         occupied_[static_cast<std::size_t>(map_->shape.index(cell))] != 0;
}

/// Grid points around which one cell is occupied, or two that only touch there.
ContactBound::Points ContactBound::convexCorners(double y) const {
  Points corners;
  for (int z = 0; z <= map_->shape.nz; ++z) {
    for (int x = 0; x <= map_->shape.nx; ++x) {
      const bool a = occupied(x - 1, z - 1);
      const bool b = occupied(x, z - 1);
      const bool c = occupied(x - 1, z);
      const bool d = occupied(x, z);
      const int count = int{a} + int{b} + int{c} + int{d};
      if (count == 1 || (count == 2 && a == d)) corners.emplace_back(x, y, z);
    }
  }
  return corners;
}

}  // namespace tautline::planning
