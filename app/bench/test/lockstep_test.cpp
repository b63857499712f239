// Flights of the real core, driver and codec against the simulated machine.

#include "app/bench/lockstep.h"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

#include <gtest/gtest.h>

#include "app/bench/log_sink.h"
#include "app/bench/replay.h"
#include "app/bench/test/bench_flight.h"
#include "common/error.h"
#include "common/testing/malloc_guard.h"

namespace tautline::bench {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;

fs::path temporary(const std::string& name) {
  return fs::path(::testing::TempDir()) / ("tautline_lockstep_" + name);
}

std::string bytesOf(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

/// Brings a bench into the middle of a mission.
struct Airborne {
  std::unique_ptr<Lockstep> bench;
  Mission plan = mission("square");
  std::int32_t sequence{0};

  explicit Airborne(TelemetrySink* sink = nullptr) {
    bench = std::make_unique<Lockstep>(benchConfig("open", 3), sink);
    for (int i = 0; i < 300; ++i) bench->step();
    ask(Request::kArm);
    ask(Request::kTakeoff);
    EXPECT_TRUE(until(Mode::kHold, seconds(30)));
    forEachChunkOf();
    ask(Request::kNavigate);
    EXPECT_EQ(mode(), Mode::kAuto);
    wait(seconds(5));
  }
  void forEachChunkOf();
  bool ask(Request request) {
    const StepOutput& out = bench->step(OperatorCommand{7, ++sequence, request, plan.plan->hash});
    return out.ack && out.ack->result == AckResult::kAccepted;
  }
  Mode mode() const { return bench->output().supervision.mode; }
  void wait(Duration d) {
    for (const Time end = bench->now() + d; bench->now() < end;) bench->step();
  }
  bool until(Mode wanted, Duration limit) {
    for (const Time end = bench->now() + limit; bench->now() < end && mode() != wanted;)
      bench->step();
    return mode() == wanted;
  }
};

void Airborne::forEachChunkOf() {
  // The square has few waypoints: one chunk is enough.
  tautline::mission_chunk_t chunk{};
  chunk.session = 7;
  chunk.sequence = ++sequence;
  chunk.mission_hash = static_cast<std::int64_t>(plan.plan->hash);
  chunk.waypoint_total = plan.plan->waypoint_count;
  chunk.count = plan.plan->waypoint_count;
  ASSERT_LE(chunk.count, tautline::mission_chunk_t::CAPACITY);
  for (int i = 0; i < chunk.count; ++i) {
    const Waypoint& w = plan.plan->waypoints[static_cast<std::size_t>(i)];
    for (int k = 0; k < 3; ++k) chunk.position_m[i][k] = w.p_WD[k];
    chunk.speed_mps[i] = w.speed;
  }
  bench->step({}, &chunk);
}

class Missions : public ::testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(Missions, IsCompletedAndLanded) {
  const auto [name, scene] = GetParam();
  Lockstep bench(benchConfig(scene, 1), nullptr);
  const FlightResult r = flyMission(bench, *mission(name).plan, seconds(900));
  EXPECT_TRUE(r.armed);
  EXPECT_TRUE(r.took_off);
  EXPECT_TRUE(r.completed);
  EXPECT_TRUE(r.landed);
  EXPECT_EQ(r.crash, sim::CrashReason::kNone) << nameOf(r.crash, sim::kCrashReasonNames);
}
INSTANTIATE_TEST_SUITE_P(
    Shipped, Missions,
    ::testing::Values(std::pair{"square", "open"}, std::pair{"path1_0.5", "open"},
                      std::pair{"path1_3", "open"}, std::pair{"path2_0.5", "open"},
                      std::pair{"path2_3", "open"}, std::pair{"one_contact", "one_contact"},
                      std::pair{"two_contacts", "two_contacts"}),
    [](const auto& param_info) {
      std::string name = param_info.param.first;
      for (char& c : name) c = c == '.' ? '_' : c;
      return name;
    });

// Path 2 over the reel, against the whole simulated machine: every interval, many seeds, no trap at
// the pole.
TEST(Lockstep, CrossesThePoleWithEverySeed) {
  for (const char* name : {"path2_0.2", "path2_0.5", "path2_1", "path2_1.5", "path2_3"}) {
    const Mission path = mission(name);
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      Lockstep bench(benchConfig("open", seed), nullptr);
      const FlightResult r = flyMission(bench, *path.plan, seconds(180));
      EXPECT_TRUE(r.completed && r.landed) << name << " seed " << seed;
    }
  }
}

TEST(Lockstep, SameSeedGivesTheSameLogByteForByte) {
  const Mission square = mission("square");
  std::string logs[3];
  const std::uint64_t seeds[3] = {5, 5, 6};
  for (int i = 0; i < 3; ++i) {
    const fs::path path = temporary("determinism.lcm");
    {
      LogSink sink(path);
      Lockstep bench(benchConfig("open", seeds[i]), &sink);
      flyMission(bench, *square.plan, seconds(40));
    }
    logs[i] = bytesOf(path);
    fs::remove(path);
  }
  EXPECT_GT(logs[0].size(), 100'000U);
  EXPECT_TRUE(logs[0] == logs[1]);
  EXPECT_FALSE(logs[0] == logs[2]) << "the seed must matter";
}

TEST(Lockstep, RecordedFlightReplaysBitExactly) {
  const fs::path path = temporary("replay.lcm");
  {
    LogSink sink(path);
    Lockstep bench(benchConfig("one_contact", 2), &sink);
    flyMission(bench, *mission("one_contact").plan, seconds(600));
  }
  const ReplayResult r = replay(path);
  EXPECT_GT(r.cycles, 3000);
  EXPECT_GT(r.commands_compared, 500);
  EXPECT_EQ(r.differences, 0) << r.first_difference;
  fs::remove(path);
}

/// Takes everything and keeps nothing.
class NullSink final : public TelemetrySink {
 public:
  bool publish(const char*, std::int64_t, std::span<const std::uint8_t> bytes) noexcept override {
    bytes_ += bytes.size();
    return true;
  }
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }

 private:
  std::size_t bytes_{0};
};

TEST(Lockstep, TenThousandCyclesInFlightWithoutTheHeap) {
  if (!testing::MallocGuard::available())
    GTEST_SKIP() << "SKIPPED: the heap cannot be watched under a sanitizer";
  NullSink sink;
  Airborne flight(&sink);
  const testing::MallocGuard guard;
  flight.wait(seconds(100));
  EXPECT_EQ(guard.allocations(), 0);
  EXPECT_GT(sink.bytes(), 1'000'000U);
}

TEST(Lockstep, UnpluggedInAMissionLandsWhenPluggedInAgain) {
  Airborne flight;
  flight.bench->port().unplug();
  flight.wait(seconds(1));
  EXPECT_EQ(flight.mode(), Mode::kLand);
  EXPECT_TRUE(flight.bench->output().supervision.reasons.has(Condition::kLinkLost));
  EXPECT_EQ(flight.bench->output().command.length_rate, 0.0);
  EXPECT_EQ(flight.bench->output().command.elevation_rate, 0.0);
  flight.bench->port().plug();
  EXPECT_TRUE(flight.until(Mode::kStandby, seconds(120)));
  flight.wait(seconds(1));  // the last centimetres, rotors off
  EXPECT_TRUE(flight.bench->truth().on_ground);
  EXPECT_FALSE(flight.bench->truth().crashed);
}

TEST(Lockstep, StopCutsTheMotorsAndStaysStopped) {
  Airborne flight;
  EXPECT_TRUE(flight.ask(Request::kEstop));
  flight.wait(seconds(3));
  EXPECT_EQ(flight.mode(), Mode::kEstop);
  EXPECT_FALSE(flight.bench->truth().motors_on);
  EXPECT_FALSE(flight.ask(Request::kArm));
  EXPECT_TRUE(flight.ask(Request::kDisarm));
  EXPECT_EQ(flight.mode(), Mode::kStandby);
}

TEST(Lockstep, HoldStandsStillAndAMissionCanBeginAgain) {
  Airborne flight;
  EXPECT_TRUE(flight.ask(Request::kHold));
  flight.wait(seconds(4));
  const Eigen::Vector3d before = flight.bench->truth().p_WD;
  flight.wait(seconds(10));
  EXPECT_LT((flight.bench->truth().p_WD - before).norm(), 0.3);
  flight.forEachChunkOf();
  EXPECT_TRUE(flight.ask(Request::kNavigate));
  EXPECT_EQ(flight.mode(), Mode::kAuto);
}

TEST(Lockstep, ACommandSentTwiceActsOnceAndIsAnsweredTwice) {
  Airborne flight;
  const OperatorCommand hold{7, 100, Request::kHold, 0};
  const OperatorCommand land{7, 101, Request::kLand, 0};
  EXPECT_TRUE(flight.bench->step(hold).ack.has_value());
  EXPECT_TRUE(flight.bench->step(land).ack.has_value());
  EXPECT_EQ(flight.mode(), Mode::kLand);
  EXPECT_TRUE(flight.bench->step(land).ack.has_value());
  EXPECT_EQ(flight.mode(), Mode::kLand);
}

TEST(Lockstep, RefusesToArmBeforeTheSensorsSpeak) {
  Lockstep bench(benchConfig("open", 1), nullptr);
  const StepOutput& out = bench.step(OperatorCommand{1, 1, Request::kArm, 0});
  ASSERT_TRUE(out.ack);
  EXPECT_EQ(out.ack->result, AckResult::kRefused);
  EXPECT_TRUE(out.ack->reasons.has(Condition::kReelStale));
  EXPECT_TRUE(out.ack->reasons.has(Condition::kAnglesStale));
}

TEST(Lockstep, NavigateWithoutThatMissionIsRefused) {
  Airborne flight;
  flight.ask(Request::kHold);
  const StepOutput& out = flight.bench->step(OperatorCommand{7, 200, Request::kNavigate, 12345});
  ASSERT_TRUE(out.ack);
  EXPECT_EQ(out.ack->result, AckResult::kBadMission);
  EXPECT_EQ(flight.mode(), Mode::kHold);
}

TEST(TautlineBus, FliesAMissionInLockstep) {
  Lockstep bench(busConfig("open", 1), nullptr);
  const FlightResult r = flyMission(bench, *mission("square").plan, seconds(900));
  EXPECT_TRUE(r.completed);
  EXPECT_TRUE(r.landed);
  const LinkStatus& link = bench.sensors().link;
  EXPECT_GT(link.lines_ok, 10000U);
  EXPECT_EQ(link.lines_bad, 0U);
  EXPECT_EQ(link.timeouts, 0U);
  EXPECT_EQ(link.fault, LinkFault::kNone);
}

TEST(TautlineBus, ReplaysBitExactly) {
  const fs::path log = temporary("bus.lcm");
  {
    LogSink sink(log);
    Lockstep bench(busConfig("open", 2), &sink);
    EXPECT_TRUE(flyMission(bench, *mission("square").plan, seconds(900)).completed);
  }
  const ReplayResult r = replay(log);
  EXPECT_GT(r.commands_compared, 100);
  EXPECT_EQ(r.differences, 0) << r.first_difference;
}

TEST(TautlineBus, CanHasNoLockstep) {
  LockstepConfig config = busConfig("open", 1);
  config.station.device = DeviceKind::kTautlineCan;
  EXPECT_THROW(Lockstep(config, nullptr), InputError);
}

}  // namespace
}  // namespace tautline::bench
