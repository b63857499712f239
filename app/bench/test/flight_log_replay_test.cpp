// Text logs through the estimator: one made here, and the published flights where they are.

#include "app/bench/flight_log_replay.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>

#include <gtest/gtest.h>

#include "common/tether_geometry.h"

namespace tautline::bench {
namespace {

namespace fs = std::filesystem;

/// A minute of a drone that goes round the reel at 2 m, one sample a second rounded as the machine
/// rounds, ten rows a second.
fs::path roundTheReel() {
  const fs::path path = fs::path(::testing::TempDir()) / "tautline_round.txt";
  std::ofstream out(path);
  for (int i = 0; i < 600; ++i) {
    const int second = i / 10;
    const double azimuth = std::round(100.0 * (-0.8 + 0.02 * second)) / 100.0;
    const double elevation = 0.9;
    const double length = std::round(2.0 / 0.00406) * 0.00406;
    const double x = length * std::cos(elevation) * std::cos(azimuth);
    const double z = -length * std::cos(elevation) * std::sin(azimuth);
    out << "201802051740" << (second < 10 ? "0" : "") << second << " 0 0 0 " << x << " "
        << length * std::sin(elevation) << " " << z << " 0 0 0 " << length << " " << elevation
        << " " << azimuth << " 0.0033 0.0033 0.0033 6.9e-310 1e+231 0 0.4 0.1 0 \n";
  }
  return path;
}

TEST(FlightLogReplay, FollowsALogOfItsOwn) {
  int seconds = 0;
  Playback playback;
  playback.each_second = [&seconds](Duration, const Estimate&) { ++seconds; };
  const FlightLogReplay r =
      replayFlightLog(readRecording(roundTheReel()), LocalizerConfig{}, playback);
  EXPECT_EQ(r.rows, 600);
  EXPECT_EQ(r.rows_skipped, 0);
  EXPECT_NEAR(r.duration_s, 59.9, 1e-6);
  EXPECT_EQ(seconds, 60);
  EXPECT_EQ(r.reel_samples, 60U);
  EXPECT_EQ(r.angle_samples, 60U);
  EXPECT_GT(r.usable, 0.95);
  // The log's own position knows no sag and no lag.
  EXPECT_LT(r.distance_mean_m, 0.25);
}

fs::path publishedLogs() {
  const char* const data = std::getenv("TAUTLINE_DATA");
  return fs::path(data != nullptr ? data : TAUTLINE_SOURCE_DIR "/../shared/data") /
         "fotokite_flight_logs" / "2018-01_02.tar.xz";
}

TEST(FlightLogReplay, TakesEveryPublishedFlight) {
  const fs::path archive = publishedLogs();
  if (!fs::exists(archive))
    GTEST_SKIP() << "SKIPPED: no " << archive
                 << "; set TAUTLINE_DATA to the folder of the published data";
  const fs::path folder = fs::path(::testing::TempDir()) / "tautline_published_logs";
  fs::create_directories(folder);
  const std::string unpack = "tar -xJf '" + archive.string() + "' -C '" + folder.string() + "'";
  ASSERT_EQ(std::system(unpack.c_str()), 0) << unpack;
  int flights = 0;
  std::int64_t rows = 0;
  std::int64_t contact_rows = 0;
  double distance = 0.0;
  double usable = 0.0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".txt") continue;
    Recording recording;
    try {
      recording = readRecording(entry.path());
    } catch (const std::exception& e) {
      std::cout << "no flight: " << e.what() << "\n";
      continue;
    }
    const FlightLogReplay r = replayFlightLog(std::move(recording), LocalizerConfig{}, {});
    EXPECT_TRUE(std::isfinite(r.distance_mean_m)) << entry.path();
    ++flights;
    rows += r.rows;
    contact_rows += r.rows_with_contact;
    distance += r.distance_mean_m * static_cast<double>(r.rows);
    usable += r.usable * static_cast<double>(r.rows);
  }
  fs::remove_all(folder);
  ASSERT_GT(rows, 0);
  std::cout << flights << " flights, " << rows << " rows, " << contact_rows
            << " with a contact; usable " << 100.0 * usable / static_cast<double>(rows)
            << " %, mean distance " << distance / static_cast<double>(rows) << " m\n";
  EXPECT_GT(flights, 40);
  EXPECT_GT(contact_rows, 100);
  EXPECT_GT(usable / static_cast<double>(rows), 0.9);
  // No truth to hold it against: the log's own position takes lengths that read too long at face
  // value, and knows no sag. Nearer than a metre shows that axes, signs and contacts are right.
  EXPECT_LT(distance / static_cast<double>(rows), 1.0);
}

}  // namespace
}  // namespace tautline::bench
