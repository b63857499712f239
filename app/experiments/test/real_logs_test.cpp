// Flight logs through driver, estimator, executor and supervisor: one made here, whose truth is
// known, and the published ones where they are.

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/experiments/published_flights.h"
#include "app/experiments/replayed_flight.h"

namespace tautline::experiments {
namespace {

namespace fs = std::filesystem;

const Eigen::Vector3d kReel = Eigen::Vector3d::Constant(0.0033);
const Eigen::Vector3d kContact(1.1, 1.0, 0.9);

/// One row as the machine wrote it.
struct Row {
  int second{0};
  Eigen::Vector3d target{Eigen::Vector3d::Zero()};
  double length{0.0};
  double elevation{0.0};
  double azimuth{0.0};
  Eigen::Vector3d anchor{kReel};

  [[nodiscard]] double staticLength() const { return (anchor - kReel).norm(); }
  [[nodiscard]] Eigen::Vector3d position() const {
    const double free = length - staticLength();
    return anchor + free * Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                           std::sin(elevation),
                                           -std::cos(elevation) * std::sin(azimuth));
  }
  [[nodiscard]] std::string text() const {
    const Eigen::Vector3d way = target - anchor;
    const Eigen::Vector3d p = position();
    std::array<char, 512> line{};
    std::snprintf(
        line.data(), line.size(),
        "201802051740%02d %.6g %.6g %.6g %.6g %.6g %.6g %.6g %.6g %.6g %.6g %.6g %.6g %.6g "
        "%.6g %.6g 6.9e-310 1e+231 0 0.4 %.6g %d \n",
        second, target.x(), target.y(), target.z(), p.x(), p.y(), p.z(),
        staticLength() + way.norm(), std::asin(way.y() / way.norm()), std::atan2(-way.z(), way.x()),
        length, elevation, azimuth, anchor.x(), anchor.y(), anchor.z(), (target - p).norm(),
        (target - p).norm() < 0.4 ? 1 : 0);
    return line.data();
  }
};

constexpr int kWaypoints = 150;
constexpr int kNoContact = kWaypoints;

/// The published client on a line of waypoints, those from `first_round_contact` on round a
/// contact: one sample a second of a drone that goes 2.5 waypoints meanwhile, and the next waypoint
/// in the next row whenever one is within 0.4 m.
std::vector<Row> madeFlight(double metres_per_count, int first_round_contact = 100) {
  const auto waypoint = [](double i) {
    return Eigen::Vector3d(0.6 + 0.012 * i, 0.9 + 0.005 * i, 0.5 + 0.009 * i);
  };
  const auto anchor = [&](int i) { return i < first_round_contact ? kReel : kContact; };
  std::vector<Row> rows;
  int target = 0;
  for (int second = 0; second < 59; ++second) {
    Row row;
    row.second = second;
    row.target = waypoint(target);
    row.anchor = anchor(target);
    const Eigen::Vector3d p = waypoint(std::min(2.5 * second, 1.0 * kWaypoints));
    const Eigen::Vector3d free = p - row.anchor;
    row.length =
        metres_per_count * std::round((row.staticLength() + free.norm()) / metres_per_count);
    row.elevation = std::round(100.0 * std::asin(free.y() / free.norm())) / 100.0;
    row.azimuth = std::round(100.0 * std::atan2(-free.z(), free.x())) / 100.0;
    rows.push_back(row);
    while (target + 1 < kWaypoints && (row.target - row.position()).norm() < 0.4) {
      ++target;
      row.target = waypoint(target);
      row.anchor = anchor(target);
      rows.push_back(row);
    }
  }
  return rows;
}

Recording recorded(const std::vector<Row>& rows) {
  const fs::path file = fs::path(::testing::TempDir()) / "tautline_made_flight.txt";
  std::ofstream out(file);
  for (const Row& row : rows) out << row.text();
  out << "20180205174100 1 2";  // cut
  out.close();
  return readRecording(file);
}

TEST(ReplayedFlight, AgreesWithALogOfTheSameClient) {
  const Recording recording = recorded(madeFlight(0.00406));
  EXPECT_EQ(recording.skipped, 1);
  const LogAgreement same = agreement(recording, StationConfig{}, true);
  EXPECT_GT(same.rows, 150);
  EXPECT_EQ(same.targets, same.rows);
  EXPECT_EQ(same.position_off, 0);
  EXPECT_LT(same.position, 2e-5);
  EXPECT_EQ(same.other_target, 0);
  EXPECT_LT(same.target_length, 2e-5);
  EXPECT_LT(same.target_elevation, 2e-5);
  EXPECT_LT(same.target_azimuth, 2e-5);
  ASSERT_EQ(contactsOf(recording).size(), 1U);
  EXPECT_TRUE(contactsOf(recording)[0].isApprox(kContact));
}

TEST(ReplayedFlight, SeesWhereALogDoesNotFollow) {
  std::vector<Row> rows = madeFlight(0.00406);
  const auto off = [&](const std::function<void(Row&)>& change) {
    std::vector<Row> changed = rows;
    for (std::size_t i = 60; i < changed.size(); ++i) change(changed[i]);
    return agreement(recorded(changed), StationConfig{}, true);
  };
  // A machine of another scale: its lengths are no whole counts of ours.
  EXPECT_GT(agreement(recorded(madeFlight(0.003)), StationConfig{}, true).position, 1e-3);
  // A waypoint that the executor would not have gone on to yet.
  EXPECT_GT(off([](Row& row) { row.target.y() += 0.5; }).other_target, 0);
  // A client with other axes.
  EXPECT_GT(off([](Row& row) { row.azimuth = -row.azimuth; }).other_target, 0);
}

TEST(ReplayedFlight, FindsTheLengthOfACount) {
  for (const double count : {0.00406, 0.00285}) {
    const LogFigures figures = figuresOf(recorded(madeFlight(count)));
    ASSERT_TRUE(figures.quantum.has_value());
    EXPECT_NEAR(*figures.quantum, count, 1e-6);
    EXPECT_GT(figures.new_samples, 0.5);
    EXPECT_LT(figures.new_samples, 2.5);
  }
}

TEST(ReplayedFlight, TheSupervisorSeesSensorsThatGoSilent) {
  StationConfig station;
  station.run_mode = RunMode::kSim;
  std::vector<Row> rows = madeFlight(0.00406, kNoContact);
  const SupervisorVerdict good = verdictOn(recorded(rows), station);
  EXPECT_EQ(good.last_mode, Mode::kAuto);
  EXPECT_FALSE(good.intervened.has_value());
  EXPECT_GT(good.usable, 0.95);
  // The same flight with a pause of 20 s in it.
  const int pause_after = rows[rows.size() / 2].second;
  for (Row& row : rows)
    if (row.second > pause_after) row.second += 20;
  std::erase_if(rows, [](const Row& row) { return row.second > 59; });
  ASSERT_GT(rows.back().second, pause_after + 20);
  const SupervisorVerdict silent = verdictOn(recorded(rows), station);
  ASSERT_TRUE(silent.intervened.has_value());
  EXPECT_GT(*silent.intervened, pause_after);
  EXPECT_LT(*silent.intervened, pause_after + 10);
  EXPECT_TRUE(silent.reasons.any({Condition::kVehicleStale, Condition::kReelStale,
                                  Condition::kAnglesStale, Condition::kLocalizationLost}))
      << describe(silent.reasons);
}

TEST(PublishedFlights, FlightsWithContactsAreReproduced) {
  const std::optional<fs::path> archive = publishedLogs();
  if (!archive)
    GTEST_SKIP() << "REAL DATA MISSING: no flight logs (set TAUTLINE_DATA to the published data)";
  const fs::path folder = fs::path(::testing::TempDir()) / "tautline_experiments_logs";
  const std::vector<fs::path> logs = unpackLogs(*archive, folder);
  EXPECT_EQ(logs.size(), 57U);
  int with_contacts = 0;
  for (const fs::path& log : logs) {
    if (log.stem().string() < "20180205174014") continue;  // none before it has contact columns
    const Recording recording = readRecording(log);
    if (contactsOf(recording).empty()) continue;
    ++with_contacts;
    const LogAgreement same = agreement(recording, StationConfig{}, true);
    EXPECT_GT(same.rows, 600) << log;
    EXPECT_LT(same.position, 2e-3) << log;
    EXPECT_EQ(same.other_target, 0) << log;
    EXPECT_LE(same.target_length, 2e-5) << log;
    EXPECT_LE(same.target_elevation, 2e-5) << log;
    EXPECT_LE(same.target_azimuth, 2e-5) << log;
    const LogFigures figures = figuresOf(recording);
    ASSERT_TRUE(figures.quantum.has_value()) << log;
    EXPECT_NEAR(*figures.quantum, kLoggedMetresPerCount, 5e-6) << log;
  }
  EXPECT_EQ(with_contacts, 5);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace tautline::experiments
