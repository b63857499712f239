/// @file
/// The dissertation's contact planner beside the taut string on the flights round the shaft of
/// chapter 6: our own paths, and where they are the authors' path file and flight logs
/// (docs/contact_comparison.md).

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "common/mission/legacy_import.h"
#include "common/mission/test/flight_log.h"
#include "planning_offline/examples/test/shipped_path.h"
#include "planning_offline/field/line_of_sight.h"
#include "planning_offline/field/obstacles.h"
#include "planning_offline/map/load_map.h"
#include "planning_offline/map/test/map_files.h"
#include "planning_offline/tether/compare_contacts.h"

namespace tautline::planning {
namespace {

using Points = std::vector<Eigen::Vector3d>;

constexpr double kVoxel = 0.33;       // [m]
constexpr double kStandoff = 0.1;     // of the published contacts from both faces [voxels]
constexpr double kHeightBand = 0.06;  // published against exact contact [voxels]

VoxelMap shaft() {
  return loadMap(std::string(TAUTLINE_SOURCE_DIR) + "/config/scenes/dissertation/shaft.scene.toml",
                 {});
}

/// A point that the dissertation prints in its planner's voxels, in M [m].
Eigen::Vector3d printed(double first, double second, double third) {
  return kVoxel * Eigen::Vector3d(second, third, first);
}

ContactComparison compare(const VoxelMap& map, const Points& path) {
  return compareContacts(map, map.reel.value(), path);
}

/// Index of the first row with this many contacts in a column, from a row on.
template <class Contacts>
std::size_t firstWith(const ContactComparison& comparison, std::size_t count, Contacts contacts,
                      std::size_t from = 0) {
  const auto& rows = comparison.rows;
  const auto row = std::find_if(rows.begin() + static_cast<std::ptrdiff_t>(from), rows.end(),
                                [&](const ContactRow& r) { return contacts(r).size() == count; });
  return static_cast<std::size_t>(row - rows.begin());
}
const Points& published(const ContactRow& row) { return row.published.contacts; }
const Points& exact(const ContactRow& row) { return row.exact.contacts; }

/// Both contacts are at the same corner of the shaft, the published one pushed out by its standoff.
void expectSameCorner(const Eigen::Vector3d& published, const Eigen::Vector3d& exact) {
  const Eigen::Vector3d apart = (published - exact) / kVoxel;
  EXPECT_NEAR(std::abs(apart.x()), kStandoff, 1e-9);
  EXPECT_NEAR(std::abs(apart.z()), kStandoff, 1e-9);
  EXPECT_LE(std::abs(apart.y()), kHeightBand);
}

TEST(ShaftContacts, OneContactIsFormedAndRelaxedByBoth) {
  const VoxelMap map = shaft();
  const ContactComparison both =
      compare(map, shippedPath("scenes/dissertation/shaft_one_contact.path.txt"));
  ASSERT_EQ(both.rows.size(), 82U);
  EXPECT_EQ(both.unresolved_moves, 0);
  EXPECT_EQ(firstWith(both, 1, published), 42U);
  EXPECT_EQ(firstWith(both, 1, exact), 42U);
  EXPECT_EQ(firstWith(both, 0, published, 42), 54U);
  EXPECT_EQ(firstWith(both, 0, exact, 42), 54U);
  EXPECT_EQ(countRefused(both), 0);
  EXPECT_EQ(countPierced(both), 0);
  for (const ContactRow& row : both.rows) {
    ASSERT_EQ(row.published.contacts.size(), row.exact.contacts.size());
    if (!row.exact.contacts.empty())
      expectSameCorner(row.published.contacts[0], row.exact.contacts[0]);
    EXPECT_GE(row.published.length, row.exact.length - 1e-9);
  }
  EXPECT_NEAR(largestDifference(both), 0.007, 5e-4);
  EXPECT_NEAR(both.rows.back().exact.length, 3.6630, 1e-4);
  EXPECT_TRUE(both.rows[42].exact.contacts[0].isApprox(printed(4.0, 5.0, 3.3098), 1e-4));
  EXPECT_TRUE(both.rows[42].published.contacts[0].isApprox(printed(3.9, 5.1, 3.3155), 1e-4));
}

TEST(ShaftContacts, TwoContactsAreKeptByBothInSightOfTheReel) {
  const VoxelMap map = shaft();
  const ContactComparison both =
      compare(map, shippedPath("scenes/dissertation/shaft_two_contacts.path.txt"));
  ASSERT_EQ(both.rows.size(), 69U);
  EXPECT_EQ(both.unresolved_moves, 0);
  EXPECT_EQ(firstWith(both, 1, published), 34U);
  EXPECT_EQ(firstWith(both, 1, exact), 34U);
  EXPECT_EQ(firstWith(both, 2, published), 53U);
  EXPECT_EQ(firstWith(both, 2, exact), 52U);
  EXPECT_EQ(countRefused(both), 10);  // between the contacts, with a free line to the reel
  EXPECT_EQ(countPierced(both), 0);
  const ContactRow& end = both.rows.back();
  ASSERT_EQ(end.published.contacts.size(), 2U);
  ASSERT_EQ(end.exact.contacts.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i)
    expectSameCorner(end.published.contacts[i], end.exact.contacts[i]);
  const auto cells = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    return (p - map.origin) / map.resolution;
  };
  EXPECT_TRUE(lineOfSight(map.shape, obstacleCells(map, false), cells(*map.reel),
                          cells(end.exact.position)));
  EXPECT_GT(end.exact.length, (end.exact.position - *map.reel).norm() + 1.0);
  EXPECT_FALSE(end.published.relaxation_refused);  // the line from the first contact is blocked
  EXPECT_NEAR(end.published.length, 5.2984, 1e-4);
  EXPECT_NEAR(end.exact.length, 5.2359, 1e-4);
  EXPECT_NEAR(largestDifference(both), 0.063, 5e-4);
  EXPECT_TRUE(end.published.contacts[0].isApprox(printed(3.9, 5.1, 3.4034), 1e-4));
  EXPECT_TRUE(end.published.contacts[1].isApprox(printed(5.1, 5.1, 4.1228), 1e-4));
  EXPECT_TRUE(end.exact.contacts[0].isApprox(printed(4.0, 5.0, 3.4416), 1e-4));
  EXPECT_TRUE(end.exact.contacts[1].isApprox(printed(5.0, 5.0, 4.1096), 1e-4));
}

// ---- the authors' data ------------------------------------------------------------------------

/// A plan as its authors' planner made it: waypoints and the active anchor at each, M [m].
struct FlownPlan {
  Points waypoints;
  Points anchors;
};

/// Relaxation.txt; nothing where the data are missing.
std::optional<FlownPlan> relaxationFile() {
  const std::filesystem::path file = realData() / "fotokite_waypoints" / "Relaxation.txt";
  if (!std::filesystem::exists(file)) return std::nullopt;
  const Mission mission = importLegacyMission(file);
  FlownPlan plan;
  for (int i = 0; i < mission.plan->waypoint_count; ++i) {
    const Waypoint& waypoint = mission.plan->waypoints[static_cast<std::size_t>(i)];
    const MissionContact* contact = mission.plan->findContact(waypoint.contact);
    plan.waypoints.push_back(waypoint.p_WD);
    plan.anchors.push_back(contact != nullptr ? contact->p_WC : printed(0.01, 0.01, 0.01));
  }
  return plan;
}

/// Targets of a logged flight, each once, in the order flown; nothing where the data are missing.
std::optional<FlownPlan> flight(const std::string& name) {
  std::istringstream log(
      flightLog(realData() / "fotokite_flight_logs" / "2018-01_02.tar.xz", name + ".txt"));
  FlownPlan plan;
  for (std::string line; std::getline(log, line);) {
    std::istringstream words(line);
    std::vector<std::string> column;
    for (std::string word; words >> word;) column.push_back(word);
    if (column.size() != 22) continue;
    const auto point = [&](std::size_t at) {
      return Eigen::Vector3d(std::stod(column[at]), std::stod(column[at + 1]),
                             std::stod(column[at + 2]));
    };
    const Eigen::Vector3d target = point(1);
    if (!plan.waypoints.empty() && target == plan.waypoints.back()) continue;
    plan.waypoints.push_back(target);
    plan.anchors.push_back(point(13));
  }
  if (plan.waypoints.empty()) return std::nullopt;
  return plan;
}

#define SKIP_WITHOUT(plan) \
  if (!(plan))             \
  GTEST_SKIP() << "REAL DATA MISSING: nothing in " << realData() << " (set TAUTLINE_DATA)"

/// `state` has contacts: as published, or with the rest of the tether.
template <class State>
Eigen::Vector3d publishedAnchor(const VoxelMap& map, const State& state) {
  return state.contacts.empty() ? map.reel.value() : state.contacts.back();
}

/// Waypoints whose anchor is not the one that the authors' planner gave them.
std::vector<std::size_t> otherAnchors(const VoxelMap& map, const FlownPlan& plan, double tolerance,
                                      const PublishedOptions& options = {}) {
  const auto states = publishedContacts(map, map.reel.value(), plan.waypoints, options);
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if ((publishedAnchor(map, states[i]) - plan.anchors[i]).norm() > tolerance) others.push_back(i);
  }
  return others;
}

constexpr double kFileDigits = 5e-5 * kVoxel;  // [m]: four decimals of a voxel, and rounding
constexpr double kLogDigits = 1e-5;            // [m]: six digits

TEST(ShaftContacts, EveryAnchorOfTheAuthorsPathFileIsReproduced) {
  const std::optional<FlownPlan> plan = relaxationFile();
  SKIP_WITHOUT(plan);
  const VoxelMap map = shaft();
  ASSERT_EQ(plan->waypoints.size(), 701U);
  EXPECT_TRUE(otherAnchors(map, *plan, kFileDigits).empty());
  const ContactComparison both = compare(map, plan->waypoints);
  EXPECT_EQ(both.unresolved_moves, 0);
  EXPECT_EQ(firstWith(both, 1, published), 373U);
  EXPECT_EQ(firstWith(both, 0, published, 373), 518U);
  EXPECT_EQ(firstWith(both, 1, exact), 372U);  // the samples miss the corner by one waypoint
  EXPECT_EQ(firstWith(both, 0, exact, 372), 518U);
  EXPECT_TRUE(both.rows[372].published.pierces);
  EXPECT_EQ(countPierced(both), 1);
  EXPECT_TRUE(both.rows[517].published.relaxation_refused);
  EXPECT_EQ(countRefused(both), 1);
  for (std::size_t i = 373; i < 518; ++i) {
    expectSameCorner(both.rows[i].published.contacts.at(0), both.rows[i].exact.contacts.at(0));
  }
  EXPECT_NEAR(largestDifference(both), 0.008, 5e-4);
  // The difference is that the published contact stands off.
  const ContactComparison ideal =
      compareContacts(map, map.reel.value(), plan->waypoints, {.standoff = 0.0});
  EXPECT_NEAR(largestDifference(ideal), 0.0014, 5e-5);
  EXPECT_TRUE(
      both.rows[373].published.contacts[0].isApprox(printed(3.9, 5.1, 3.1833), kFileDigits));
  EXPECT_TRUE(both.rows[373].exact.contacts[0].isApprox(printed(4.0, 5.0, 3.2168), kFileDigits));
}

TEST(ShaftContacts, TheAuthorsPathFileRulesTheOtherReadingsOut) {
  const std::optional<FlownPlan> plan = relaxationFile();
  SKIP_WITHOUT(plan);
  const VoxelMap map = shaft();
  const auto others = [&](const PublishedOptions& options) {
    return otherAnchors(map, *plan, kFileDigits, options);
  };
  using Rows = std::vector<std::size_t>;
  EXPECT_EQ(others({.confinement = Confinement::kCentreInside}), (Rows{517}));
  EXPECT_EQ(others({.attachment = Attachment::kFollowingWaypoint}), (Rows{373, 518}));
  // With another step or place of the contact it is all of its 145 waypoints.
  EXPECT_GE(others({.sample_step = 0.05}).size(), 145U);
  EXPECT_GE(others({.standoff = 0.0}).size(), 145U);
  EXPECT_GE(others({.placement = ContactPlacement::kCorner}).size(), 145U);
  EXPECT_GE(others({.placement = ContactPlacement::kEntry}).size(), 145U);
}

/// A flight that the dissertation prints nothing of: what was found on Relaxation.txt predicts it.
TEST(ShaftContacts, EveryAnchorOfAnUnpublishedFlightIsPredicted) {
  const std::optional<FlownPlan> plan = flight("20180205181102");
  SKIP_WITHOUT(plan);
  const VoxelMap map = shaft();
  ASSERT_EQ(plan->waypoints.size(), 500U);
  EXPECT_TRUE(otherAnchors(map, *plan, kLogDigits).empty());
  const ContactComparison both = compare(map, plan->waypoints);
  EXPECT_EQ(firstWith(both, 1, published), 255U);
  EXPECT_EQ(firstWith(both, 0, published, 255), 274U);
  EXPECT_EQ(firstWith(both, 1, exact), 254U);
  EXPECT_EQ(firstWith(both, 0, exact, 254), 274U);
  EXPECT_EQ(countRefused(both), 1);
  EXPECT_EQ(countPierced(both), 1);
  EXPECT_NEAR(largestDifference(both), 0.007, 5e-4);
  EXPECT_TRUE(both.rows[255].published.contacts.at(0).isApprox(printed(3.9, 5.1, 3.7952), 1e-5));
  EXPECT_TRUE(both.rows[255].exact.contacts.at(0).isApprox(printed(4.0, 5.0, 3.8495), 1e-4));
  for (std::size_t i = 255; i < 274; ++i) {
    expectSameCorner(both.rows[i].published.contacts.at(0), both.rows[i].exact.contacts.at(0));
  }
}

TEST(ShaftContacts, TheTwoPublishedContactsOfTheLoggedFlight) {
  const std::optional<FlownPlan> plan = flight("20180205174014");
  SKIP_WITHOUT(plan);
  const VoxelMap map = shaft();
  ASSERT_EQ(plan->waypoints.size(), 454U);  // of 761 planned: the vehicle passed some by
  const ContactComparison both = compare(map, plan->waypoints);
  const ContactRow& end = both.rows.back();
  ASSERT_EQ(end.published.contacts.size(), 2U);
  ASSERT_EQ(end.exact.contacts.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i)
    expectSameCorner(end.published.contacts[i], end.exact.contacts[i]);
  EXPECT_NEAR(largestDifference(both), 0.062, 5e-4);
  EXPECT_NEAR(end.published.length, 5.3138, 1e-4);
  EXPECT_NEAR(end.exact.length, 5.2515, 1e-4);
  EXPECT_TRUE(end.exact.contacts[0].isApprox(printed(4.0, 5.0, 3.4315), 1e-4));
  EXPECT_TRUE(end.exact.contacts[1].isApprox(printed(5.0, 5.0, 4.0790), 1e-4));
  EXPECT_EQ(countPierced(both), 0);
  EXPECT_EQ(countRefused(both), 77);
  EXPECT_FALSE(end.published.relaxation_refused);
  EXPECT_EQ(firstWith(both, 2, exact), 316U);
  // The anchor changes at the logged targets, to the published corners.
  const Points contacts{printed(3.9, 5.1, 3.3737), printed(5.1, 5.1, 4.0772)};
  for (std::size_t i = 0; i < both.rows.size(); ++i) {
    const Eigen::Vector3d anchor = publishedAnchor(map, both.rows[i].published);
    EXPECT_NEAR(anchor.x(), plan->anchors[i].x(), kLogDigits) << i;
    EXPECT_NEAR(anchor.z(), plan->anchors[i].z(), kLogDigits) << i;
    // The waypoint that formed the first contact is among those passed by.
    EXPECT_NEAR(anchor.y(), plan->anchors[i].y(), 0.03 * kVoxel) << i;
  }
  // On the first contact as published, the second comes out to its last digit.
  const std::size_t first = firstWith(both, 1, published);
  const auto after = publishedContacts(map, contacts[0], std::span(plan->waypoints).subspan(first),
                                       PublishedOptions{});
  ASSERT_EQ(after.back().contacts.size(), 1U);
  EXPECT_LE((after.back().contacts[0] - contacts[1]).norm(), kFileDigits);
  EXPECT_EQ(firstWith(both, 2, published), 331U);
  EXPECT_TRUE(after[331 - first - 1].contacts.empty());
  EXPECT_EQ(after[331 - first].contacts.size(), 1U);
}

}  // namespace
}  // namespace tautline::planning
