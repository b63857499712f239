// Operators in flight: sticks, silence, strangers, parameters, against the simulated machine.

#include <filesystem>
#include <memory>

#include <gtest/gtest.h>

#include "app/bench/lockstep.h"
#include "app/bench/log_sink.h"
#include "app/bench/replay.h"
#include "app/station/mission_upload.h"
#include "common/mission/mission_file.h"
#include "common/toml/config_file.h"

namespace tautline::bench {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::int64_t kAnna = 11;
constexpr std::int64_t kBert = 22;
const fs::path kConfig = fs::path(TAUTLINE_SOURCE_DIR) / "config";

struct Flight {
  LockstepConfig config;
  std::unique_ptr<Lockstep> bench;
  Mission square = readMission(kConfig / "missions" / "square.mission.toml");
  std::int64_t sequence{0};

  explicit Flight(WithoutOperator without = WithoutOperator::kGoOn, TelemetrySink* sink = nullptr) {
    config.station = loadConfig<StationConfig>(kConfig / "station.toml");
    config.station.core.authority.auto_without_operator = without;
    config.sim = loadConfig<sim::SimConfig>(kConfig / "sim.toml");
    config.world = sceneInWorld(readScene(kConfig / "scenes" / "open.scene.toml"));
    config.seed = 3;
    bench = std::make_unique<Lockstep>(config, sink);
    wait(seconds(3));
  }
  AckResult ask(OperatorCommand command, std::int64_t who = kAnna) {
    command.session = who;
    command.sequence = ++sequence;
    command.mission_hash = square.plan->hash;
    return bench->step(command).ack->result;
  }
  bool asks(Request request) { return ask({.request = request}) == AckResult::kAccepted; }
  void wait(Duration d) {
    for (const Time end = bench->now() + d; bench->now() < end;) bench->step();
  }
  bool until(Mode wanted, Duration limit) {
    for (const Time end = bench->now() + limit; bench->now() < end && mode() != wanted;)
      bench->step();
    return mode() == wanted;
  }
  Mode mode() const { return bench->output().supervision.mode; }
  bool has(Condition c) const { return bench->output().conditions.has(c); }
  bool takesOff() {
    return asks(Request::kArm) && asks(Request::kTakeoff) && until(Mode::kHold, seconds(30));
  }
  bool navigates() {
    forEachChunk(*square.plan, [&](tautline::mission_chunk_t& chunk) {
      chunk.session = kAnna;
      chunk.sequence = ++sequence;
      return bench->step({}, &chunk).ack->result == AckResult::kAccepted;
    });
    const bool taken = asks(Request::kNavigate);
    wait(seconds(3));
    return taken && mode() == Mode::kAuto;
  }
};

TEST(OperatorFlight, ASilentOperatorEndsTeleopInAFailsafeThenTheWayBack) {
  Flight flight;
  ASSERT_TRUE(flight.takesOff());
  ASSERT_TRUE(flight.asks(Request::kTeleop));
  flight.wait(seconds(3));
  EXPECT_EQ(flight.mode(), Mode::kTeleop);
  flight.bench->silence(true);
  EXPECT_TRUE(flight.until(Mode::kFailsafe, milliseconds(800)));
  EXPECT_TRUE(flight.bench->output().supervision.reasons.has(Condition::kOperatorLost));
  flight.wait(seconds(11));
  EXPECT_TRUE(flight.mode() == Mode::kReturn || flight.mode() == Mode::kLand);
  EXPECT_TRUE(flight.has(Condition::kFaultLatched));
}

TEST(OperatorFlight, StaleSticksAreToldAndTheDroneStandsStill) {
  Flight flight;
  ASSERT_TRUE(flight.takesOff());
  ASSERT_TRUE(flight.asks(Request::kTeleop));
  flight.bench->holdSticks(Sticks{.session = kAnna, .dead_man = true, .rates = {}});
  flight.wait(milliseconds(50));
  EXPECT_FALSE(flight.has(Condition::kTeleopStale));
  flight.bench->holdSticks({});
  flight.wait(milliseconds(250));
  EXPECT_TRUE(flight.has(Condition::kTeleopStale));
  EXPECT_EQ(flight.mode(), Mode::kTeleop);
  EXPECT_FALSE(flight.bench->output().operators->authority().rates(flight.bench->now()));
}

TEST(OperatorFlight, SticksMovedInAMissionEndItInHold) {
  Flight flight;
  ASSERT_TRUE(flight.takesOff() && flight.navigates());
  const Sticks moved{.session = kAnna, .dead_man = true, .rates = {.azimuth = 0.2}};
  Sticks released = moved;
  released.dead_man = false;
  Sticks strangers = moved;
  strangers.session = kBert;
  for (const Sticks& harmless : {released, strangers}) {
    flight.bench->holdSticks(harmless);
    flight.wait(seconds(1));
    EXPECT_EQ(flight.mode(), Mode::kAuto);
  }
  flight.bench->holdSticks(moved);
  flight.bench->step();
  EXPECT_EQ(flight.mode(), Mode::kHold);
  EXPECT_TRUE(flight.bench->output().supervision.reasons.has(Condition::kSticksMoved));
}

TEST(OperatorFlight, AMissionGoesOnWithoutItsOperator) {
  Flight flight(WithoutOperator::kGoOn);
  ASSERT_TRUE(flight.takesOff() && flight.navigates());
  flight.bench->silence(true);
  flight.wait(seconds(12));
  EXPECT_TRUE(flight.has(Condition::kNoOperator));
  EXPECT_TRUE(flight.until(Mode::kReturn, seconds(300))) << "nobody is there to bring it home";
  EXPECT_EQ(flight.bench->output().mission.state, MissionState::kCompleted);
  EXPECT_TRUE(flight.until(Mode::kStandby, seconds(300)));
}

TEST(OperatorFlight, OrHoldsWhereThatIsConfigured) {
  Flight flight(WithoutOperator::kHold);
  ASSERT_TRUE(flight.takesOff() && flight.navigates());
  flight.bench->silence(true);
  flight.wait(milliseconds(9500));
  EXPECT_EQ(flight.mode(), Mode::kAuto);
  EXPECT_TRUE(flight.until(Mode::kFailsafe, seconds(1)));
}

TEST(OperatorFlight, AStrangerMayCalmAFlightAndNothingElse) {
  Flight flight;
  ASSERT_TRUE(flight.takesOff());
  for (const Request bold :
       {Request::kNavigate, Request::kTeleop, Request::kBackUp, Request::kDisarm})
    EXPECT_EQ(flight.ask({.request = bold}, kBert), AckResult::kNotHolder);
  EXPECT_EQ(flight.mode(), Mode::kHold);
  EXPECT_EQ(flight.ask({.request = Request::kStop}, kBert), AckResult::kAccepted);
  EXPECT_EQ(flight.mode(), Mode::kFailsafe);
  EXPECT_EQ(flight.ask({.request = Request::kLand}, kBert), AckResult::kAccepted);
  EXPECT_TRUE(flight.until(Mode::kStandby, seconds(120)));
}

TEST(OperatorFlight, AnArmedStationWithoutAnOperatorDisarms) {
  Flight flight;
  ASSERT_TRUE(flight.asks(Request::kArm));
  flight.bench->silence(true);
  flight.wait(milliseconds(9500));
  EXPECT_EQ(flight.mode(), Mode::kArmed);
  EXPECT_TRUE(flight.until(Mode::kStandby, seconds(1)));
  EXPECT_TRUE(flight.bench->output().supervision.reasons.has(Condition::kNoOperator));
}

TEST(OperatorFlight, AParameterIsFlownAndTheLogReplaysBitExactly) {
  const fs::path log = fs::path(::testing::TempDir()) / "tautline_operator_flight.lcm";
  {
    LogSink sink(log);
    Flight flight(WithoutOperator::kGoOn, &sink);
    ASSERT_EQ(flight.ask({.service = Service::kSetParameter,
                          .parameter = parameterHash("core.guidance.takeoff_height_m"),
                          .value = 1.4}),
              AckResult::kAccepted);
    ASSERT_TRUE(flight.takesOff());
    flight.wait(seconds(8));
    const double home = flight.config.world.start->y();
    // Take-off ends within takeoff_radius_m of the hover point; the default would hover below 0.9
    // m.
    EXPECT_NEAR(flight.bench->truth().p_WD.y() - home, 1.4, 0.35);
    ASSERT_TRUE(flight.asks(Request::kTeleop));
    flight.bench->holdSticks(
        Sticks{.session = kAnna, .dead_man = true, .rates = {.elevation = 0.05, .yaw = 0.1}});
    flight.wait(seconds(2));
    flight.bench->holdSticks({});
    ASSERT_TRUE(flight.asks(Request::kLand));
    EXPECT_TRUE(flight.until(Mode::kStandby, seconds(120)));
  }
  const ReplayResult r = replay(log);
  EXPECT_GT(r.commands_compared, 300);
  EXPECT_EQ(r.differences, 0) << r.first_difference;
  fs::remove(log);
}

}  // namespace
}  // namespace tautline::bench
