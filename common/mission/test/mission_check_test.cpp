#include "common/mission/mission_check.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/toml/config_file.h"

namespace tautline {
namespace {

using ::testing::HasSubstr;

struct Point {
  double x, y, z;
  int contact{0};
};

Mission missionOf(const std::vector<Point>& points, const std::string& contacts = "") {
  std::string text =
      "version = 1\nname = 'test'\nframe = 'W'\nreel_position_m = [1, 0.5, 1]\n" + contacts;
  for (const Point& p : points) {
    text += "[[waypoints]]\nposition_m = " + tomlText(Eigen::Vector3d(p.x, p.y, p.z)) +
            "\ncontact = " + std::to_string(p.contact) + "\n";
  }
  return parseMission(text, "m");
}

/// A room of 8 x 3 x 8 m, a pillar with its edges at W (x, z) = (1..1.5, 2..2.5), the reel at M (1,
/// 0.5, 1).
Scene pillarScene() {
  return parseScene(
      "version = 1\nname = 'pillar'\nmin_m = [0, 0, 0]\nmax_m = [8, 3, 8]\nreel_m = [1, 0.5, 1]\n"
      "[[boxes]]\nname = 'pillar'\nmin_m = [2, 0, 3]\nmax_m = [2.5, 3, 3.5]\n",
      "s");
}

std::string textOf(const std::vector<MissionFinding>& findings) {
  std::string text;
  for (const MissionFinding& f : findings) {
    text +=
        std::string(nameOf(f.severity, kFindingSeverityNames)) + " " + f.row + ": " + f.text + "\n";
  }
  return text;
}

std::string check(const Mission& mission, const Scene* scene = nullptr,
                  const MissionLimits& limits = {}) {
  return textOf(checkMission(mission, limits, scene));
}

TEST(MissionCheck, GoodMissionHasNoFindings) {
  EXPECT_EQ(check(missionOf({{0, 1, 1}, {1, 1, 1}, {1, 1, 2}})), "");
  const Scene scene = pillarScene();
  EXPECT_EQ(check(missionOf({{0, 1, 1}, {0, 1, 2}}), &scene), "");
}

TEST(MissionCheck, FirstWaypointMustBeReachableAfterTakeoff) {
  EXPECT_THAT(check(missionOf({{0, 0.1, 2}})), HasSubstr("error waypoints[0]: elevation 2.9 deg"));
  EXPECT_THAT(check(missionOf({{0, 2, 0.05}})),
              HasSubstr("error waypoints[0]: elevation 88.6 deg"));
  EXPECT_THAT(check(missionOf({{1, 1, 1, 1}}, "contacts = [{id = 1, position_m = [1, 0, 0]}]\n")),
              HasSubstr("error waypoints[0]: starts with contact 1 formed"));
  EXPECT_THAT(check(missionOf({{0, 0.1, 0.1}})),
              HasSubstr("error waypoints[0]: 0.14 m from the reel"));
  // Only the first one: later waypoints may be low.
  EXPECT_EQ(check(missionOf({{0, 1, 1}, {0, 0.1, 1.5}})), "");
}

TEST(MissionCheck, TetherLengthCountsTheStaticPart) {
  const std::string contact =
      "contacts = [{id = 1, position_m = [0, 1.5, 3]}]\n";  // 3.354 m from the reel
  const Mission mission = missionOf({{0, 2, 4}, {0, 2.5, 5, 1}}, contact);
  MissionLimits limits;
  limits.tension = 5.0;  // nearly straight
  limits.tether_length_max = 3.354 + 2.2361 + 0.02;
  EXPECT_THAT(check(mission, nullptr, limits), ::testing::Not(HasSubstr("error")));
  limits.tether_length_max -= 0.03;
  EXPECT_THAT(check(mission, nullptr, limits),
              HasSubstr("error waypoints[1]: needs 5.59 m of tether"));
}

TEST(MissionCheck, WeightOfTheTetherLimitsTheReach) {
  // findings of the tether model: (5, 1) m needs 0.258 N at 0.0061 kg/m.
  MissionLimits limits;
  limits.tension = 0.25;
  EXPECT_THAT(check(missionOf({{5, 1, 0}}), nullptr, limits), HasSubstr("needs 0.26 N"));
  limits.tension = 0.27;
  EXPECT_THAT(check(missionOf({{5, 1, 0}}), nullptr, limits), ::testing::Not(HasSubstr("error")));
  EXPECT_THAT(check(missionOf({{5, 1, 0}}), nullptr, limits), HasSubstr("sags onto the floor"));
}

TEST(MissionCheck, FloorAndCeiling) {
  EXPECT_THAT(check(missionOf({{0, 1, 1}, {0, -0.45, 2}})),
              HasSubstr("error waypoints[1]: 0.05 m above the floor"));
  const Scene scene = pillarScene();
  EXPECT_THAT(check(missionOf({{0, 1, 1}, {0, 2.45, 2}}), &scene),
              HasSubstr("error waypoints[1]: 0.05 m below the ceiling"));
  EXPECT_THAT(check(missionOf({{0, 1, 1}, {0, 1, 7.5}}), &scene),
              HasSubstr("error waypoints[1]: outside the room"));
}

TEST(MissionCheck, WayPastTheReelIsAnErrorAndOverItAnInformation) {
  EXPECT_THAT(check(missionOf({{1, 1, 1}, {-1, -0.3, -1}})), ::testing::Not(HasSubstr("passes")));
  EXPECT_THAT(check(missionOf({{1, 0.2, 0}, {-1, 0.2, 0}})),
              HasSubstr("error waypoints[1]: on the way the drone passes 0.20 m"));
  const std::string over =
      check(missionOf({{1, 1.5, 0.1}, {0.1, 1.5, 0.1}, {-1, 1.5, 0.1}, {-1, 1.5, 1}}));
  EXPECT_EQ(over,
            "info waypoints[1]: the drone comes within 0.10 m of the pole, the vertical above the "
            "reel\n");
}

TEST(MissionCheck, RepeatedWaypointIsAWarning) {
  const std::vector<MissionFinding> findings = checkMission(missionOf({{0, 1, 1}, {0, 1, 1}}), {});
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].severity, FindingSeverity::kWarning);
  EXPECT_EQ(findings[0].row, "waypoints[1]");
  EXPECT_TRUE(isFlyable(findings));
}

TEST(MissionCheck, UnusedContactIsAWarning) {
  EXPECT_THAT(check(missionOf({{0, 1, 1}}, "contacts = [{id = 4, position_m = [1, 0, 0]}]\n")),
              HasSubstr("warning contacts[0]: no waypoint uses contact 4"));
}

TEST(MissionCheck, ObstaclesOnTheWay) {
  const Scene scene = pillarScene();
  EXPECT_THAT(
      check(missionOf({{0.4, 1, 1.5}, {2.2, 1, 3}}), &scene),
      HasSubstr(
          "error waypoints[1]: the way from the waypoint before leads through obstacle 'pillar'"));
  EXPECT_THAT(check(missionOf({{1.2, 1, 2.2}}), &scene),
              HasSubstr("error waypoints[0]: inside an obstacle"));
  EXPECT_THAT(check(missionOf({{0.4, 1, 1.5}, {0.8, 1, 2.2}}), &scene),
              HasSubstr("warning waypoints[1]: the drone comes within 0.20 m"));
}

TEST(MissionCheck, TetherThatCutsAnObstacleNeedsAContact) {
  const Scene scene = pillarScene();
  const std::string contact = "contacts = [{id = 1, position_m = [1, 1, 2.5]}]\n";
  EXPECT_THAT(check(missionOf({{0.4, 1, 2}, {0.8, 1.2, 3.2}, {2, 1.4, 3.2}}), &scene),
              HasSubstr("error waypoints[2]: the tether from the reel cuts"));
  // The edge touched first is (1, 2.5); in line with it, 1 m behind: (1.358, 1.358, 3.394).
  const std::string good = check(
      missionOf({{0.4, 1, 2}, {0.4, 1, 3.2}, {1.358, 1.358, 3.394}, {2, 1.5, 3.2, 1}}, contact),
      &scene);
  EXPECT_EQ(good, "info waypoints[3]: forms contact 1, tether length changes by 0.00 m\n");
  const std::string late = check(
      missionOf({{0.4, 1, 2}, {0.4, 1, 3.2}, {2, 1.4, 3.2}, {2.2, 1.5, 3.2, 1}}, contact), &scene);
  EXPECT_THAT(late, HasSubstr("error waypoints[2]: the tether from the reel cuts"));
  const std::string early = check(missionOf({{0.4, 1, 2}, {2, 1.5, 3.2, 1}}, contact), &scene);
  EXPECT_THAT(early, HasSubstr("warning waypoints[1]: the tether does not lie on contact 1"));
}

TEST(MissionCheck, ContactMustLieOnAnObstacle) {
  const Scene scene = pillarScene();
  EXPECT_THAT(check(missionOf({{0.4, 1, 2}, {0.5, 1, 2, 1}},
                              "contacts = [{id = 1, position_m = [0.5, 1, 3]}]\n"),
                    &scene),
              HasSubstr("error contacts[0]: no obstacle within 0.02 m"));
  EXPECT_THAT(check(missionOf({{0.4, 1, 2}, {0.5, 1, 2, 1}},
                              "contacts = [{id = 1, position_m = [1.2, 1, 2.2]}]\n"),
                    &scene),
              HasSubstr("error contacts[0]: 0.20 m inside an obstacle"));
}

TEST(MissionCheck, SeveralChangesOfAnchorAtOnePlaceCountAsOne) {
  const Scene scene = pillarScene();
  // At the place in line the first contact gives way to another on the same edge: for no time the
  // reel is the anchor, from where the tether would cut the pillar after the jump.
  const std::string contacts =
      "contacts = [{id = 1, position_m = [1, 1, 2.5]}, {id = 2, position_m = [1, 1.01, 2.5]}]\n";
  const std::string text = check(missionOf({{0.4, 1, 2},
                                            {0.4, 1, 3.2},
                                            {1.358, 1.358, 3.394},
                                            {2, 1.5, 3.2, 1},
                                            {2, 1.5, 3.2},
                                            {2.2, 1.6, 3.2, 2}},
                                           contacts),
                                 &scene);
  EXPECT_EQ(text,
            "info waypoints[3]: forms contact 1, tether length changes by 0.00 m\n"
            "info waypoints[4]: relaxes to the reel, tether length changes by 0.13 m\n"
            "info waypoints[5]: forms contact 2, tether length changes by 0.00 m\n");
}

TEST(MissionCheck, AContactOnASharpObstacleIsAnError) {
  Scene scene = pillarScene();
  const Mission mission =
      missionOf({{0.4, 1, 2}, {0.4, 1, 3.2}, {1.358, 1.358, 3.394}, {2, 1.5, 3.2, 1}},
                "contacts = [{id = 1, position_m = [1, 1, 2.5]}]\n");
  EXPECT_TRUE(isFlyable(checkMission(mission, {}, &scene)));
  scene.boxes[0].sharp = true;
  EXPECT_THAT(check(mission, &scene),
              HasSubstr("error contacts[0]: touches the sharp obstacle 'pillar'"));
}

TEST(MissionCheck, SceneOfAnotherPlaceIsAnError) {
  const Scene scene = parseScene(
      "version = 1\nname = 'other'\nmin_m = [0, 0, 0]\nmax_m = [8, 3, 8]\nreel_m = [1, 0.5, 2]\n",
      "s");
  EXPECT_THAT(check(missionOf({{0, 1, 1}}), &scene),
              HasSubstr("reel_position_m is 1.00 m from the reel"));
}

TEST(MissionCheck, ChangedSceneIsAWarning) {
  const Scene scene = pillarScene();
  Mission mission = missionOf({{0, 1, 1}, {0, 1, 2}});
  mission.map_hash = hashText(scene.hash);
  EXPECT_EQ(check(mission, &scene), "");
  mission.map_hash = hashText(scene.hash + 1);
  EXPECT_THAT(check(mission, &scene), HasSubstr("warning : scene 'pillar' has changed"));
}

TEST(MissionCheck, CutDepthIsHowFarTheLineGetsInside) {
  const Scene scene = sceneInWorld(pillarScene());
  std::string obstacle;
  EXPECT_NEAR(cutDepth({0, 1, 2.25}, {3, 1, 2.25}, scene, &obstacle), 0.25, 1e-9);
  EXPECT_EQ(obstacle, "pillar");
  EXPECT_NEAR(cutDepth({0, 1, 2.03}, {3, 1, 2.03}, scene), 0.03, 1e-9);
  EXPECT_EQ(cutDepth({0, 1, 2}, {3, 1, 2}, scene), 0.0);
}

TEST(MissionLimits, DefaultsAreInTheirOwnRanges) {
  EXPECT_EQ(dumpConfig(parseConfig<MissionLimits>(dumpConfig(MissionLimits{}), "limits")),
            dumpConfig(MissionLimits{}));
}

}  // namespace
}  // namespace tautline
