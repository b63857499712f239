// E_cd: the narrowest free chord through a cell.

#include "planning_offline/field/passage_width.h"

#include <cmath>

#include <gtest/gtest.h>

#include "planning_offline/field/obstacles.h"
#include "planning_offline/field/reference/field_reference.h"
#include "planning_offline/field/reference/synthetic_map.h"

namespace tautline::planning {
namespace {

const Progress kQuiet;

std::vector<float> widths(const VoxelMap& map, const WidthOptions& options) {
  return widthField(map.shape, obstacleCells(map, true), options, kQuiet, {"width"});
}

TEST(PassageWidth, EqualsBruteForce) {
  const GridShape shapes[] = {{12, 7, 9}, {15, 1, 11}, {1, 1, 8}, {5, 20, 2}};
  for (std::uint32_t seed = 0; seed < 80; ++seed) {
    const VoxelMap map = randomMap(shapes[seed % 4], 0.03 * (seed % 5), 0.0, seed);
    const WidthOptions options{.resolution = 0.3,
                               .cap = 0.7 * (1 + seed % 6),
                               .solid_border = seed % 2 == 0,
                               .threads = 1 + static_cast<int>(seed % 3)};
    ASSERT_EQ(widths(map, options), widthReference(map.shape, obstacleCells(map, true), options))
        << seed;
  }
}

TEST(PassageWidth, OfACorridorIsItsWidth) {
  VoxelMap map = randomMap({30, 30, 30}, 0.0, 0.0, 1);
  for (std::size_t i = 0; i < map.cells.size(); ++i) {  // 4 cells between two walls along z
    const int x = map.shape.cell(static_cast<CellIndex>(i)).x();
    if (x < 10 || x >= 14) map.cells[i] = CellState::kOccupied;
  }
  const auto width = widths(map, {.resolution = 0.25, .cap = 10.0});
  EXPECT_FLOAT_EQ(width[static_cast<std::size_t>(map.shape.index({12, 15, 15}))], 1.0F);
  EXPECT_EQ(width[static_cast<std::size_t>(map.shape.index({9, 15, 15}))], 0.0F);
}

TEST(PassageWidth, OpenSpaceIsAsWideAsTheCap) {
  const VoxelMap map = randomMap({8, 8, 8}, 0.0, 0.0, 1);
  for (const float w : widths(map, {.cap = 3.5})) EXPECT_EQ(w, 3.5F);
  const auto room = widths(map, {.cap = 30.0, .solid_border = true});
  EXPECT_EQ(room[static_cast<std::size_t>(map.shape.index({4, 4, 4}))], 8.0F);
  // Diagonal chords are short near edges and corners.
  EXPECT_FLOAT_EQ(room[0], static_cast<float>(std::sqrt(2.0)));
  EXPECT_FLOAT_EQ(room[static_cast<std::size_t>(map.shape.index({1, 1, 4}))],
                  static_cast<float>(3.0 * std::sqrt(2.0)));
}

}  // namespace
}  // namespace tautline::planning
