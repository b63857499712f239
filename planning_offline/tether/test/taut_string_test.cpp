#include "planning_offline/tether/taut_string.h"

#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "common/error.h"
#include "planning_offline/tether/contact_tree.h"
#include "planning_offline/tether/convex_edges.h"
#include "planning_offline/tether/grid_triangle.h"
#include "planning_offline/tether/test/walks.h"

namespace tautline::planning {
namespace {

/// One occupied cell in the middle of 3 × 3 (× 3) cells of 0.5 m.
VoxelMap block(int levels) {
  VoxelMap map = walks::emptyMap({3, levels, 3});
  walks::occupy(map, {1, levels / 2, 1});
  return map;
}

TEST(MakeTautString, RefusesAReelInsideAnObstacle) {
  for (const int levels : {1, 3}) {
    const VoxelMap map = block(levels);
    const Eigen::Vector3d inside = map.centre(map.shape.index({1, levels / 2, 1}));
    EXPECT_THROW((void)makeTautString(map, inside), InputError);
    EXPECT_THROW((void)makeTautString(map, inside + Eigen::Vector3d(0.249, 0.0, 0.0)), InputError);
    EXPECT_NO_THROW((void)makeTautString(map, inside + Eigen::Vector3d(0.25, 0.0, 0.0)));
    EXPECT_NO_THROW((void)makeTautString(map, inside + Eigen::Vector3d(50.0, 0.0, 0.0)));
    EXPECT_THROW((void)makeTautString(map, Eigen::Vector3d(0.0, 0.0, 1e9)), InputError);
    EXPECT_THROW((void)makeTautString(map, Eigen::Vector3d(std::nan(""), 0.0, 0.0)), InputError);
  }
}

TEST(MakeTautString, RefusesAReelOnAFaceBetweenTwoOccupiedCells) {
  VoxelMap map = walks::emptyMap({4, 3, 3});
  walks::occupy(map, {1, 1, 1});
  walks::occupy(map, {2, 1, 1});
  const Eigen::Vector3d between =
      map.centre(map.shape.index({1, 1, 1})) + Eigen::Vector3d(0.25, 0, 0);
  EXPECT_THROW((void)makeTautString(map, between), InputError);
}

TEST(MakeTautString, OnlyOccupiedCellsTouchTheTether) {
  for (const int levels : {1, 3}) {
    VoxelMap map = block(levels);
    for (const CellState state : {CellState::kUnknown, CellState::kOccupied}) {
      map.cells[static_cast<std::size_t>(map.shape.index({1, levels / 2, 1}))] = state;
      const auto at = [&](int x, int z) { return map.centre(map.shape.index({x, levels / 2, z})); };
      const std::unique_ptr<TautString> string = makeTautString(map, at(0, 1));
      StackId stack = string->move(kStraight, at(0, 1), at(0, 2));
      stack = string->move(stack, at(0, 2), at(2, 2));
      stack = string->move(stack, at(2, 2), at(2, 1));
      EXPECT_EQ(string->contactCount(stack), state == CellState::kOccupied ? 2 : 0);
      EXPECT_EQ(string->unresolvedMoves(), 0);
    }
  }
}

TEST(ContactTree, EqualStacksHaveEqualNumbers) {
  ContactTree tree(Eigen::Vector3d::Zero(), 0.0);
  const ContactKey a{.edge = 1, .place = 5, .turn = 1};
  const ContactKey b{.edge = 2, .place = 5, .turn = -1};
  const Eigen::Vector3d pa(1.0, 0.0, 0.0);
  const Eigen::Vector3d pb(1.0, 2.0, 0.0);
  const StackId ab = tree.push(tree.push(kStraight, a, pa), b, pb);
  EXPECT_EQ(tree.push(tree.pop(ab), b, pb), ab);
  EXPECT_EQ(tree.push(kStraight, a, pa), tree.pop(ab));
  EXPECT_NE(tree.push(tree.push(kStraight, b, pb), a, pa), ab);
  EXPECT_NE(tree.push(kStraight, {.edge = 1, .place = 6, .turn = 1}, pa), tree.pop(ab));
  EXPECT_NE(tree.push(kStraight, {.edge = 1, .place = 5, .turn = -1}, pa), tree.pop(ab));
  EXPECT_DOUBLE_EQ(tree.staticLength(ab), 3.0);
  EXPECT_EQ(tree.count(ab), 2);
  EXPECT_EQ(tree.contacts(ab), (std::vector<Eigen::Vector3d>{pa, pb}));
}

TEST(ContactTree, NeitherCountsNorListsGrazingContacts) {
  ContactTree tree(Eigen::Vector3d::Zero(), 1e-5);
  const auto push = [&tree](StackId stack, std::uint64_t edge, double x, double y) {
    return tree.push(stack, {.edge = edge, .place = 0, .turn = 1}, Eigen::Vector3d(x, y, 0.0));
  };
  // The second is on the line, the third and fourth are one corner met twice.
  const StackId stack =
      push(push(push(push(push(kStraight, 1, 1.0, 1.0), 2, 2.0, 1.000004), 3, 3.0, 1.0), 4, 3.0,
                1.000001),
           5, 3.0, 4.0);
  const std::vector<Eigen::Vector3d> contacts = tree.contacts(stack);
  ASSERT_EQ(contacts.size(), 3U);
  EXPECT_EQ(tree.count(stack), 3);
  EXPECT_DOUBLE_EQ(contacts[0].x(), 1.0);
  EXPECT_DOUBLE_EQ(contacts[1].x(), 3.0);
  EXPECT_DOUBLE_EQ(contacts[2].y(), 4.0);
}

TEST(GridTriangle, VisitsAllGridPointsInside) {
  walks::Random random(7);
  const auto coordinate = [&random] {  // grid points, half cells and others
    const double fine = static_cast<double>(random() % 20000) * 1e-3 - 4.0;
    return random() % 3 == 0 ? std::floor(fine) : random() % 2 == 0 ? 0.5 * std::floor(fine) : fine;
  };
  for (int n = 0; n < 3000; ++n) {
    const Eigen::Vector2d a(coordinate(), coordinate());
    const Eigen::Vector2d b(coordinate(), coordinate());
    const Eigen::Vector2d c(coordinate(), n % 5 == 0 ? a.y() : coordinate());
    std::set<std::pair<int, int>> visited;
    visitGridPoints(a, b, c, 12, 10, 1e-9, [&](int u, int v) {
      EXPECT_TRUE(u >= 0 && u <= 12 && v >= 0 && v <= 10);
      EXPECT_TRUE(visited.insert({u, v}).second) << "twice";
    });
    const auto cross = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q,
                          const Eigen::Vector2d& r) {
      return (q - p).x() * (r - p).y() - (q - p).y() * (r - p).x();
    };
    const double turn = cross(a, b, c) < 0.0 ? -1.0 : 1.0;
    for (int u = 0; u <= 12; ++u) {
      for (int v = 0; v <= 10; ++v) {
        const Eigen::Vector2d p(u, v);
        const bool inside = turn * cross(a, b, p) > 1e-9 && turn * cross(b, c, p) > 1e-9 &&
                            turn * cross(c, a, p) > 1e-9;
        if (inside) {
          EXPECT_EQ(visited.count({u, v}), 1U) << "case " << n;
        }
      }
    }
  }
}

TEST(ConvexEdges, AreThoseWithOneCellThatHasBothNeighboursFree) {
  walks::Random random(3);
  const VoxelMap map = walks::clutteredMap({5, 4, 6}, 3, random);
  const auto solid = [&map](const Eigen::Vector3i& cell) {
    return map.shape.contains(cell) &&
           map.cells[static_cast<std::size_t>(map.shape.index(cell))] == CellState::kOccupied;
  };
  int edges = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const ConvexEdges convex(map, axis);
    for (int w = 0; w < convex.sizeW(); ++w) {
      for (int u = 0; u <= convex.sizeU(); ++u) {
        for (int v = 0; v <= convex.sizeV(); ++v) {
          for (int q = 0; q < 4; ++q) {
            const auto at = [&](bool upper_u, bool upper_v, int slab) {
              Eigen::Vector3i cell;
              cell[axis] = slab;
              cell[axisU(axis)] = upper_u ? u : u - 1;
              cell[axisV(axis)] = upper_v ? v : v - 1;
              return solid(cell);
            };
            const bool upper_u = (q & 1) != 0;
            const bool upper_v = (q & 2) != 0;
            const auto both = [&](bool uu, bool vv) { return at(uu, vv, w) && at(uu, vv, w - 1); };
            EXPECT_EQ((convex.quadrants(u, v, w) >> q & 1U) != 0, at(upper_u, upper_v, w) &&
                                                                      !at(!upper_u, upper_v, w) &&
                                                                      !at(upper_u, !upper_v, w));
            EXPECT_EQ((convex.joints(u, v, w) >> q & 1U) != 0, both(upper_u, upper_v) &&
                                                                   !both(!upper_u, upper_v) &&
                                                                   !both(upper_u, !upper_v));
            const ConvexEdge edge{axis, u, v, q};
            const ConvexEdge back = ConvexEdge::unpacked(edge.packed());
            EXPECT_TRUE(back.axis == axis && back.u == u && back.v == v && back.quadrant == q);
            edges += static_cast<int>(convex.quadrants(u, v, w) >> q & 1U);
          }
        }
      }
    }
  }
  EXPECT_GT(edges, 100);
}

}  // namespace
}  // namespace tautline::planning
