#include "app/report/analysis.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace tautline::report {
namespace {

constexpr std::int64_t kHash = 42;

MissionSample running(double t, int waypoint, const Eigen::Vector3d& start,
                      const Eigen::Vector3d& target) {
  return {t, kHash, MissionState::kRunning, MissionFailure::kNone, waypoint, 2, target, start, 0.0};
}

TruthSample truthAt(double t, const Eigen::Vector3d& p) {
  TruthSample s;
  s.t = t;
  s.p_WD = p;
  s.on_ground = false;
  s.motors_on = true;
  return s;
}

// Half circle over its diameter: the distance to the diameter is R |sin a|, so mean 2R/pi, RMS
// R/sqrt(2), max R.
TEST(Analysis, HalfCircleAgainstItsDiameter) {
  constexpr double kRadius = 1.5;
  constexpr double kRate = 0.2;  // [rad/s]
  FlightLog log;
  for (int i = 0; i * 0.02 * kRate <= std::numbers::pi; ++i) {
    const double a = i * 0.02 * kRate;
    log.truth.push_back(
        truthAt(i * 0.02, kRadius * Eigen::Vector3d(-std::cos(a), std::sin(a), 0.0)));
    if (i % 5 == 0) log.mission.push_back(running(i * 0.02, 0, {-kRadius, 0, 0}, {kRadius, 0, 0}));
  }
  const FlightAnalysis flight = analyze(log);
  ASSERT_TRUE(flight.cross_track.all);
  EXPECT_NEAR(flight.cross_track.all->mean, 2.0 * kRadius / std::numbers::pi, 0.01);
  EXPECT_NEAR(flight.cross_track.all->rms, kRadius / std::numbers::sqrt2, 0.01);
  EXPECT_NEAR(flight.cross_track.all->max, kRadius, 1e-3);
  // Uniform circular motion: a = R w^2, jerk = R w^3; arc over diameter = pi/2.
  EXPECT_NEAR(flight.smoothness.rms_acceleration.value(), kRadius * kRate * kRate, 1e-3);
  EXPECT_NEAR(flight.smoothness.rms_jerk.value(), kRadius * std::pow(kRate, 3), 1e-3);
  EXPECT_NEAR(flight.smoothness.path_length_ratio.value(), std::numbers::pi / 2.0, 0.01);
}

TEST(Analysis, EverySegmentHasItsOwnFigures) {
  FlightLog log;
  for (int i = 0; i <= 200;
       ++i) {  // 1 m/s along x, then along z; 0.1 m above the first leg, 0.3 m above the second
    const double t = i * 0.05;
    const bool first = t < 5.0;
    log.truth.push_back(
        truthAt(t, first ? Eigen::Vector3d(t, 0.1, 0) : Eigen::Vector3d(5, 0.3, t - 5.0)));
    log.mission.push_back(first ? running(t, 0, {0, 0, 0}, {5, 0, 0})
                                : running(t, 1, {5, 0, 0}, {5, 0, 5}));
  }
  const auto& segments = analyze(log).cross_track.segments;
  ASSERT_EQ(segments.size(), 2U);
  EXPECT_NEAR(segments[0].cross_track->mean, 0.1, 1e-9);
  EXPECT_NEAR(segments[1].cross_track->mean, 0.3, 1e-9);
  EXPECT_EQ(segments[1].waypoint, 1);
  EXPECT_NEAR(segments[1].closest_approach.value(), 0.3, 1e-9);
  EXPECT_NEAR(segments[0].time.length(), 5.0, 0.1);
}

TEST(Analysis, OnlyTheRunningMissionCounts) {
  FlightLog log;
  for (int i = 0; i <= 100; ++i) {
    const double t = i * 0.1;
    log.truth.push_back(truthAt(t, {0, t < 5.0 ? 0.2 : 7.0, 0}));
    MissionSample m = running(t, 0, {0, 0, 0}, {0, 0, 1});
    if (t >= 4.9) m.state = MissionState::kPaused;
    log.mission.push_back(m);
  }
  const FlightAnalysis flight = analyze(log);
  EXPECT_NEAR(flight.cross_track.all->max, 0.2, 1e-9);
  EXPECT_NEAR(flight.mission->length(), 4.9, 0.11);
  EXPECT_FALSE(flight.outcome.mission_completed);
}

TEST(Analysis, LocalizationErrorThatGrowsWithTheTether) {
  FlightLog log;
  for (int i = 0; i <= 1000; ++i) {
    TruthSample s = truthAt(i * 0.02, {0, 0, 1.0 + i * 0.002});
    s.L_total = s.p_WD.norm();
    log.truth.push_back(s);
    EstimateSample e;
    e.t = s.t - 0.01;  // between two truths
    e.valid = true;
    e.p_WD = Eigen::Vector3d(0.02 + 0.1 * (s.L_total - 0.001), 0, s.p_WD.z() - 0.001);
    if (i > 0) log.estimates.push_back(e);
  }
  const LocalizationReport r = analyze(log).localization;
  ASSERT_TRUE(r.all);
  EXPECT_NEAR(r.all->mean, 0.02 + 0.1 * 2.0, 1e-3);
  EXPECT_NEAR(r.all->max, 0.02 + 0.1 * 3.0, 1e-3);
  EXPECT_NEAR(r.slope_over_length.value(), 0.1, 1e-6);
}

TEST(Analysis, WithoutTruthTheEstimateStandsIn) {
  FlightLog log;
  for (int i = 0; i <= 50; ++i) {
    EstimateSample e;
    e.t = i * 0.1;
    e.valid = i != 10;  // an invalid one is no position
    e.p_WD = i == 10 ? Eigen::Vector3d(99, 99, 99) : Eigen::Vector3d(0, 0.4, 0.1 * i);
    log.estimates.push_back(e);
    log.mission.push_back(running(e.t, 0, {0, 0, 0}, {0, 0, 5}));
    log.vehicle.push_back({e.t, i < 40 ? VehiclePhase::kFlying : VehiclePhase::kStopped});
  }
  const FlightAnalysis flight = analyze(log);
  EXPECT_FALSE(flight.has_truth);
  EXPECT_NEAR(flight.cross_track.all->max, 0.4, 1e-9);
  EXPECT_FALSE(flight.localization.all);
  EXPECT_TRUE(flight.outcome.landed);
  EXPECT_NEAR(flight.airborne->length(), 3.9, 1e-9);
}

TEST(Analysis, LandedMeansDownWithMotorsOffAndWhole) {
  FlightLog good;
  good.vehicle = {{0, VehiclePhase::kIdle}, {1, VehiclePhase::kFlying}, {5, VehiclePhase::kIdle}};
  TruthSample down = truthAt(0.0, {0, 0, 0});
  down.on_ground = true;
  down.motors_on = false;
  TruthSample sinking = truthAt(4.0, {0, 0.01, 0});
  sinking.v_WD = {0, -0.3, 0};
  good.truth = {down, truthAt(1.0, {0, 1, 0}), sinking, down};
  good.truth.back().t = 5.0;
  EXPECT_TRUE(analyze(good).outcome.landed);
  EXPECT_NEAR(analyze(good).outcome.touchdown_speed.value(), 0.3, 1e-12);

  FlightLog fallen = good;
  fallen.truth.back().crashed = true;
  EXPECT_TRUE(analyze(fallen).outcome.crashed);
  EXPECT_FALSE(analyze(fallen).outcome.landed);

  FlightLog motors_on = good;
  motors_on.truth.back().motors_on = true;
  EXPECT_FALSE(analyze(motors_on).outcome.landed);

  FlightLog vehicle_says_flying = good;
  vehicle_says_flying.vehicle.back().phase = VehiclePhase::kFlying;
  EXPECT_FALSE(analyze(vehicle_says_flying).outcome.landed);

  FlightLog never_flew = good;
  never_flew.vehicle = {{0, VehiclePhase::kIdle}};
  never_flew.truth = {down};
  EXPECT_FALSE(analyze(never_flew).outcome.flew);
  EXPECT_FALSE(analyze(never_flew).outcome.landed);
}

TEST(Analysis, AnotherMissionsCompletionDoesNotCount) {
  FlightLog log;
  log.mission = {running(0, 0, {0, 0, 0}, {1, 0, 0}), running(1, 0, {0, 0, 0}, {1, 0, 0})};
  log.mission[0].hash = 7;
  log.mission[0].state = MissionState::kCompleted;
  EXPECT_FALSE(analyze(log).outcome.mission_completed);
  log.mission[1].state = MissionState::kCompleted;
  EXPECT_TRUE(analyze(log).outcome.mission_completed);
}

// The way back undoes the mission's legs under its hash, and its end is no completed mission.
TEST(Analysis, TheWayBackIsNotTheMission) {
  FlightLog log;
  const auto at = [&log](double t, Mode mode, MissionState state) {
    log.states.push_back({t, RunMode::kSim, mode, {}, kHash});
    log.mission.push_back(running(t, 0, {0, 0, 0}, {1, 0, 0}));
    log.mission.back().state = state;
    log.truth.push_back(truthAt(t, {0, mode == Mode::kLand ? 9.0 : 0.5, 0}));
  };
  at(0, Mode::kTakeoff, MissionState::kCompleted);
  at(1, Mode::kAuto, MissionState::kRunning);
  at(2, Mode::kAuto, MissionState::kFailed);
  at(3, Mode::kHold, MissionState::kFailed);
  at(4, Mode::kLand, MissionState::kRunning);
  at(5, Mode::kLand, MissionState::kCompleted);
  const FlightAnalysis flight = analyze(log);
  EXPECT_FALSE(flight.outcome.mission_completed);
  EXPECT_EQ(flight.outcome.mission_state, MissionState::kFailed);
  EXPECT_EQ(flight.outcome.interruption, "HOLD by the operator");
  EXPECT_NEAR(flight.cross_track.all->max, 0.5, 1e-12);
  EXPECT_NEAR(flight.mission->end, 2.0, 1e-12);
}

TEST(Analysis, GapsAndSignChanges) {
  FlightLog log;
  ChannelStats& stats = log.channels["ESTIMATE"];
  for (int i = 0; i < 100; ++i) {
    if (i < 50 || i >= 70) stats.times.push_back(i * 0.1);
  }
  stats.messages = static_cast<std::int64_t>(stats.times.size());
  for (int i = 0; i <= 100; ++i) {
    log.mission.push_back(running(i * 0.1, 0, {0, 0, 0}, {1, 0, 0}));
    log.commands.push_back(
        {i * 0.1, true, 0.1, i % 2 == 0 ? 0.2 : -0.2, (i / 10) % 2 == 0 ? 0.2 : -0.2});
  }
  const FlightAnalysis flight = analyze(log);
  ASSERT_EQ(flight.channels.size(), 1U);
  EXPECT_NEAR(flight.channels[0].period.value(), 0.1, 1e-9);
  EXPECT_NEAR(flight.channels[0].longest_gap.value(), 2.1, 1e-9);
  EXPECT_EQ(flight.channels[0].gaps, 1);
  const auto changes = flight.smoothness.sign_changes_hz.value();
  EXPECT_EQ(changes[0], 0.0);
  EXPECT_NEAR(changes[1], 10.0, 1e-9);
  EXPECT_NEAR(changes[2], 1.0, 1e-9);
}

TEST(Analysis, AnEmptyLogIsAllAbsent) {
  const FlightAnalysis flight = analyze(FlightLog{});
  EXPECT_FALSE(flight.run_mode);
  EXPECT_FALSE(flight.cross_track.all);
  EXPECT_FALSE(flight.localization.all);
  EXPECT_FALSE(flight.smoothness.rms_jerk);
  EXPECT_FALSE(flight.loop.last);
  EXPECT_FALSE(flight.outcome.mission_completed);
}

}  // namespace
}  // namespace tautline::report
