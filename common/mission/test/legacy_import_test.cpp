#include "common/mission/legacy_import.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/mission/test/flight_log.h"
#include "common/mission/test/test_problem.h"

namespace tautline {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path kLegacy = TAUTLINE_SOURCE_DIR "/common/mission/test/legacy";

std::filesystem::path dataFolder() {
  const char* given = std::getenv("TAUTLINE_DATA");
  return given != nullptr ? given : TAUTLINE_SOURCE_DIR "/../shared/data";
}

InputProblem problemIn(const std::string& text) {
  return problemOf([&] { (void)parseLegacyMission(text, "path.txt"); }, text);
}

TEST(LegacyImport, SixNumbersAreVoxelsWithRotatedAxes) {
  const Mission mission = importLegacyMission(kLegacy / "six_numbers.txt");
  EXPECT_EQ(mission.name, "six_numbers");
  const MissionPlan& plan = *mission.plan;
  ASSERT_EQ(plan.waypoint_count, 6);
  EXPECT_TRUE(
      plan.waypoints[1].p_WD.isApprox(Eigen::Vector3d(2.5 * 0.33, 3.0 * 0.33, 1.5 * 0.33), 1e-15));
  ASSERT_EQ(plan.contact_count, 2);
  EXPECT_EQ(plan.contacts[0].id, 1);
  EXPECT_EQ(plan.contacts[1].id, 2);
  EXPECT_TRUE(plan.contacts[0].p_WC.isApprox(Eigen::Vector3d(5.1 * 0.33, 3.1833 * 0.33, 3.9 * 0.33),
                                             1e-15));
  std::array<int, 6> contacts{};
  for (std::size_t i = 0; i < 6; ++i) contacts[i] = plan.waypoints[i].contact;
  EXPECT_THAT(contacts, ::testing::ElementsAre(0, 0, 1, 2, 1, 0));
}

TEST(LegacyImport, NineNumbersAreMetresWithWindowsLineEndsAndNoLastNewline) {
  const Mission mission = importLegacyMission(kLegacy / "nine_numbers_crlf.txt",
                                              {.name = "mine", .scale = {}, .axes = {}});
  EXPECT_EQ(mission.name, "mine");
  const MissionPlan& plan = *mission.plan;
  ASSERT_EQ(plan.waypoint_count, 4);
  EXPECT_EQ(plan.waypoints[0].p_WD, Eigen::Vector3d(-1.5, 1, 1.5));
  EXPECT_FALSE(plan.waypoints[0].p_WL.has_value());
  EXPECT_EQ(*plan.waypoints[1].p_WL, Eigen::Vector3d(1, -0.1, 0));
  EXPECT_EQ(plan.waypoints[2].p_WD, Eigen::Vector3d(1.5, 1.9, -1.5));
  EXPECT_EQ(plan.waypoints[2].contact, 1);
  EXPECT_EQ(plan.waypoints[3].contact, 0);
  EXPECT_EQ(plan.contacts[0].p_WC, Eigen::Vector3d(0.5, 0.75, 0.25));
}

TEST(LegacyImport, ScaleAndAxesCanBeGiven) {
  const Mission mission = parseLegacyMission(
      "1 2 3 4 5 6", "f", {.name = {}, .scale = 2.0, .axes = parseLegacyAxes("-zxy")});
  EXPECT_EQ(mission.plan->waypoints[0].p_WD, Eigen::Vector3d(-6, 2, 4));
  EXPECT_EQ(mission.plan->contacts[0].p_WC, Eigen::Vector3d(-12, 8, 10));
}

TEST(LegacyImport, AxesAreAPermutation) {
  for (const char* bad : {"", "xy", "xyy", "xyzx", "xya", "--xyz", "xyz-", "XYZ", "x y z"}) {
    EXPECT_THROW((void)parseLegacyAxes(bad), InputError) << bad;
  }
}

TEST(LegacyImport, BadRowsNameTheirLine) {
  struct Case {
    const char* text;
    int line;
  };
  for (const Case& c :
       {Case{"1 1 1 0 0 0\n1 1 1 0 0\n", 2}, Case{"1 1 1 0 0 0 0\n", 1}, Case{"1 1 1\n", 1},
        Case{"1 1 1 0 0 0\n\n# 9 now\n1 1 1 0 0 0 0 0 0\n", 4}, Case{"1 1 nan 0 0 0\n", 1},
        Case{"1 1 1 0 0 0\n1 1 inf 0 0 0\n", 2}, Case{"1 1 1e999 0 0 0\n", 1},
        Case{"1 1 1 0 0 0\r\n1 1 1x 0 0 0\r\n", 2}, Case{"x y z a b c\n", 1},
        Case{"1 1 0x10 0 0 0\n", 1}, Case{"1 1 1 0 0 0\n2000 1e9 1 0 0 0\n", 2}, Case{"", 0},
        Case{"\n# nothing\n", 0}}) {
    const InputProblem problem = problemIn(c.text);
    EXPECT_EQ(problem.file, "path.txt");
    EXPECT_EQ(problem.line, c.line) << c.text;
  }
  EXPECT_THAT(problemIn("1 2 3 4\n").problem, HasSubstr("has 4 numbers"));
}

TEST(LegacyImport, TooManyRowsOrContactsAreRefused) {
  std::string rows;
  for (int i = 0; i <= kMaxWaypoints; ++i) rows += "1 1 1 0 0 0\n";
  EXPECT_EQ(problemIn(rows).line, kMaxWaypoints + 1);
  std::string contacts;
  for (int i = 0; i <= kMaxContacts; ++i) contacts += "1 1 1 " + std::to_string(i + 1) + " 2 3\n";
  EXPECT_EQ(problemIn(contacts).line, kMaxContacts + 1);
}

TEST(LegacyImport, RandomBytesNeverDoMoreThanThrow) {
  const std::string alphabet = "0123456789+-.eE \t\r\n#%xnaif\0\xff,";
  unsigned state = 1;
  for (int i = 0; i < 3000; ++i) {
    std::string text;
    for (int k = 0; k < 60; ++k) {
      state = state * 1664525U + 1013904223U;
      text += alphabet[(state >> 16) % alphabet.size()];
    }
    try {
      const Mission mission = parseLegacyMission(text, "f");
      EXPECT_NO_THROW(validateMission(mission));
    } catch (const InputError&) {
    }
  }
}

/// Expected rows of the files that were flown on the real vehicle.
TEST(LegacyImport, RealFilesImport) {
  const std::filesystem::path folder = dataFolder() / "fotokite_waypoints";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "REAL DATA MISSING: no " << folder << " (set TAUTLINE_DATA)";
  struct Case {
    const char* file;
    int waypoints;
    int contacts;
  };
  for (const Case& c :
       {Case{"Relaxation.txt", 701, 1}, Case{"ssrr_2019_path1_0.2.txt", 31, 0},
        Case{"ssrr_2019_path1_0.5.txt", 13, 0}, Case{"ssrr_2019_path1_1.5.txt", 5, 0},
        Case{"ssrr_2019_path1_1.txt", 7, 0}, Case{"ssrr_2019_path1_3.txt", 3, 0},
        Case{"ssrr_2019_path2_0.2.txt", 16, 0}, Case{"ssrr_2019_path2_0.5.txt", 7, 0},
        Case{"ssrr_2019_path2_1.5.txt", 3, 0}, Case{"ssrr_2019_path2_1.txt", 4, 0},
        Case{"ssrr_2019_path2_3.txt", 2, 0}, Case{"waypoints_iros_2019.txt", 12, 0}}) {
    const Mission mission = importLegacyMission(folder / c.file);
    EXPECT_EQ(mission.plan->waypoint_count, c.waypoints) << c.file;
    EXPECT_EQ(mission.plan->contact_count, c.contacts) << c.file;
    EXPECT_EQ(canonicalText(parseMission(canonicalText(mission), "again")), canonicalText(mission))
        << c.file;
  }
  EXPECT_EQ(*importLegacyMission(folder / "waypoints_iros_2019.txt").plan->waypoints[0].p_WL,
            Eigen::Vector3d(1, -0.1, 0));
}

/// As the flight logs print numbers.
std::string sixDigits(const Eigen::Vector3d& p) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "%g %g %g", p.x(), p.y(), p.z());
  return text.data();
}

/// The rule for six numbers (scale 0.33, axes yzx, no shift) against what the vehicle's own log
/// says: three flights of Relaxation.txt logged their targets in metres with six digits, and each
/// of them must be an imported waypoint; the two contacts of flight 20180205174014 are the
/// published voxel coordinates.
TEST(LegacyImport, SixNumberRuleReproducesTheFlightLogs) {
  const std::filesystem::path archive = dataFolder() / "fotokite_flight_logs" / "2018-01_02.tar.xz";
  const std::filesystem::path path = dataFolder() / "fotokite_waypoints" / "Relaxation.txt";
  if (!std::filesystem::exists(archive))
    GTEST_SKIP() << "REAL DATA MISSING: no " << archive << " (set TAUTLINE_DATA)";
  if (flightLog(archive, "20180208193507.txt").empty())
    GTEST_SKIP() << "cannot unpack " << archive << ": tar or xz missing";

  const Mission mission = importLegacyMission(path);
  std::set<std::string> targets;
  for (int i = 0; i < mission.plan->waypoint_count; ++i) {
    targets.insert(sixDigits(mission.plan->waypoints[static_cast<std::size_t>(i)].p_WD));
  }
  int rows = 0;
  for (const char* flight : {"20180208183733.txt", "20180208192547.txt", "20180208193507.txt"}) {
    std::istringstream log(flightLog(archive, flight));
    for (std::string line; std::getline(log, line); ++rows) {
      std::istringstream words(line);
      std::string stamp, x, y, z;
      words >> stamp >> x >> y >> z;
      EXPECT_TRUE(targets.contains(x + " " + y + " " + z)) << flight << ": " << line;
    }
  }
  EXPECT_EQ(rows, 715);

  const Mission contacts =
      parseLegacyMission("1 1 1 3.9 5.1 3.3737\n1 1 1 5.1 5.1 4.0772\n", "published");
  const std::string log = flightLog(archive, "20180205174014.txt");
  for (int i = 0; i < 2; ++i) {
    EXPECT_THAT(
        log, HasSubstr(" " + sixDigits(contacts.plan->contacts[static_cast<std::size_t>(i)].p_WC) +
                       " "));
  }
}

}  // namespace
}  // namespace tautline
