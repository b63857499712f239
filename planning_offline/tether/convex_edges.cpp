#include "planning_offline/tether/convex_edges.h"

#include <array>

#include "common/error.h"

namespace tautline::planning {
namespace {

constexpr int kSideMax = 1 << 28;

/// Quadrants that are occupied while their neighbours across u and v are free, of a mask of the
/// four.
constexpr std::array<std::uint8_t, 16> makeConvex() {
  std::array<std::uint8_t, 16> convex{};
  for (unsigned mask = 0; mask < 16; ++mask) {
    for (unsigned q = 0; q < 4; ++q) {
      const bool neighbours = (mask >> (q ^ 1U) & 1U) != 0 || (mask >> (q ^ 2U) & 1U) != 0;
      if ((mask >> q & 1U) != 0 && !neighbours) {
        convex[mask] = static_cast<std::uint8_t>(convex[mask] | 1U << q);
      }
    }
  }
  return convex;
}

}  // namespace

ConvexEdges::ConvexEdges(const VoxelMap& map, int axis) : axis_(axis) {
  const Eigen::Vector3i size(map.shape.nx, map.shape.ny, map.shape.nz);
  TAUTLINE_CHECK(size.maxCoeff() < kSideMax && map.cells.size() == map.shape.size());
  size_u_ = size[axisU(axis)];
  size_v_ = size[axisV(axis)];
  size_w_ = size[axis];
  // First the mask of occupied quadrants: every cell is in one quadrant of its four edges.
  masks_.assign(index(0, 0, size_w_), 0);
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    if (map.cells[i] != CellState::kOccupied) continue;
    const Eigen::Vector3i cell = map.shape.cell(static_cast<CellIndex>(i));
    for (int q = 0; q < 4; ++q) {
      const std::size_t edge = index(cell[axisU(axis)] + ((q & 1) != 0 ? 0 : 1),
                                     cell[axisV(axis)] + ((q & 2) != 0 ? 0 : 1), cell[axis]);
      masks_[edge] = static_cast<std::uint8_t>(masks_[edge] | 1U << q);
    }
  }
  constexpr std::array<std::uint8_t, 16> kConvex = makeConvex();
  const std::size_t slab = index(0, 0, 1);
  for (std::size_t edge = masks_.size(); edge-- > 0;) {  // downwards: the slab below is still raw
    const unsigned occupied = masks_[edge];
    const unsigned both = edge >= slab ? occupied & masks_[edge - slab] : 0U;
    masks_[edge] = static_cast<std::uint8_t>(kConvex[occupied] | kConvex[both] << 4U);
  }
}

}  // namespace tautline::planning
