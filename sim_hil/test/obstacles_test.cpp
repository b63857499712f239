#include "sim_hil/obstacles.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sim_hil/convex_pieces.h"
#include "sim_hil/random.h"

namespace tautline::sim {
namespace {

double areaOf(const std::vector<Eigen::Vector2d>& p) {
  double area = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Eigen::Vector2d& a = p[i];
    const Eigen::Vector2d& b = p[(i + 1) % p.size()];
    area += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return area;
}

TEST(ConvexPieces, AConvexPolygonStaysWhole) {
  const auto pieces = convexPieces({{0, 0}, {0, 1}, {1, 1}, {1, 0}});  // clockwise
  ASSERT_EQ(pieces.size(), 1U);
  EXPECT_NEAR(areaOf(pieces[0].corner), 1.0, 1e-12);
  for (const bool inner : pieces[0].inner) EXPECT_FALSE(inner);
}

TEST(ConvexPieces, AnLShapeBecomesTwoPiecesWithOneCut) {
  const auto pieces = convexPieces({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}});
  ASSERT_EQ(pieces.size(), 2U);
  double area = 0.0;
  int cuts = 0;
  for (const ConvexPiece& piece : pieces) {
    area += areaOf(piece.corner);
    for (const bool inner : piece.inner) cuts += inner ? 1 : 0;
  }
  EXPECT_NEAR(area, 5.0, 1e-12);
  EXPECT_EQ(cuts, 2);  // both sides of the one cut
}

Scene oneBox() {
  Scene scene;
  scene.floor = 0.0;
  scene.boxes.push_back({"box", {1.0, 0.0, 2.0}, {2.0, 1.5, 2.5}});
  return scene;
}

TEST(Obstacles, SignedDistanceOfABox) {
  const Obstacles obstacles(oneBox());
  const ConvexPrism& box = obstacles.solids()[0];
  EXPECT_NEAR(signedDistance(box, {1.5, 0.75, 2.25}), -0.25, 1e-12);
  EXPECT_NEAR(signedDistance(box, {0.5, 0.75, 2.25}), 0.5, 1e-12);
  EXPECT_NEAR(signedDistance(box, {1.5, 2.0, 2.25}), 0.5, 1e-12);
  EXPECT_NEAR(signedDistance(box, {0.7, 1.9, 2.25}), 0.5, 1e-12);  // 3-4-5 off the top edge
  EXPECT_NEAR(signedDistance(box, {0.7, 1.9, 3.7}), 1.3, 1e-12);   // 5-12-13 off the corner
}

TEST(Obstacles, GroundIsTheTopOfWhatIsBelow) {
  const Obstacles obstacles(oneBox());
  EXPECT_EQ(obstacles.groundBelow({1.5, 3.0, 2.2}), 1.5);
  EXPECT_EQ(obstacles.groundBelow({1.5, 1.0, 2.2}), 0.0);
  EXPECT_EQ(obstacles.groundBelow({0.5, 3.0, 2.2}), 0.0);
}

TEST(Obstacles, AVehicleTouchesWallsButStandsOnTops) {
  const Obstacles obstacles(oneBox());
  EXPECT_TRUE(obstacles.touches({0.9, 0.5, 2.2}, 0.15, 0.1));
  EXPECT_FALSE(obstacles.touches({0.8, 0.5, 2.2}, 0.15, 0.1));
  EXPECT_FALSE(obstacles.touches({1.5, 1.6, 2.2}, 0.15, 0.1));
}

/// Deepest point of the segment in the solid by brute force.
double deepest(const ConvexPrism& prism, const Eigen::Vector3d& p0, const Eigen::Vector3d& p1) {
  double d = 1e9;
  for (int i = 0; i <= 400; ++i)
    d = std::fmin(d, signedDistance(prism, p0 + i / 400.0 * (p1 - p0)));
  return d;
}

TEST(SegmentContacts, AgreeWithBruteForceAboutOverlap) {
  const Obstacles obstacles(oneBox());
  const ConvexPrism& box = obstacles.solids()[0];
  Random random(7);
  int overlapping = 0;
  int apart = 0;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d p0(1.5 + random.signedUniform(), 0.75 + 1.2 * random.signedUniform(),
                             2.25 + 0.8 * random.signedUniform());
    const Eigen::Vector3d p1 = p0 + 0.15 * random.normal3();
    const double d = deepest(box, p0, p1);
    std::array<SegmentContact, kMaxSegmentContacts> found;
    const int count = segmentContacts(box, p0, p1, 0.0, found);
    if (d > 1e-3) {
      EXPECT_EQ(count, 0) << p0.transpose() << " to " << p1.transpose();
      ++apart;
    } else if (d < -1e-3 && d > -0.02) {
      EXPECT_GT(count, 0) << p0.transpose() << " to " << p1.transpose() << " depth " << d;
      ++overlapping;
    }
  }
  EXPECT_GT(overlapping, 300);
  EXPECT_GT(apart, 3000);
}

TEST(SegmentContacts, ObeyingTheContactsSeparates) {
  const Obstacles obstacles(oneBox());
  const ConvexPrism& box = obstacles.solids()[0];
  Random random(8);
  int tried = 0;
  for (int i = 0; i < 20000; ++i) {
    Eigen::Vector3d p0(1.5 + random.signedUniform(), 0.75 + 1.2 * random.signedUniform(),
                       2.25 + 0.8 * random.signedUniform());
    Eigen::Vector3d p1 = p0 + 0.15 * random.normal3();
    const double before = deepest(box, p0, p1);
    if (before > -1e-3 || before < -0.02) continue;
    ++tried;
    for (int pass = 0; pass < 10; ++pass) {
      std::array<SegmentContact, kMaxSegmentContacts> found;
      const int count = segmentContacts(box, p0, p1, 0.0, found);
      if (count == 0) break;
      const SegmentContact& c = found[0];
      const double depth = c.offset - c.normal.dot(p0 + c.s * (p1 - p0));
      EXPECT_NEAR(c.normal.norm(), 1.0, 1e-9);
      EXPECT_GE(depth, -1e-9);
      p0 += depth * c.normal;
      p1 += depth * c.normal;
    }
    EXPECT_GT(deepest(box, p0, p1), -1e-3);
  }
  EXPECT_GT(tried, 200);
}

TEST(SegmentContacts, AcrossACornerTheyAreOnTheEdge) {
  const Obstacles obstacles(oneBox());
  const ConvexPrism& box = obstacles.solids()[0];
  // Cuts the vertical edge at x = 1, z = 2 by a little, at height 0.5.
  const Eigen::Vector3d p0(0.9, 0.5, 2.105);
  const Eigen::Vector3d p1(1.105, 0.5, 1.9);
  std::array<SegmentContact, kMaxSegmentContacts> found;
  ASSERT_EQ(segmentContacts(box, p0, p1, 0.001, found), 1);
  const Eigen::Vector3d p = p0 + found[0].s * (p1 - p0);
  EXPECT_NEAR(p.x(), 1.0, 0.005);
  EXPECT_NEAR(p.z(), 2.0, 0.005);
  EXPECT_LT(found[0].normal.x(), -0.6);
  EXPECT_LT(found[0].normal.z(), -0.6);
}

TEST(SegmentContacts, ANarrowRailCarriesBothItsEdges) {
  Scene scene;
  scene.boxes.push_back({"rail", {-1.0, 0.0, 0.0}, {1.0, 1.0, 0.04}});
  const Obstacles obstacles(scene);
  std::array<SegmentContact, kMaxSegmentContacts> found;
  const int count =
      segmentContacts(obstacles.solids()[0], {0.0, 0.999, -0.05}, {0.0, 0.999, 0.08}, 0.005, found);
  EXPECT_EQ(count, 2);
}

TEST(SegmentContacts, NothingIsTouchedInTheNotchOfAConcaveFootprint) {
  Scene scene;
  Prism l;
  l.name = "L";
  l.footprint = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};  // (z, x)
  l.y_min = 0.0;
  l.y_max = 2.0;
  scene.prisms.push_back(l);
  const Obstacles obstacles(scene);
  std::array<SegmentContact, kMaxSegmentContacts> found;
  for (const ConvexPrism& piece : obstacles.solids()) {
    EXPECT_EQ(segmentContacts(piece, {1.5, 1.0, 2.0}, {2.0, 1.0, 1.5}, 0.01, found), 0);
    EXPECT_EQ(piece.obstacle, 0);
  }
}

TEST(Obstacles, ConfinementCountsTheSidesThatAreNear) {
  Scene scene;
  scene.floor = -100.0;
  scene.boxes.push_back({"left", {-1.5, -5.0, -9.0}, {-0.5, 5.0, 9.0}});
  constexpr double kDecay = 0.5;
  const double one = std::exp(-0.5 / kDecay);
  EXPECT_NEAR(Obstacles(scene).confinement({0, 0, 0}, kDecay), one, 1e-9);
  EXPECT_NEAR(Obstacles(scene).confinement({-0.5, 0, 0}, kDecay), 1.0, 1e-9);
  EXPECT_NEAR(Obstacles(scene).confinement({50, 0, 0}, kDecay), 0.0, 1e-9);
  scene.boxes.push_back({"left again", {-2.0, -5.0, -9.0}, {-0.6, 5.0, 9.0}});
  EXPECT_NEAR(Obstacles(scene).confinement({0, 0, 0}, kDecay), one, 1e-9) << "the same side";
  scene.boxes.push_back({"right", {0.5, -5.0, -9.0}, {1.5, 5.0, 9.0}});
  EXPECT_NEAR(Obstacles(scene).confinement({0, 0, 0}, kDecay), 2.0 * one, 1e-9);
  scene.boxes.push_back({"front", {-0.5, -5.0, 0.5}, {0.5, 5.0, 1.5}});
  scene.boxes.push_back({"back", {-0.5, -5.0, -1.5}, {0.5, 5.0, -0.5}});
  EXPECT_NEAR(Obstacles(scene).confinement({0, 0, 0}, kDecay), 4.0 * one, 1e-9) << "a shaft";
}

}  // namespace
}  // namespace tautline::sim
