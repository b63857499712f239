#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "planning_offline/field/line_of_sight.h"
#include "planning_offline/planner/makers.h"
#include "planning_offline/planner/prm/roadmap.h"

namespace tautline::planning {
namespace {

/// A room of 20 x 5 x 20 cells of 0.5 m with random pillars, and rewards far from the start.
struct Room {
  explicit Room(unsigned seed, bool with_reel = false) {
    VoxelMap map;
    map.name = "room";
    map.shape = {20, 5, 20};
    map.resolution = 0.5;
    map.origin = {-1.0, 0.0, 2.0};
    map.cells.assign(map.shape.size(), CellState::kFree);
    std::mt19937 random(seed);
    for (int n = 0; n < 25; ++n) {
      const int x = static_cast<int>(random() % 20);
      const int z = static_cast<int>(random() % 20);
      if (x < 3 && z < 3) continue;
      for (int y = 0; y < 5; ++y) {
        map.cells[static_cast<std::size_t>(map.shape.index({x, y, z}))] = CellState::kOccupied;
      }
    }
    start = map.shape.index({1, 1, 1});
    if (with_reel) map.reel = map.centre(start);
    std::vector<std::uint8_t> free;
    for (const CellState s : map.cells) free.push_back(s == CellState::kFree ? 1 : 0);
    lattice = std::make_unique<Lattice>(map.shape, Connectivity::kVertices, std::move(free));
    RiskParams params;
    params.distance.member.risk = 0.0;
    params.visibility.member.risk = 0.0;
    model = std::make_unique<RiskModel>(std::make_shared<const VoxelMap>(std::move(map)),
                                        MapFields{}, params, nullptr);
    reward.assign(lattice->shape().size(), 0.0);
  }
  [[nodiscard]] PlanProblem problem() const { return {lattice.get(), model.get(), reward, start}; }
  [[nodiscard]] std::vector<std::uint8_t> blocked() const {
    std::vector<std::uint8_t> blocked;
    for (const std::uint8_t free : lattice->freeCells()) blocked.push_back(free == 0 ? 1 : 0);
    return blocked;
  }

  CellIndex start{kNoCell};
  std::unique_ptr<Lattice> lattice;
  std::unique_ptr<RiskModel> model;
  std::vector<double> reward;
};

CellIndex farFreeCell(const Room& room) {
  CellIndex cell = room.lattice->shape().index({18, 2, 18});
  while (!room.lattice->free(cell)) --cell;
  return cell;
}

TEST(RoadmapTest, LinksSeeEachOther) {
  const Room room(1);
  const GridShape& shape = room.lattice->shape();
  const auto free = room.lattice->freeCells();
  RoadmapSettings settings;
  settings.milestones = 400;
  settings.milestones_max = 400;
  const Roadmap roadmap =
      growRoadmap(shape, {free.begin(), free.end()}, {room.start}, settings, Progress());
  EXPECT_GT(roadmap.milestones.size(), 350U);
  const auto blocked = room.blocked();
  std::size_t links = 0;
  for (std::size_t i = 0; i < roadmap.milestones.size(); ++i) {
    EXPECT_TRUE(room.lattice->free(roadmap.milestones[i]));
    for (const Roadmap::Edge& edge : roadmap.edges[i]) {
      const Eigen::Vector3d a = shape.cell(roadmap.milestones[i]).cast<double>().array() + 0.5;
      const Eigen::Vector3d b =
          shape.cell(roadmap.milestones[edge.to]).cast<double>().array() + 0.5;
      EXPECT_TRUE(lineOfSight(shape, blocked, a, b));
      EXPECT_DOUBLE_EQ(edge.length, (b - a).norm());
      ++links;
    }
  }
  EXPECT_GT(links, 4 * roadmap.milestones.size());  // both ways of each
}

TEST(RoadmapTest, ShortestWaysAreThoseOfBellmanFord) {
  const Room room(2);
  const auto free = room.lattice->freeCells();
  RoadmapSettings settings;
  settings.milestones = 300;
  settings.milestones_max = 300;
  const Roadmap roadmap = growRoadmap(room.lattice->shape(), {free.begin(), free.end()},
                                      {room.start}, settings, Progress());
  const std::size_t root = roadmap.indexOf(room.start);
  ASSERT_LT(root, roadmap.milestones.size());
  std::vector<double> length(roadmap.milestones.size(), std::numeric_limits<double>::infinity());
  length[root] = 0.0;
  for (std::size_t round = 0; round < length.size(); ++round) {
    for (std::size_t i = 0; i < length.size(); ++i) {
      for (const Roadmap::Edge& e : roadmap.edges[i]) {
        length[e.to] = std::min(length[e.to], length[i] + e.length);
      }
    }
  }
  const Roadmap::Tree tree = roadmap.shortestFrom(root);
  for (std::size_t i = 0; i < length.size(); ++i) {
    if (std::isinf(length[i])) {
      EXPECT_TRUE(std::isinf(tree.length[i]));
    } else {
      EXPECT_NEAR(tree.length[i], length[i], 1e-9);
    }
  }
}

TEST(PrmTest, FliesStraightLegsThroughFreeCells) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Room room(seed);
    PlanOptions options;
    options.goal = farFreeCell(room);
    const PlanResult result = makePrm()->plan(room.problem(), options, Progress());
    ASSERT_EQ(result.status, PlanStatus::kFeasible) << result.text;
    EXPECT_EQ(result.path.front(), room.start);
    EXPECT_EQ(result.path.back(), *options.goal);
    ASSERT_EQ(result.path.size(), result.report.states.size());
    const VoxelMap& map = room.model->map();
    const auto blocked = room.blocked();
    for (std::size_t i = 0; i < result.path.size(); ++i) {
      EXPECT_TRUE(room.lattice->free(result.path[i]));
      const Eigen::Vector3d p = (result.report.states[i].position - map.origin) / map.resolution;
      const Eigen::Vector3d lower = map.shape.cell(result.path[i]).cast<double>();
      EXPECT_TRUE(((p - lower).array() >= -1e-6).all() &&
                  ((p - lower).array() <= 1.0 + 1e-6).all());
      if (i == 0) continue;
      const Eigen::Vector3d before =
          (result.report.states[i - 1].position - map.origin) / map.resolution;
      EXPECT_LE((p - before).cwiseAbs().maxCoeff(), 1.0 + 1e-9);
      EXPECT_TRUE(lineOfSight(map.shape, blocked, before, p));
    }
  }
}

TEST(PrmTest, SameSeedSamePathOtherSeedOtherPath) {
  const Room room(7);
  PlanOptions options;
  options.goal = farFreeCell(room);
  const PlanResult a = makePrm()->plan(room.problem(), options, Progress());
  const PlanResult b = makePrm()->plan(room.problem(), options, Progress());
  ASSERT_TRUE(a);
  EXPECT_EQ(a.path, b.path);
  EXPECT_EQ(a.report.cost, b.report.cost);
  EXPECT_EQ(a.expanded, b.expanded);
  bool differs = false;
  for (options.seed = 2; options.seed <= 4; ++options.seed) {
    differs = differs || makePrm()->plan(room.problem(), options, Progress()).path != a.path;
  }
  EXPECT_TRUE(differs);
}

TEST(PrmTest, KeepsToWhatAStraightTetherReaches) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Room room(seed, true);
    const VoxelMap& map = room.model->map();
    const auto blocked = room.blocked();
    const Eigen::Vector3d reel = (*map.reel - map.origin) / map.resolution;
    const auto sees = [&](CellIndex cell) {
      const Eigen::Vector3d centre = map.shape.cell(cell).cast<double>().array() + 0.5;
      return lineOfSight(map.shape, blocked, reel, centre);
    };
    int reached = 0;
    for (CellIndex goal = 7; goal < static_cast<CellIndex>(map.shape.size()); goal += 331) {
      if (!room.lattice->free(goal)) continue;
      PlanOptions options;
      options.goal = goal;
      const PlanResult result = makePrm()->plan(room.problem(), options, Progress());
      if (!sees(goal)) {
        EXPECT_EQ(result.status, PlanStatus::kUnreachable);
        EXPECT_NE(result.text.find("straight tether"), std::string::npos);
        continue;
      }
      if (!result) continue;
      ++reached;
      for (const CellIndex cell : result.path) EXPECT_TRUE(sees(cell));
    }
    EXPECT_GT(reached, 0);
  }
}

TEST(PrmTest, ChoosesTheRewardOfTheBestUtility) {
  Room room(3);
  const CellIndex near = room.lattice->shape().index({3, 1, 2});
  const CellIndex far = farFreeCell(room);
  ASSERT_TRUE(room.lattice->free(near));
  room.reward[static_cast<std::size_t>(near)] = 1.0;
  room.reward[static_cast<std::size_t>(far)] = 1.0;
  const PlanResult chosen = makePrm()->plan(room.problem(), {}, Progress());
  ASSERT_TRUE(chosen);
  EXPECT_EQ(chosen.path.back(), near);
  EXPECT_NEAR(chosen.utility, chosen.reward / chosen.report.risk, 1e-12);
  room.reward[static_cast<std::size_t>(far)] = 100.0;
  EXPECT_EQ(makePrm()->plan(room.problem(), {}, Progress()).path.back(), far);
}

TEST(PrmTest, NothingWithinTheCapIsUnreachable) {
  const Room room(4);
  PlanOptions options;
  options.goal = farFreeCell(room);
  options.risk_cap = 1e-6;
  const PlanResult result = makePrm()->plan(room.problem(), options, Progress());
  EXPECT_EQ(result.status, PlanStatus::kUnreachable);
  EXPECT_TRUE(result.path.empty());
  EXPECT_NE(result.text.find("risk cap"), std::string::npos);
}

TEST(PrmTest, OmplIsNotHeard) {
  const Room room(5);
  PlanOptions options;
  options.goal = farFreeCell(room);
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const PlanResult result = makePrm()->plan(room.problem(), options, Progress());
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_TRUE(result);
}

}  // namespace
}  // namespace tautline::planning
