#include "app/report/flight_log.h"

#include <cstring>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>
#include <tautline/event_t.hpp>

#include "app/report/analysis.h"
#include "app/report/test/synthetic_flight.h"
#include "common/error.h"

namespace tautline::report {
namespace {

using ::testing::HasSubstr;

std::filesystem::path logFile(const std::string& name) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "tautline_report_test";
  std::filesystem::create_directories(folder);
  return folder / name;
}

TEST(FlightLogFile, EveryFigureOfAKnownFlight) {
  const auto file = logFile("known.lcm");
  writeSyntheticLog({}, file);
  const FlightLog log = readFlightLog(file);
  EXPECT_EQ(log.start_utime, 0);
  EXPECT_EQ(log.damage, "");
  EXPECT_EQ(log.programs.at("tautline-station"), "1.2.3");
  ASSERT_EQ(log.events.size(), 2U);
  EXPECT_EQ(log.events[1].severity, Severity::kWarning);
  EXPECT_NEAR(log.events[1].t, 14.0, 1e-9);
  EXPECT_EQ(log.events[1].reaction, "holding until the next one");

  const FlightAnalysis flight = analyze(log);
  EXPECT_EQ(flight.run_mode, RunMode::kSim);
  EXPECT_TRUE(flight.outcome.mission_completed);
  EXPECT_TRUE(flight.outcome.landed) << flight.outcome.text;
  EXPECT_EQ(flight.outcome.waypoints_reached, 4);
  EXPECT_TRUE(flight.notes.empty()) << flight.notes.front();
  ASSERT_TRUE(flight.plan && flight.plan->complete());
  ASSERT_EQ(flight.plan->waypoints.size(), 4U);
  EXPECT_TRUE(flight.plan->waypoints[3]->p_WD.isApprox(syntheticCorners()[4]));
  EXPECT_TRUE(flight.plan->contacts[0]->p_WC.isApprox(syntheticContact()));

  EXPECT_NEAR(flight.cross_track.all->mean, 0.05, 1e-9);
  EXPECT_NEAR(flight.cross_track.all->max, 0.05, 1e-9);
  ASSERT_EQ(flight.cross_track.segments.size(), 4U);
  EXPECT_NEAR(flight.cross_track.segments[0].time.begin, kSyntheticMissionStart, 0.11);
  EXPECT_NEAR(flight.localization.all->mean, 0.08, 1e-6);
  EXPECT_NEAR(flight.localization.true_reel_scale.value(), 1.02, 1e-12);
  double planned = 0.0;
  for (std::size_t i = 1; i < syntheticCorners().size(); ++i)
    planned += (syntheticCorners()[i] - syntheticCorners()[i - 1]).norm();
  EXPECT_NEAR(flight.smoothness.planned_length.value(), planned, 1e-9);
  EXPECT_NEAR(flight.smoothness.path_length_ratio.value(), 1.0, 0.02);
  EXPECT_NEAR(flight.smoothness.sign_changes_hz.value()[1], 10.0, 0.2);
  EXPECT_EQ(flight.tether.contacts_formed, 1);
  EXPECT_NEAR(flight.tether.tension_max.value(), 1.0, 1e-3);
  ASSERT_TRUE(flight.loop.last);
  EXPECT_EQ(flight.loop.last->overruns, 2);
  ASSERT_GE(flight.modes.size(), 5U);
  EXPECT_EQ(flight.modes[4].mode, Mode::kAuto);
}

TEST(FlightLogFile, WallClockAndMissingParts) {
  const auto file = logFile("partial.lcm");
  writeSyntheticLog({.start_utime = 1700000000000000,
                     .completes = false,
                     .lands = false,
                     .with_truth = false,
                     .with_plan = false},
                    file);
  const FlightLog log = readFlightLog(file);
  EXPECT_EQ(log.start_utime, 1700000000000000);
  const FlightAnalysis flight = analyze(log);
  EXPECT_FALSE(flight.outcome.mission_completed);
  EXPECT_FALSE(flight.outcome.landed);
  EXPECT_EQ(flight.outcome.mission_failure, MissionFailure::kNoProgress);
  EXPECT_FALSE(flight.plan);
  EXPECT_NEAR(flight.cross_track.all->mean, std::hypot(0.05, 0.08), 0.03)
      << "estimate instead of truth";
  EXPECT_EQ(flight.notes.size(), 2U);
}

TEST(FlightLogFile, DamageIsCountedAndReadingGoesOn) {
  const auto whole = logFile("whole.lcm");
  writeSyntheticLog({}, whole);
  std::ostringstream text;
  text << std::ifstream(whole, std::ios::binary).rdbuf();
  std::string bytes = text.str();
  const auto cut = logFile("cut.lcm");
  const std::size_t hole = bytes.size() / 2;
  bytes = bytes.substr(0, hole) +
          bytes.substr(hole + 5003, bytes.size() - hole - 5003 - 17);  // a hole, and a cut end
  std::ofstream(cut, std::ios::binary) << bytes;
  const FlightLog log = readFlightLog(cut);
  EXPECT_THAT(log.damage, HasSubstr("damaged in 2 places, at least "));
  const FlightLog reference = readFlightLog(whole);
  EXPECT_GT(log.estimates.size(), reference.estimates.size() - 40);
  EXPECT_LT(log.estimates.size(), reference.estimates.size());
}

// The generated decoder trusts string lengths; a forged one must be refused before it is called.
TEST(FlightLogFile, ForgedMessagesAreCountedNotFatal) {
  const auto file = logFile("forged.lcm");
  writeSyntheticLog({.lands = false}, file);
  {
    lcm::LogFile log(file.string(), "a");
    event_t message{};
    message.text = "abc";
    std::vector<unsigned char> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    const auto append = [&](const std::vector<unsigned char>& payload) {
      std::vector<unsigned char> copy = payload;
      lcm::LogEvent event{};
      event.channel = "EVENT";
      event.datalen = static_cast<std::int32_t>(copy.size());
      event.data = copy.data();
      log.writeEvent(&event);
    };
    for (const unsigned char high : std::vector<unsigned char>{0x7f, 0xff}) {
      auto forged = bytes;
      forged[21] = high;  // length of the first string
      append(forged);
    }
    auto zero = bytes;
    std::memset(&zero[21], 0, 4);
    append(zero);
    append(std::vector<unsigned char>(bytes.begin(), bytes.end() - 3));
    append({1, 2, 3});
    append(bytes);  // and a sound one
  }
  const FlightLog log = readFlightLog(file);
  EXPECT_EQ(log.channels.at("EVENT").undecodable, 5);
  EXPECT_EQ(log.channels.at("EVENT").messages, 3);
}

/// Copies a log; the messages of `channel` get a fingerprint that no type of ours has.
void writeOfAnotherVersion(const std::filesystem::path& from, const std::filesystem::path& to,
                           const std::string& channel, bool only_the_first) {
  lcm::LogFile in(from.string(), "r");
  lcm::LogFile out(to.string(), "w");
  bool done = false;
  while (const lcm::LogEvent* event = in.readNextEvent()) {
    lcm::LogEvent copy = *event;
    std::vector<unsigned char> bytes(static_cast<unsigned char*>(event->data),
                                     static_cast<unsigned char*>(event->data) + event->datalen);
    if (event->channel == channel && !done) {
      bytes[3] ^= 0x10U;
      done = only_the_first;
    }
    copy.data = bytes.data();
    out.writeEvent(&copy);
  }
}

TEST(FlightLogFile, ALogOfAnotherVersionIsRefusedByName) {
  const auto whole = logFile("this_version.lcm");
  const auto other = logFile("other_version.lcm");
  writeSyntheticLog({}, whole);
  writeOfAnotherVersion(whole, other, "VEHICLE_STATE", false);
  try {
    static_cast<void>(readFlightLog(other));
    FAIL() << "read without a word";
  } catch (const InputError& e) {
    EXPECT_EQ(e.code(), ExitCode::kConfig);
    EXPECT_EQ(e.problem().key, "VEHICLE_STATE");
    EXPECT_THAT(e.what(),
                HasSubstr("other_version.lcm: VEHICLE_STATE: recorded by another version"));
    EXPECT_THAT(e.what(), HasSubstr("with the programs of the version that recorded it"));
  }
  // One alone is damage, or a stranger on the channel.
  writeOfAnotherVersion(whole, other, "VEHICLE_STATE", true);
  EXPECT_EQ(readFlightLog(other).channels.at("VEHICLE_STATE").undecodable, 1);
}

TEST(FlightLogFile, WhatIsNoFlightLogIsSaidPlainly) {
  const auto message = [](const std::filesystem::path& file) -> std::string {
    try {
      (void)readFlightLog(file);
    } catch (const InputError& e) {
      return e.what();
    }
    return {};
  };
  EXPECT_THAT(message("/not/there.lcm"), HasSubstr("/not/there.lcm: this log cannot be read"));
  EXPECT_THAT(message(::testing::TempDir()), HasSubstr("cannot be read"));
  const auto text = logFile("text.lcm");
  std::ofstream(text) << "hello, this is no log\n";
  EXPECT_THAT(message(text), HasSubstr("no event of an LCM log"));
  const auto foreign = logFile("foreign.lcm");
  {
    lcm::LogFile log(foreign.string(), "w");
    char payload[4] = {1, 2, 3, 4};
    lcm::LogEvent event{};
    event.channel = "SOMETHING_ELSE";
    event.datalen = 4;
    event.data = payload;
    log.writeEvent(&event);
  }
  EXPECT_THAT(message(foreign), HasSubstr("no message of a Tautline station"));
}

}  // namespace
}  // namespace tautline::report
