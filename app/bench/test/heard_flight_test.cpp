// A flight as its messages tell it: what the station's own telemetry says of a cycle is heard as
// that cycle, and nothing of one cycle is left in the next.

#include "app/bench/heard_flight.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tautline/sim_truth_t.hpp>

#include "app/bench/lockstep.h"
#include "app/station/telemetry.h"
#include "common/mission/mission_file.h"
#include "lcmtypes/channels.h"

namespace tautline::bench {
namespace {

const std::string kConfig = TAUTLINE_SOURCE_DIR "/config/";

/// Keeps what is sent, as a network would deliver it.
class Recorder final : public TelemetrySink {
 public:
  bool publish(const char* channel, std::int64_t,
               std::span<const std::uint8_t> bytes) noexcept override {
    sent.emplace_back(channel, std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
    return true;
  }
  std::vector<std::pair<std::string, std::vector<std::uint8_t>>> sent;
};

struct Cycle {
  Time now{};
  Mode mode{};
  bool changed{false};
  ConditionSet conditions;
  std::uint32_t reel_sequence{0};
  std::vector<EventCode> events;
  std::int64_t acked{0};

  friend bool operator==(const Cycle&, const Cycle&) = default;
};

Cycle cycleOf(Time now, const StepOutput& out, const SensorFrame& sensors) {
  Cycle c{now,
          out.supervision.mode,
          out.supervision.changed,
          out.conditions,
          sensors.reel.sequence,
          {},
          out.ack ? out.ack->sequence : 0};
  for (int i = 0; i < out.event_count; ++i)
    c.events.push_back(out.events[static_cast<std::size_t>(i)].code);
  return c;
}

/// A mission of the bench with a fault in it, cycle by cycle, and what it sends.
struct Flown {
  std::vector<Cycle> cycles;
  Recorder recorder;
};
void fly(Flown& flown) {
  LockstepConfig config;
  config.world = sceneInWorld(readScene(kConfig + "scenes/open.scene.toml"));
  Lockstep bench(config, &flown.recorder);
  bench.inject(sim::parseFault("encoder off 12 4"));
  const Mission mission = readMission(kConfig + "missions/square.mission.toml");
  flyMission(bench, *mission.plan, std::chrono::seconds(30), [&](const Lockstep& b) {
    flown.cycles.push_back(cycleOf(b.now(), b.output(), b.sensors()));
  });
}

TEST(HeardFlight, IsTheFlightThatWasTold) {
  Flown flown;
  fly(flown);
  HeardFlight heard;
  std::size_t cycle = 0;
  std::optional<Time> now;
  int changes = 0;
  for (const auto& [channel, bytes] : flown.recorder.sent) {
    if (channel == channel::kStationInput) {
      if (now) {
        // All of a cycle has been said; conditions with nothing to tell come with the next SAFETY.
        const Cycle got = cycleOf(*now, heard.output(), heard.sensors());
        ASSERT_LT(cycle, flown.cycles.size());
        ASSERT_EQ(got, flown.cycles[cycle]) << "cycle " << cycle;
        changes += got.changed ? 1 : 0;
        ++cycle;
      }
      heard.take(channel, bytes);
      now = heard.next();
      heard.goOn();
      continue;
    }
    heard.take(channel, bytes);
  }
  EXPECT_GT(cycle, 2500U);
  EXPECT_GE(changes, 4) << "armed, took off, hovered, flew";
}

TEST(HeardFlight, RatesOfTheModeBeforeDoNotCountInTheNext) {
  Flown flown;
  fly(flown);
  const auto& sent = flown.recorder.sent;
  const auto standby = std::find_if(sent.begin(), sent.end(), [](const auto& message) {
    return message.first == channel::kStationState;
  });
  ASSERT_NE(standby, sent.end());
  HeardFlight moving;
  const std::vector<std::uint8_t>* state = nullptr;
  for (const auto& [channel, bytes] : sent) {
    if (moving.output().command.length_rate != 0.0) break;
    if (channel == channel::kStationInput) moving.goOn();
    if (channel == channel::kStationState) state = &bytes;
    moving.take(channel, bytes);
  }
  ASSERT_NE(moving.output().command.length_rate, 0.0);
  ASSERT_NE(moving.output().supervision.mode, Mode::kStandby);

  HeardFlight in_its_cycle = moving;
  in_its_cycle.take(channel::kStationState, standby->second);
  EXPECT_EQ(in_its_cycle.output().supervision.mode, Mode::kStandby);
  EXPECT_NE(in_its_cycle.output().command.length_rate, 0.0) << "the new mode's";

  HeardFlight later = moving;
  later.goOn();
  later.take(channel::kStationState, *state);
  EXPECT_NE(later.output().command.length_rate, 0.0) << "the mode is the same, rates hold";
  later.take(channel::kStationState, standby->second);
  EXPECT_EQ(later.output().command.length_rate, 0.0) << "those of the mode before";
}

TEST(HeardFlight, BeginsWithBothProgramsAndIgnoresDamage) {
  HeardFlight heard;
  Flown flown;
  fly(flown);
  for (const auto& [channel, bytes] : flown.recorder.sent) {
    std::vector<std::uint8_t> cut(bytes.begin(), bytes.end() - 1);
    heard.take(channel, cut);
    heard.take("SOMETHING_ELSE", bytes);
  }
  EXPECT_FALSE(heard.next());
  EXPECT_FALSE(heard.begun());
  for (const auto& [channel, bytes] : flown.recorder.sent) {
    if (channel != channel::kSimTruth) heard.take(channel, bytes);
  }
  EXPECT_FALSE(heard.begun()) << "the machine has not been heard";
  for (const auto& [channel, bytes] : flown.recorder.sent) heard.take(channel, bytes);
  EXPECT_TRUE(heard.begun());
  EXPECT_GT(heard.truth().p_WD.norm(), 0.1);
}

}  // namespace
}  // namespace tautline::bench
