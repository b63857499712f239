/// @file
/// The missions and scenes in config/, checked by geometry that shares nothing with
/// mission_check.cpp: every contact mission is flown along its straight legs in 1 cm steps with a
/// straight tether made of 5 mm pieces.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/mission/mission_check.h"
#include "common/mission/mission_file.h"
#include "common/mission/scene.h"
#include "common/toml/toml_file.h"

namespace tautline {
namespace {

const std::filesystem::path kConfig = TAUTLINE_SOURCE_DIR "/config";

std::vector<std::string> shippedNames() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kConfig / "missions")) {
    const std::string file = entry.path().filename().string();
    const std::size_t end = file.find(".mission.toml");
    if (end != std::string::npos) names.push_back(file.substr(0, end));
  }
  std::sort(names.begin(), names.end());
  return names;
}

Mission mission(const std::string& name) {
  return readMission(kConfig / "missions" / (name + ".mission.toml"));
}

Scene sceneOf(const Mission& m) { return readScene(kConfig / "missions" / m.map); }

std::vector<Waypoint> waypoints(const Mission& m) {
  return {m.plan->waypoints.begin(), m.plan->waypoints.begin() + m.plan->waypoint_count};
}

/// Distance from a point to a box, zero inside.
double distanceToBox(const Eigen::Vector3d& p, const Box& box) {
  return (p - p.cwiseMax(box.min).cwiseMin(box.max)).norm();
}

/// True if the straight line a-b is anywhere deeper than `depth` inside an obstacle.
bool cutsDeeper(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Scene& scene_W,
                double depth) {
  const int pieces = static_cast<int>((b - a).norm() / 0.005) + 1;
  for (const Box& box : scene_W.boxes) {
    for (int i = 0; i <= pieces; ++i) {
      const Eigen::Vector3d p = a + (b - a) * i / pieces;
      const Eigen::Vector3d margin = (p - box.min).cwiseMin(box.max - p);
      if (margin.minCoeff() > depth) return true;
    }
  }
  return false;
}

/// One instant of a flight along the legs.
struct Instant {
  Eigen::Vector3d p_WD;
  std::vector<Eigen::Vector3d> anchors;  ///< Reel first, active one last.
  double path{0.0};                      ///< [m] flown.
};

std::vector<Instant> fly(const Mission& m) {
  std::vector<Instant> flight;
  std::vector<Eigen::Vector3d> anchors{Eigen::Vector3d::Zero()};
  const std::vector<Waypoint> points = waypoints(m);
  double path = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Eigen::Vector3d contact = points[i].contact == 0
                                        ? Eigen::Vector3d::Zero()
                                        : m.plan->findContact(points[i].contact)->p_WC;
    const auto known = std::find(anchors.begin(), anchors.end(), contact);
    if (known == anchors.end()) {
      anchors.push_back(contact);
    } else {
      anchors.erase(known + 1, anchors.end());
    }
    const Eigen::Vector3d leg = points[i].p_WD - points[i - 1].p_WD;
    const int steps = static_cast<int>(leg.norm() / 0.01) + 1;
    for (int k = 0; k <= steps; ++k) {
      flight.push_back(
          {points[i - 1].p_WD + leg * k / steps, anchors, path + leg.norm() * k / steps});
    }
    path += leg.norm();
  }
  return flight;
}

class Shipped : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Missions, Shipped, ::testing::ValuesIn(shippedNames()),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

TEST_P(Shipped, IsCanonicalAndFlyableWithoutWarnings) {
  const Mission m = mission(GetParam());
  EXPECT_EQ(m.name, GetParam());
  EXPECT_EQ(canonicalText(m), readTextFile(kConfig / "missions" / (GetParam() + ".mission.toml")));
  const Scene scene = sceneOf(m);
  for (const MissionFinding& finding : checkMission(m, {}, &scene)) {
    EXPECT_EQ(finding.severity, FindingSeverity::kInfo) << finding.row << ": " << finding.text;
  }
}

TEST_P(Shipped, FlightIsShortAndModerate) {
  const Mission m = mission(GetParam());
  double seconds = 0.0;
  const std::vector<Waypoint> points = waypoints(m);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_GE(points[i].speed, 0.2);
    EXPECT_LE(points[i].speed, 0.4);
    seconds += points[i].hold;
    if (i > 0) seconds += (points[i].p_WD - points[i - 1].p_WD).norm() / points[i].speed;
  }
  EXPECT_LT(seconds, 90.0);
}

TEST_P(Shipped, ParkedDroneCanTakeOff) {
  const Scene scene = sceneInWorld(sceneOf(mission(GetParam())));
  ASSERT_TRUE(scene.start.has_value());
  EXPECT_NEAR(scene.start->y() - scene.floor, 0.1, 0.02);
  EXPECT_GE(scene.start->norm(), 0.8);
  EXPECT_LE(scene.start->norm(), 1.0);
  // The swing up to 50 degrees at constant tether length stays clear of everything.
  const double azimuth = std::atan2(scene.start->x(), scene.start->z());
  for (int degrees = 0; degrees <= 50; ++degrees) {
    const double theta = degrees * std::numbers::pi / 180.0;
    const Eigen::Vector3d p =
        scene.start->norm() * Eigen::Vector3d(std::cos(theta) * std::sin(azimuth), std::sin(theta),
                                              std::cos(theta) * std::cos(azimuth));
    for (const Box& box : scene.boxes) EXPECT_GE(distanceToBox(p, box), 0.4);
  }
}

TEST(ShippedMissions, AreAllThere) {
  EXPECT_THAT(shippedNames(), ::testing::IsSupersetOf({"square", "one_contact", "two_contacts"}));
  const std::vector<std::string> intervals{"0.2", "0.5", "1", "1.5", "3"};
  const std::vector<int> path1{31, 13, 7, 5, 3};  // as published
  const std::vector<int> path2{16, 7, 4, 3, 2};
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    EXPECT_EQ(mission("path1_" + intervals[i]).plan->waypoint_count, path1[i]);
    EXPECT_EQ(mission("path2_" + intervals[i]).plan->waypoint_count, path2[i]);
  }
}

TEST(ShippedMissions, PathsHaveThePublishedCorners) {
  for (const char* interval : {"0.2", "0.5", "1", "1.5", "3"}) {
    const std::vector<Waypoint> path1 = waypoints(mission(std::string("path1_") + interval));
    EXPECT_EQ(path1.front().p_WD, Eigen::Vector3d(-1.5, 1, 1.5));
    EXPECT_EQ(path1.back().p_WD, Eigen::Vector3d(1.5, 1.9, -1.5));
    EXPECT_TRUE(std::any_of(path1.begin(), path1.end(), [](const Waypoint& w) {
      return w.p_WD == Eigen::Vector3d(1.5, 1, 1.5);
    }));
    const std::vector<Waypoint> path2 = waypoints(mission(std::string("path2_") + interval));
    EXPECT_EQ(path2.front().p_WD, Eigen::Vector3d(1.5, 1.5, 1.5));
    EXPECT_EQ(path2.back().p_WD, Eigen::Vector3d(-1.5, 1.5, -1.5));
  }
}

class ContactMission : public ::testing::TestWithParam<const char*> {
 protected:
  Mission m_{mission(GetParam())};
  Scene scene_{sceneInWorld(sceneOf(m_))};
  std::vector<Instant> flight_{fly(m_)};
};
INSTANTIATE_TEST_SUITE_P(Missions, ContactMission,
                         ::testing::Values("one_contact", "two_contacts"));

TEST_P(ContactMission, TetherNeverCutsAnObstacle) {
  for (const Instant& now : flight_) {
    for (std::size_t i = 0; i + 1 < now.anchors.size(); ++i) {
      EXPECT_FALSE(cutsDeeper(now.anchors[i], now.anchors[i + 1], scene_, 0.001));
    }
    EXPECT_FALSE(cutsDeeper(now.anchors.back(), now.p_WD, scene_, 0.02))
        << "at " << now.p_WD.transpose();
  }
}

TEST_P(ContactMission, AnchorChangesOnlyInLineAndOnlyWhenItMust) {
  int pushes = 0;
  int pops = 0;
  for (std::size_t i = 1; i < flight_.size(); ++i) {
    const std::vector<Eigen::Vector3d>& before = flight_[i - 1].anchors;
    const std::vector<Eigen::Vector3d>& after = flight_[i].anchors;
    if (before.size() == after.size()) continue;
    const bool push = after.size() > before.size();
    ++(push ? pushes : pops);
    const std::vector<Eigen::Vector3d>& longer = push ? after : before;
    ASSERT_EQ(longer.size(), (push ? before : after).size() + 1);
    const Eigen::Vector3d contact = longer.back();
    const Eigen::Vector3d below = longer[longer.size() - 2];
    const Eigen::Vector3d p_WD = flight_[i].p_WD;
    // In line: the detour over the contact is a few millimetres, the bend under a degree.
    EXPECT_LT((contact - below).norm() + (p_WD - contact).norm() - (p_WD - below).norm(), 0.002);
    EXPECT_LT((contact - below).cross(p_WD - contact).norm(),
              0.02 * (contact - below).norm() * (p_WD - contact).norm());
    // On the side where the contact holds (0.3 m along the way), the line past it would cut the
    // obstacle; on the other not.
    for (const Instant& other : flight_) {
      const double ahead = other.path - flight_[i].path;
      if (std::abs(std::abs(ahead) - 0.3) > 0.01) continue;
      EXPECT_EQ(cutsDeeper(below, other.p_WD, scene_, 0.001), (ahead > 0.0) == push)
          << "at " << other.p_WD.transpose();
    }
  }
  const int contacts = m_.plan->contact_count;
  EXPECT_EQ(contacts, GetParam() == std::string("one_contact") ? 1 : 2);
  EXPECT_EQ(pushes, contacts);
  EXPECT_EQ(pops, contacts);
  EXPECT_EQ(flight_.back().anchors.size(), 1U);
  EXPECT_LT((flight_.back().p_WD - flight_.front().p_WD).norm(), 0.3);
}

TEST_P(ContactMission, ContactsLieOnVerticalEdges) {
  for (int i = 0; i < m_.plan->contact_count; ++i) {
    const Eigen::Vector3d& c = m_.plan->contacts[static_cast<std::size_t>(i)].p_WC;
    EXPECT_TRUE(std::any_of(scene_.boxes.begin(), scene_.boxes.end(), [&](const Box& box) {
      const auto on = [](double value, double low, double high) {
        return std::min(std::abs(value - low), std::abs(value - high)) < 1e-9;
      };
      return on(c.x(), box.min.x(), box.max.x()) && on(c.z(), box.min.z(), box.max.z()) &&
             c.y() > box.min.y() && c.y() < box.max.y();
    }));
  }
}

TEST_P(ContactMission, DroneKeepsItsDistancesAndAngles) {
  for (const Instant& now : flight_) {
    for (const Box& box : scene_.boxes)
      EXPECT_GE(distanceToBox(now.p_WD, box), 0.4) << now.p_WD.transpose();
    EXPECT_GE((now.p_WD - scene_.min).minCoeff(), 0.4);
    EXPECT_GE((scene_.max - now.p_WD).minCoeff(), 0.4);
    const Eigen::Vector3d p_AD = now.p_WD - now.anchors.back();
    const double elevation =
        std::atan2(p_AD.y(), std::hypot(p_AD.x(), p_AD.z())) * 180.0 / std::numbers::pi;
    EXPECT_GT(elevation, 10.0);
    EXPECT_LT(elevation, 75.0);
    double length = p_AD.norm();
    for (std::size_t i = 0; i + 1 < now.anchors.size(); ++i)
      length += (now.anchors[i + 1] - now.anchors[i]).norm();
    EXPECT_LT(length, 8.0);
  }
}

TEST_P(ContactMission, ParkedDronePointsAtTheFirstWaypoint) {
  const Eigen::Vector3d first = waypoints(m_).front().p_WD;
  EXPECT_NEAR(std::atan2(scene_.start->x(), scene_.start->z()), std::atan2(first.x(), first.z()),
              0.02);
}

}  // namespace
}  // namespace tautline
