#include "common/mission/mission_file.h"

#include <cstdlib>
#include <filesystem>
#include <limits>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/mission/test/test_problem.h"
#include "common/toml/toml_file.h"

namespace tautline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string kHead = "version = 1\nname = 'test'\nframe = 'W'\n";
const std::string kContacts =
    "[[contacts]]\nid = 1\nposition_m = [1, 0, 0]\n[[contacts]]\nid = 2\nposition_m = [1, 1, 0]\n";

std::string row(int contact, const std::string& more = "") {
  return "[[waypoints]]\nposition_m = [1, 1, 1]\ncontact = " + std::to_string(contact) + "\n" +
         more + "\n";
}

InputProblem problemIn(const std::string& text) {
  const InputProblem problem = problemOf([&] { (void)parseMission(text, "m.toml"); }, text);
  EXPECT_EQ(problem.file, "m.toml");
  return problem;
}

TEST(MissionFile, ReadsEverything) {
  const Mission mission = parseMission(
      "version = 1\nname = 'all'\ndescription = 'd'\nframe = 'W'\nreel_position_m = [1, 0.3, "
      "2]\nmap = 'a.bt'\n"
      "map_hash = '00ff'\n"
      "contacts = [{id = 7, position_m = [0.5, 0.75, 1]}]\n"
      "waypoints = [\n"
      "  {position_m = [0, 1, 2], contact = 0},\n"
      "  {position_m = [1, 1, 2], contact = 7, look_at_m = [3, 0, 0], speed_mps = 0.25, hold_s = "
      "2, risk = 0.125}]\n",
      "all.toml");
  EXPECT_EQ(mission.name, "all");
  EXPECT_EQ(mission.description, "d");
  EXPECT_EQ(mission.reel_position, Eigen::Vector3d(1, 0.3, 2));
  EXPECT_EQ(mission.map, "a.bt");
  EXPECT_EQ(mission.map_hash, "00ff");
  const MissionPlan& plan = *mission.plan;
  ASSERT_EQ(plan.contact_count, 1);
  EXPECT_EQ(plan.contacts[0].id, 7);
  EXPECT_EQ(plan.contacts[0].p_WC, Eigen::Vector3d(0.5, 0.75, 1));
  ASSERT_EQ(plan.waypoint_count, 2);
  EXPECT_EQ(plan.waypoints[0].contact, 0);
  EXPECT_FALSE(plan.waypoints[0].p_WL.has_value());
  EXPECT_EQ(plan.waypoints[0].speed, 0.0);
  const Waypoint& last = plan.waypoints[1];
  EXPECT_EQ(last.p_WD, Eigen::Vector3d(1, 1, 2));
  EXPECT_EQ(last.contact, 7);
  ASSERT_TRUE(last.p_WL.has_value());
  EXPECT_EQ(*last.p_WL, Eigen::Vector3d(3, 0, 0));
  EXPECT_EQ(last.speed, 0.25);
  EXPECT_EQ(last.hold, 2.0);
  EXPECT_EQ(last.risk, 0.125);
}

TEST(MissionFile, EveryErrorNamesItsRowAndLine) {
  struct Case {
    std::string text;
    std::string key;
    int line;
  };
  const std::string good = row(0);  // three lines and a blank one
  for (const Case& c : {
           Case{"version = 2\nname = 'x'\nframe = 'W'\n" + good, "version", 1},
           Case{"name = 'x'\nframe = 'W'\n" + good, "version", 0},
           Case{"version = 1\nname = ''\nframe = 'W'\n" + good, "name", 2},
           Case{"version = 1\nname = 'x'\nframe = 'M'\n" + good, "frame", 3},
           Case{"version = 1\nname = 'x'\n" + good, "frame", 0},
           Case{kHead + "reel_position_m = [0, nan, 0]\n" + good, "reel_position_m", 4},
           Case{kHead, "waypoints", 0},
           Case{kHead + "waypoints = []\n", "waypoints", 4},
           Case{kHead + good + "[[waypoints]]\nposition_m = [1, inf, 1]\ncontact = 0\n",
                "waypoints[1].position_m", 9},
           Case{kHead + good + "[[waypoints]]\ncontact = 0\n", "waypoints[1].position_m", 8},
           Case{kHead + good + "[[waypoints]]\nposition_m = [1, 1, 1]\n", "waypoints[1].contact",
                8},
           Case{kHead + good + row(3), "waypoints[1].contact", 10},
           Case{kHead + good + row(-1), "waypoints[1].contact", 10},
           Case{kHead + good + row(0, "speed_mps = 5.01"), "waypoints[1].speed_mps", 11},
           Case{kHead + good + row(0, "speed_mps = -0.1"), "waypoints[1].speed_mps", 11},
           Case{kHead + good + row(0, "hold_s = -1"), "waypoints[1].hold_s", 11},
           Case{kHead + good + row(0, "risk = 1.01"), "waypoints[1].risk", 11},
           Case{kHead + good + row(0, "look_at_m = [0, 0]"), "waypoints[1].look_at_m", 11},
           Case{kHead + good + row(0, "sped_mps = 1"), "waypoints[1].sped_mps", 11},
           Case{kHead + good + "[[contacts]]\nid = 0\nposition_m = [1, 1, 0]\n", "contacts[0].id",
                9},
           Case{kHead + good + kContacts + "[[contacts]]\nid = 2\nposition_m = [1, 2, 0]\n",
                "contacts[2].id", 15},
       }) {
    const InputProblem problem = problemIn(c.text);
    EXPECT_EQ(problem.key, c.key) << c.text;
    EXPECT_EQ(problem.line, c.line) << c.text;
  }
}

TEST(MissionFile, UnknownContactListsTheKnownOnes) {
  EXPECT_EQ(problemIn(kHead + kContacts + row(5)).allowed, "0 (reel), 1, 2");
}

TEST(MissionFile, ContactAtTheAnchorBelowItIsImpossible) {
  const std::string twin = "[[contacts]]\nid = 3\nposition_m = [1, 0, 0.0005]\n";
  EXPECT_EQ(problemIn(kHead + kContacts + twin + row(0) + row(1) + row(3)).key,
            "waypoints[2].contact");
  const std::string at_reel = "[[contacts]]\nid = 3\nposition_m = [0, 0, 0]\n";
  EXPECT_EQ(problemIn(kHead + at_reel + row(3)).key, "waypoints[0].contact");
  EXPECT_NO_THROW(
      (void)parseMission(kHead + kContacts + twin + row(0) + row(1) + row(2) + row(3), "m"));
}

TEST(MissionFile, TooManyRowsAreRefused) {
  std::string many = kHead;
  for (int i = 0; i < kMaxWaypoints; ++i) many += row(0);
  EXPECT_EQ(parseMission(many, "m").plan->waypoint_count, kMaxWaypoints);
  EXPECT_THAT(problemIn(many + row(0)).problem, HasSubstr("2049"));
}

TEST(MissionFile, ContactStackPushesPopsAndPushesAgain) {
  std::string text = kHead + kContacts;
  for (const int contact : {0, 1, 1, 2, 1, 2, 0, 2, 1}) text += row(contact);
  const Mission mission = parseMission(text, "m");
  EXPECT_THAT(
      contactStacks(*mission.plan),
      ElementsAre(IsEmpty(), ElementsAre(1), ElementsAre(1), ElementsAre(1, 2), ElementsAre(1),
                  ElementsAre(1, 2), IsEmpty(), ElementsAre(2), ElementsAre(2, 1)));
  EXPECT_DOUBLE_EQ(staticLength(*mission.plan, {}), 0.0);
  EXPECT_DOUBLE_EQ(staticLength(*mission.plan, {1, 2}), 2.0);
}

TEST(MissionFile, CanonicalTextIsAFixedPointAndTheHashFollowsTheContent) {
  const std::string text = kHead + "# a comment\n" + kContacts +
                           row(0, "look_at_m = [0.1, 0.2, 0.30000000000000004]") +
                           row(1, "speed_mps = 0.1");
  const Mission mission = parseMission(text, "m");
  const std::string canonical = canonicalText(mission);
  const Mission again = parseMission(canonical, "again");
  EXPECT_EQ(canonicalText(again), canonical);
  EXPECT_EQ(again.plan->hash, mission.plan->hash);
  EXPECT_EQ(again.plan->waypoints[0].p_WL->z(), 0.30000000000000004);
  EXPECT_THAT(canonical,
              HasSubstr("  { position_m = [1.0, 1.0, 1.0], contact = 1, speed_mps = 0.1 },\n"));
  EXPECT_EQ(parseMission("# layout\n\n" + text, "m").plan->hash, mission.plan->hash);
  EXPECT_NE(parseMission(text + row(1), "m").plan->hash, mission.plan->hash);
}

TEST(MissionFile, Fnv1aMatchesThePublishedVectors) {
  EXPECT_EQ(fnv1a(""), 0xcbf29ce484222325U);
  EXPECT_EQ(fnv1a("a"), 0xaf63dc4c8601ec8cU);
  EXPECT_EQ(fnv1a("foobar"), 0x85944171f73967e8U);
  EXPECT_EQ(hashText(0xabcU), "0000000000000abc");
}

TEST(MissionFile, WriteAndReadBack) {
  const std::filesystem::path path =
      std::filesystem::path(::testing::TempDir()) / "tautline_written.mission.toml";
  Mission mission = parseMission(kHead + kContacts + row(0) + row(1), "m");
  mission.plan->hash = 0;
  writeMission(mission, path);
  const Mission back = readMission(path);
  EXPECT_EQ(back.plan->hash, mission.plan->hash);
  EXPECT_EQ(back.plan->hash, missionHash(mission));
  EXPECT_EQ(readTextFile(path), canonicalText(mission));
}

TEST(MissionFile, WhatCannotBeReadIsNeverWritten) {
  const std::filesystem::path path =
      std::filesystem::path(::testing::TempDir()) / "tautline_refused.mission.toml";
  std::filesystem::remove(path);
  Mission mission = parseMission(kHead + row(0), "m");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  mission.plan->waypoints[0].p_WD.y() = nan;
  EXPECT_EQ(problemOf([&] { writeMission(mission, path); }).key, "waypoints[0].position_m");
  mission = parseMission(kHead + row(0), "m");
  mission.name = "\xff";  // no UTF-8
  EXPECT_THROW(writeMission(mission, path), InputError);
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(MissionFile, DamagedFilesAreReadOrRefusedNothingElse) {
  const std::string good =
      canonicalText(parseMission(kHead + kContacts + row(0) + row(1, "hold_s = 2"), "m"));
  std::mt19937 random(5);
  int accepted = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string text = good;
    for (int k = 0; k < 1 + i % 3; ++k) {
      const std::size_t where = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[where] = static_cast<char>(random() % 256);
          break;
        case 1:
          text.erase(where, random() % 20);
          break;
        default:
          text.insert(where, text.substr(random() % text.size(), random() % 20));
          break;
      }
    }
    try {
      const Mission mission = parseMission(text, "m");
      EXPECT_NO_THROW(validateMission(mission)) << text;
      ++accepted;
    } catch (const InputError& e) {
      EXPECT_EQ(e.problem().file, "m");
    }
  }
  EXPECT_GT(accepted, 30);  // changed digits and names
}

}  // namespace
}  // namespace tautline
