#include "common/mission/scene.h"

#include <cmath>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/mission/test/test_problem.h"

namespace tautline {
namespace {

using ::testing::HasSubstr;

const std::string kRoom =
    "version = 1\nname = 'room'\nmin_m = [0, 0, 0]\nmax_m = [6, 3, 6]\nreel_m = [1, 0.5, 2]\n";

InputProblem problemIn(const std::string& text) {
  return problemOf([&] { (void)parseScene(text, "s.toml"); }, text);
}

TEST(Scene, ReadsEverything) {
  const Scene scene =
      parseScene(kRoom +
                     "floor_m = 0.125\nresolution_m = 0.2\nstart_m = [1, 0.25, 3]\n"
                     "[[boxes]]\nname = 'b'\nmin_m = [2, 0, 2]\nmax_m = [3, 1, 3]\n"
                     "sharp = true\n[[prisms]]\nname = 'p'\nfootprint_m = [[4, 4], [5, 4], [4, "
                     "5]]\ny_min_m = 0\n"
                     "y_max_m = 2\n[[rewards]]\nposition_m = [5, 1, 1]\nvalue = 0.9\n"
                     "[[layers]]\nelement = 'surface'\nmin_m = [0, 0, 0]\nmax_m = [9, 1, 3]\n"
                     "value = 0.25\n",
                 "s");
  EXPECT_EQ(scene.name, "room");
  EXPECT_EQ(scene.floor, 0.125);
  EXPECT_EQ(scene.resolution, 0.2);
  EXPECT_EQ(scene.reel, Eigen::Vector3d(1, 0.5, 2));
  EXPECT_EQ(*scene.start, Eigen::Vector3d(1, 0.25, 3));
  ASSERT_EQ(scene.boxes.size(), 1U);
  EXPECT_EQ(scene.boxes[0].max, Eigen::Vector3d(3, 1, 3));
  ASSERT_EQ(scene.prisms.size(), 1U);
  EXPECT_EQ(scene.prisms[0].footprint[1], Eigen::Vector2d(5, 4));
  EXPECT_TRUE(scene.boxes[0].sharp);
  EXPECT_FALSE(scene.prisms[0].sharp);
  ASSERT_EQ(scene.rewards.size(), 1U);
  EXPECT_EQ(scene.rewards[0].value, 0.9);
  ASSERT_EQ(scene.layers.size(), 1U);
  EXPECT_EQ(scene.layers[0].element, "surface");
  EXPECT_EQ(scene.layers[0].max, Eigen::Vector3d(9, 1, 3));
  EXPECT_EQ(scene.layers[0].value, 0.25);
}

TEST(Scene, TextReadsBackAsTheSameScene) {
  const Scene scene = parseScene(
      kRoom +
          "floor_m = 0.1\nresolution_m = 0.2\nstart_m = [1, 0.3, 3]\n"
          "[[boxes]]\nname = 'a \"b\"'\nmin_m = [2, 0, 2]\nmax_m = [3, 1.1, 3]\nsharp = true\n"
          "[[prisms]]\nname = 'p'\nfootprint_m = [[4, 4], [5.3, 4], [4, 5]]\ny_min_m = 0\n"
          "y_max_m = 2\n[[rewards]]\nposition_m = [5, 1, 1]\nvalue = 0.9\n"
          "[[layers]]\nelement = 'surface'\nmin_m = [0, 0, 0]\nmax_m = [9, 1, 3]\nvalue = 0.7\n",
      "s");
  const Scene world = sceneInWorld(scene);
  const Scene again = parseScene(sceneText(world), "again");
  EXPECT_EQ(again.name, world.name);
  EXPECT_EQ(again.min, world.min);
  EXPECT_EQ(again.max, world.max);
  EXPECT_EQ(again.floor, world.floor);
  EXPECT_EQ(again.resolution, world.resolution);
  EXPECT_EQ(again.reel, world.reel);
  EXPECT_EQ(again.start, world.start);
  ASSERT_EQ(again.boxes.size(), 1U);
  EXPECT_EQ(again.boxes[0].name, world.boxes[0].name);
  EXPECT_EQ(again.boxes[0].min, world.boxes[0].min);
  EXPECT_EQ(again.boxes[0].max, world.boxes[0].max);
  EXPECT_TRUE(again.boxes[0].sharp);
  ASSERT_EQ(again.prisms.size(), 1U);
  EXPECT_EQ(again.prisms[0].footprint, world.prisms[0].footprint);
  EXPECT_EQ(again.prisms[0].y_min, world.prisms[0].y_min);
  EXPECT_EQ(again.prisms[0].y_max, world.prisms[0].y_max);
  EXPECT_FALSE(again.prisms[0].sharp);
  ASSERT_EQ(again.rewards.size(), 1U);
  EXPECT_EQ(again.rewards[0].position, world.rewards[0].position);
  EXPECT_EQ(again.rewards[0].value, 0.9);
  ASSERT_EQ(again.layers.size(), 1U);
  EXPECT_EQ(again.layers[0].element, "surface");
  EXPECT_EQ(again.layers[0].min, world.layers[0].min);
  EXPECT_EQ(again.layers[0].max, world.layers[0].max);
  EXPECT_EQ(again.layers[0].value, 0.7);
}

TEST(Scene, EveryErrorNamesItsRow) {
  const std::string layer = "[[layers]]\nelement = 'surface'\nmin_m = [0, 0, 0]\n";
  const std::string prism = "[[prisms]]\nname = 'p'\ny_min_m = 0\ny_max_m = 2\nfootprint_m = ";
  struct Case {
    std::string text;
    std::string key;
  };
  for (const Case& c : {
           Case{"version = 2\nname = 'x'\n", "version"},
           Case{"version = 1\nname = 'x'\nmin_m = [0, 0, 0]\nmax_m = [1, 0, 1]\nreel_m = [0, 0, "
                "0]\n",
                "max_m"},
           Case{kRoom + "colour = 'red'\n", "colour"},
           Case{kRoom + "start_m = [7, 1, 1]\n", "start_m"},
           Case{kRoom + "resolution_m = 0\n", "resolution_m"},
           Case{kRoom + "[[boxes]]\nname = 'b'\nmin_m = [2, 0, 2]\nmax_m = [2, 1, 3]\n",
                "boxes[0].max_m"},
           Case{kRoom + "[[boxes]]\nname = 'b'\nmin_m = [0, 0, 0]\nmax_m = [2, 1, 3]\n", "reel_m"},
           Case{kRoom + prism + "[[4, 4], [5, 4]]\n", "prisms[0].footprint_m"},
           Case{kRoom + prism + "[[4, 4], [5, 5], [5, 4], [4, 5]]\n", "prisms[0].footprint_m"},
           Case{kRoom + prism + "[[4, 4], [5, 4], [4, 5], [4, 4]]\n", "prisms[0].footprint_m"},
           Case{kRoom + prism + "[[4, 4], [5, 4], [6, 4]]\n", "prisms[0].footprint_m"},
           Case{kRoom + prism + "[[1, 0], [3, 0], [1, 4]]\n", "reel_m"},
           Case{kRoom + "[[rewards]]\nposition_m = [9, 1, 1]\nvalue = 1\n",
                "rewards[0].position_m"},
           Case{kRoom + "[[rewards]]\nposition_m = [5, 1, 1]\nvalue = -1\n", "rewards[0].value"},
           Case{kRoom + layer + "max_m = [1, 1, 1]\nvalue = -0.1\n", "layers[0].value"},
           Case{kRoom + layer + "max_m = [1, 1, 1]\nvalue = 1.1\n", "layers[0].value"},
           Case{kRoom + layer + "max_m = [1, 1, 1]\n", "layers[0].value"},
           Case{kRoom + layer + "max_m = [1, 0, 1]\nvalue = 1\n", "layers[0].max_m"},
           Case{kRoom + layer + "max_m = [1, 1, 1]\nvalue = 1\n" +
                    "[[layers]]\nelement = 'surface'\nmin_m = [6, 0, 0]\nmax_m = [7, 1, "
                    "1]\nvalue = 1\n",
                "layers[1].min_m"},
           Case{kRoom + "[[layers]]\nmin_m = [0, 0, 0]\nmax_m = [1, 1, 1]\nvalue = 1\n",
                "layers[0].element"},
       }) {
    EXPECT_EQ(problemIn(c.text).key, c.key) << c.text;
  }
}

TEST(Scene, InWorldTheReelIsTheOriginAndShapesKeepTheirPlace) {
  const Scene scene = parseScene(
      kRoom +
          "start_m = [1, 0.25, 3]\n[[boxes]]\nname = 'b'\nmin_m = [2, 0, 2]\nmax_m = [3, 1, 3]\n"
          "[[prisms]]\nname = 'p'\nfootprint_m = [[4, 4], [5, 4], [4, 5]]\ny_min_m = 0\n"
          "y_max_m = 2\n[[rewards]]\nposition_m = [5, 1, 1]\nvalue = 0.9\n"
          "[[layers]]\nelement = 'surface'\nmin_m = [0, 0, 0]\nmax_m = [9, 1, 3]\nvalue = 1\n",
      "s");
  const Scene world = sceneInWorld(scene);
  EXPECT_TRUE(world.reel.isZero(0.0));
  EXPECT_EQ(world.floor, -0.5);
  EXPECT_EQ(*world.start, Eigen::Vector3d(0, -0.25, 1));
  EXPECT_EQ(world.rewards[0].position, Eigen::Vector3d(4, 0.5, -1));
  EXPECT_EQ(world.layers[0].min, Eigen::Vector3d(-1, -0.5, -2));
  EXPECT_EQ(world.layers[0].max, Eigen::Vector3d(8, 0.5, 1));
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(0.0, 6.0);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d p(uniform(random), uniform(random) / 2, uniform(random));
    EXPECT_NEAR(clearance(p, scene), clearance(p - scene.reel, world), 1e-12);
  }
}

const Box kBox{"box", {1, 0, 1}, {2, 2, 3}};

TEST(Intersection, StraightThroughABox) {
  const auto hit = intersect({0, 1, 2}, {4, 1, 2}, kBox);
  ASSERT_TRUE(hit.has_value());
  EXPECT_DOUBLE_EQ(hit->t_in, 0.25);
  EXPECT_DOUBLE_EQ(hit->t_out, 0.5);
  EXPECT_TRUE(intersect({1.5, 1, 2}, {1.5, 1, 2.5}, kBox).has_value());  // wholly inside
}

TEST(Intersection, TouchingIsNoHit) {
  EXPECT_FALSE(intersect({0, 1, 1}, {4, 1, 1}, kBox).has_value());  // along a face
  EXPECT_FALSE(intersect({0, 1, 2}, {2, 1, 0}, kBox).has_value());  // at an edge
  EXPECT_FALSE(intersect({0, 1, 2}, {1, 1, 2}, kBox).has_value());  // ends on a face
  EXPECT_FALSE(intersect({0, 3, 2}, {4, 3, 2}, kBox).has_value());  // above
}

Prism boxAsPrism() { return {"prism", {{1, 1}, {3, 1}, {3, 2}, {1, 2}}, 0, 2}; }

/// A star with notches, so that lines may enter it more than once.
Prism notched() {
  return {"notched", {{0, 0}, {4, 0}, {4, 4}, {3, 1}, {2, 3}, {1, 1}, {0, 4}}, -1, 2};
}

TEST(Intersection, PrismOfABoxAgreesWithTheBox) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(-1.0, 4.0);
  int hits = 0;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3d p(uniform(random), uniform(random), uniform(random));
    const Eigen::Vector3d q(uniform(random), uniform(random), uniform(random));
    const auto from_box = intersect(p, q, kBox);
    const auto from_prism = intersect(p, q, boxAsPrism());
    ASSERT_EQ(from_box.has_value(), from_prism.has_value());
    EXPECT_NEAR(signedDistance(p, kBox), signedDistance(p, boxAsPrism()), 1e-12);
    if (!from_box) continue;
    ++hits;
    EXPECT_NEAR(from_box->t_in, from_prism->t_in, 1e-12);
    EXPECT_NEAR(from_box->t_out, from_prism->t_out, 1e-12);
  }
  EXPECT_GT(hits, 300);
}

/// Winding number of the footprint about the point: shares nothing with the crossing count of the
/// code.
bool insideByAngles(const Eigen::Vector3d& p, const Prism& prism) {
  if (p.y() <= prism.y_min || p.y() >= prism.y_max) return false;
  double turn = 0.0;
  const Eigen::Vector2d x(p.z(), p.x());
  for (std::size_t i = 0; i < prism.footprint.size(); ++i) {
    const Eigen::Vector2d a = prism.footprint[i] - x;
    const Eigen::Vector2d b = prism.footprint[(i + 1) % prism.footprint.size()] - x;
    turn += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  }
  return std::abs(turn) > 3.0;
}

TEST(Intersection, FirstStretchInANotchedPrismAgreesWithSampling) {
  const Prism prism = notched();
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> uniform(-2.0, 6.0);
  int hits = 0;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d p(uniform(random), uniform(random) / 2, uniform(random));
    const Eigen::Vector3d q(uniform(random), uniform(random) / 2, uniform(random));
    const auto hit = intersect(p, q, prism);
    constexpr int kSteps = 2000;
    double sampled_in = -1.0;
    double sampled_out = -1.0;
    for (int k = 0; k <= kSteps; ++k) {
      const double t = static_cast<double>(k) / kSteps;
      if (insideByAngles(p + t * (q - p), prism)) {
        if (sampled_in < 0.0) sampled_in = t;
        sampled_out = t;
      } else if (sampled_in >= 0.0) {
        break;
      }
    }
    if (sampled_in < 0.0) {
      EXPECT_TRUE(!hit || hit->t_out - hit->t_in < 2.0 / kSteps);
      continue;
    }
    ASSERT_TRUE(hit.has_value());
    if (hit->t_out - hit->t_in < 2.0 / kSteps) continue;  // too short for the samples
    ++hits;
    EXPECT_NEAR(hit->t_in, sampled_in, 1.01 / kSteps);
    EXPECT_NEAR(hit->t_out, sampled_out, 1.01 / kSteps);
  }
  EXPECT_GT(hits, 100);
}

TEST(SignedDistance, HasUnitSlopeAtMostAndTheSignOfInside) {
  const Prism prism = notched();
  std::mt19937_64 random(13);
  std::uniform_real_distribution<double> uniform(-2.0, 6.0);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d p(uniform(random), uniform(random) / 2, uniform(random));
    const Eigen::Vector3d q(uniform(random), uniform(random) / 2, uniform(random));
    EXPECT_LE(std::abs(signedDistance(p, prism) - signedDistance(q, prism)),
              (p - q).norm() + 1e-12);
    EXPECT_EQ(signedDistance(p, prism) < 0.0, insideByAngles(p, prism));
    EXPECT_LE(std::abs(signedDistance(p, kBox) - signedDistance(q, kBox)), (p - q).norm() + 1e-12);
  }
  EXPECT_DOUBLE_EQ(signedDistance({0, 1, 0}, kBox), std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(signedDistance({1.5, 1, 1.25}, kBox), -0.25);
}

TEST(FirstHit, IsTheNearestObstacle) {
  Scene scene;
  scene.boxes = {{"far", {3, 0, 0}, {4, 1, 1}}, {"near", {1, 0, 0}, {2, 1, 1}}};
  scene.prisms = {{"nearer", {{0, 0.5}, {1, 0.5}, {1, 0.75}, {0, 0.75}}, 0, 1}};
  EXPECT_EQ(firstHit({0, 0.5, 0.5}, {5, 0.5, 0.5}, scene)->obstacle, "nearer");
  EXPECT_EQ(firstHit({5, 0.5, 0.5}, {0, 0.5, 0.5}, scene)->obstacle, "far");
  EXPECT_FALSE(firstHit({0, 2, 0.5}, {5, 2, 0.5}, scene).has_value());
}

}  // namespace
}  // namespace tautline
