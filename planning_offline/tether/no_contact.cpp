#include "planning_offline/tether/no_contact.h"

namespace tautline::planning {

NoContactCells::NoContactCells(const VoxelMap& map)
    : shape_(map.shape),
      resolution_(map.resolution),
      origin_(map.origin),
      marked_(map.no_contact) {}

bool NoContactCells::touchedAt(const Eigen::Vector3d& contact, double standoff) const noexcept {
  if (empty()) return false;
  constexpr double kRounding = 1e-5;  // [cells]
  const double touching = standoff + kRounding;
  const Eigen::Array3d at = ((contact - origin_) / resolution_).array();
  const Eigen::Vector3i low = (at - touching).floor().cast<int>();
  const Eigen::Vector3i high = (at + touching).floor().cast<int>();
  for (int z = low.z(); z <= high.z(); ++z) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) {
        const Eigen::Vector3i cell(x, y, z);
        if (shape_.contains(cell) && marked_[static_cast<std::size_t>(shape_.index(cell))] != 0)
          return true;
      }
    }
  }
  return false;
}

}  // namespace tautline::planning
