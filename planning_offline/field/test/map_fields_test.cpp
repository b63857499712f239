// All fields of a map at once.

#include "planning_offline/field/map_fields.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "planning_offline/field/obstacles.h"
#include "planning_offline/field/reference/field_reference.h"
#include "planning_offline/field/reference/synthetic_map.h"

namespace tautline::planning {
namespace {

const Progress kQuiet;

TEST(MapFields, OnlyWhatWasAskedFor) {
  const VoxelMap map = randomMap({12, 5, 9}, 0.05, 0.05, 1);
  const MapFields fields = computeFields(map, {.width = true}, kQuiet);
  EXPECT_TRUE(fields.distance.empty());
  EXPECT_TRUE(fields.visibility.empty());
  EXPECT_EQ(fields.width.size(), map.shape.size());
}

TEST(MapFields, AreTheFieldsInMetresAndZeroInObstacles) {
  for (const bool unknown_is_obstacle : {true, false}) {
    VoxelMap map = randomMap({20, 6, 9}, 0.04, 0.04, 2);
    map.resolution = 0.25;
    map.solid_border = true;
    const FieldRequest request{.distance = true,
                               .width = true,
                               .visibility = true,
                               .visibility_directions = 40,
                               .visibility_cap = 2.0,
                               .width_cap = 1.5,
                               .distance_cap = 0.6,
                               .unknown_is_obstacle = unknown_is_obstacle};
    const MapFields fields = computeFields(map, request, kQuiet);
    const auto obstacles = obstacleCells(map, unknown_is_obstacle);
    EXPECT_EQ(fields.width, widthReference(map.shape, obstacles,
                                           {.resolution = 0.25, .cap = 1.5, .solid_border = true}));
    EXPECT_EQ(
        fields.visibility,
        isovistReference(map.shape, obstacles, {.resolution = 0.25, .directions = 40, .cap = 2.0}));
    const auto squared = squaredDistanceReference(map.shape, obstacles, true);
    for (std::size_t i = 0; i < squared.size(); ++i) {
      const double metres = 0.125 * std::sqrt(static_cast<double>(squared[i]));
      EXPECT_FLOAT_EQ(fields.distance[i], static_cast<float>(std::min(0.6, metres)));
      EXPECT_EQ(obstacles[i] != 0, fields.distance[i] == 0.0F);
      EXPECT_EQ(obstacles[i] != 0, fields.width[i] == 0.0F);
      EXPECT_EQ(obstacles[i] != 0, fields.visibility[i] == 0.0F);
    }
  }
}

TEST(MapFields, TellsWhatItDoesAndHowFar) {
  std::set<std::string> said;
  double largest = 0.0;
  const Progress progress([&](std::string_view what, double fraction) {
    said.emplace(what);
    EXPECT_GE(fraction, 0.0);
    EXPECT_LE(fraction, 1.0);
    largest = std::max(largest, fraction);
  });
  const VoxelMap map = randomMap({12, 5, 9}, 0.05, 0.05, 1);
  const FieldRequest request{.distance = true, .width = true, .visibility = true, .threads = 1};
  const MapFields fields = computeFields(map, request, progress);
  EXPECT_EQ(said, (std::set<std::string>{"distance to obstacles", "passage width", "visibility"}));
  EXPECT_EQ(largest, 1.0);
  EXPECT_EQ(fields.visibility.size(), map.shape.size());
}

TEST(MapFields, KeepsWhatWasCompleteWhenCancelled) {
  Progress* stop = nullptr;
  Progress progress([&](std::string_view what, double) {
    if (what == "passage width") stop->cancel();
  });
  stop = &progress;
  const VoxelMap map = randomMap({12, 5, 9}, 0.05, 0.05, 1);
  const FieldRequest request{.distance = true, .width = true, .visibility = true};
  const MapFields fields = computeFields(map, request, progress);
  EXPECT_EQ(fields.distance.size(), map.shape.size());
  EXPECT_TRUE(fields.width.empty());
  EXPECT_TRUE(fields.visibility.empty());
}

}  // namespace
}  // namespace tautline::planning
