#include "app/experiments/mission_flight.h"

#include <gtest/gtest.h>

#include "app/experiments/flight_campaign.h"
#include "common/mission/mission_file.h"
#include "common/mission/scene.h"

namespace tautline::experiments {
namespace {

FlightFacts finished() {
  FlightFacts facts;
  facts.began = true;
  facts.completed = true;
  facts.goal_distance = 0.1;
  facts.error = 0.1;
  return facts;
}

FlightEnd endOf(const FlightFacts& facts) { return judge(facts, kGoalTolerance); }

TEST(JudgedFlight, FinishedOnlyWhereTheMissionTrulyEnds) {
  FlightFacts facts = finished();
  EXPECT_EQ(endOf(facts), FlightEnd::kFinished);
  facts.goal_distance = 0.71;
  facts.error = 0.71;
  EXPECT_EQ(endOf(facts), FlightEnd::kMissed);
  facts.contact = true;
  EXPECT_EQ(endOf(facts), FlightEnd::kContactLost);
}

TEST(JudgedFlight, CrashesByWhatWasTouchedWhateverTheStationBelieves) {
  FlightFacts facts = finished();
  facts.crash = sim::CrashReason::kObstacle;
  EXPECT_EQ(endOf(facts), FlightEnd::kObstacle);
  facts.crash = sim::CrashReason::kRoom;
  EXPECT_EQ(endOf(facts), FlightEnd::kRoom);
  facts.crash = sim::CrashReason::kHardLanding;
  EXPECT_EQ(endOf(facts), FlightEnd::kRoom);
  facts = finished();
  facts.grounded = true;
  EXPECT_EQ(endOf(facts), FlightEnd::kRoom);
}

TEST(JudgedFlight, NeverThereIsOscillation) {
  FlightFacts facts = finished();
  facts.completed = false;
  facts.stood_still = true;
  EXPECT_EQ(endOf(facts), FlightEnd::kOscillation);
  facts.stood_still = false;
  facts.conditions = {Condition::kMissionFailed};
  EXPECT_EQ(endOf(facts), FlightEnd::kOscillation);
  facts.conditions = {Condition::kOscillation};
  EXPECT_EQ(endOf(facts), FlightEnd::kOscillation);
}

TEST(JudgedFlight, LostAfterAContactComesBeforeOscillation) {
  FlightFacts facts = finished();
  facts.completed = false;
  facts.conditions = {Condition::kMissionFailed, Condition::kLocalizationLost};
  EXPECT_EQ(endOf(facts), FlightEnd::kOscillation);
  facts.contact = true;
  EXPECT_EQ(endOf(facts), FlightEnd::kContactLost);
}

TEST(JudgedFlight, TheRestIsTheSupervisors) {
  FlightFacts facts = finished();
  facts.completed = false;
  facts.conditions = {Condition::kFenceClearance};
  EXPECT_EQ(endOf(facts), FlightEnd::kAborted);
  facts = FlightFacts{};
  EXPECT_EQ(endOf(facts), FlightEnd::kNotStarted);
}

TEST(JudgedFlight, VerdictsReadBack) {
  const FlightVerdict v{FlightEnd::kContactLost, 3, {1.0, 2.5, -0.25}, 0.75, 61.25, "FENCE"};
  const FlightVerdict back = verdictFrom(toJson(v));
  EXPECT_EQ(back.end, v.end);
  EXPECT_EQ(back.waypoint, 3);
  EXPECT_EQ(back.p_WD, v.p_WD);
  EXPECT_EQ(back.seconds, 61.25);
  EXPECT_EQ(back.why, "FENCE");
}

CampaignFlight square(const Mission& mission) {
  CampaignFlight flight;
  flight.mission = &mission;
  flight.world = sceneInWorld(readScene(TAUTLINE_SOURCE_DIR "/config/scenes/open.scene.toml"));
  return flight;
}

TEST(FlownMission, FinishesInTheOpenAndTouchesWhatIsInItsWay) {
  const Mission mission = readMission(TAUTLINE_SOURCE_DIR "/config/missions/square.mission.toml");
  CampaignFlight flight = square(mission);
  const FlightVerdict fine = flyPlanned(flight.config(1), *mission.plan, kGoalTolerance);
  EXPECT_EQ(fine.end, FlightEnd::kFinished);
  EXPECT_LT(fine.error, 0.3);
  // A post on the way to the second waypoint that the station does not know.
  const Eigen::Vector3d on_the_way =
      0.5 * (mission.plan->waypoints[0].p_WD + mission.plan->waypoints[1].p_WD);
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.1);
  flight.world.boxes.push_back(
      {.name = "post", .min = on_the_way - half, .max = on_the_way + half});
  bench::LockstepConfig config = flight.config(1);
  config.map_known = false;
  const FlightVerdict hit = flyPlanned(config, *mission.plan, kGoalTolerance);
  EXPECT_EQ(hit.end, FlightEnd::kObstacle) << hit.why;
}

TEST(FlightCampaign, ShardsTogetherAreTheWhole) {
  const Mission mission = readMission(TAUTLINE_SOURCE_DIR "/config/missions/square.mission.toml");
  mission.plan->waypoint_count = 1;
  const CampaignFlight flight = square(mission);
  CampaignOptions options{.flights = 4, .seed = 9, .shard = {}, .workers = 2, .folder = {}};
  const CampaignTally whole = flyFlights(flight, options);
  ASSERT_EQ(whole.flights(), 4);
  options.shard = {1, 2};
  const CampaignTally first = flyFlights(flight, options);
  options.shard = {2, 2};
  const CampaignTally second = flyFlights(flight, options);
  ASSERT_EQ(first.flights() + second.flights(), 4);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(toJson(whole.verdicts[2 * i]), toJson(first.verdicts[i]));
    EXPECT_EQ(toJson(whole.verdicts[2 * i + 1]), toJson(second.verdicts[i]));
  }
}

}  // namespace
}  // namespace tautline::experiments
