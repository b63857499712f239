// The loop with a device that stalls: what the supervisor and the service manager get to know.

#include "app/station/real_time_loop.h"

#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/station/test/notify_socket.h"
#include "common/clock.h"
#include "common/multicast.h"
#include "lcmtypes/channels.h"

namespace tautline {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::StartsWith;

constexpr const char* kUrl = "udpm://239.255.76.67:7684?ttl=0";
constexpr Duration kPeriod = milliseconds(10);

/// Calls back in every cycle and says nothing.
class ScriptedDevice final : public Device {
 public:
  explicit ScriptedDevice(std::function<void(int cycle)> script) : script_(std::move(script)) {}
  void read(Time, SensorFrame&) noexcept override { script_(cycle_++); }
  void write(Time, const VehicleCommand&) noexcept override { ++written; }
  void shutdown(Time) noexcept override { was_shut_down = true; }
  [[nodiscard]] LinkStatus status() const noexcept override { return {}; }
  [[nodiscard]] const char* name() const noexcept override { return "scripted"; }

  int written{0};
  bool was_shut_down{false};

 private:
  std::function<void(int)> script_;
  int cycle_{0};
};

/// What each cycle saw and said.
class CycleSink final : public TelemetrySink {
 public:
  bool publish(const char* name, std::int64_t,
               std::span<const std::uint8_t> bytes) noexcept override {
    const int size = static_cast<int>(bytes.size());
    if (std::strcmp(name, channel::kStationInput) == 0) {
      tautline::station_input_t m;
      EXPECT_GT(m.decode(bytes.data(), 0, size), 0);
      missed.push_back(m.loop_overruns);
    } else if (std::strcmp(name, channel::kStationState) == 0) {
      tautline::station_state_t m;
      EXPECT_GT(m.decode(bytes.data(), 0, size), 0);
      conditions.push_back(ConditionSet::fromBits(static_cast<std::uint64_t>(m.conditions)));
    }
    return true;
  }
  std::vector<std::int32_t> missed;
  std::vector<ConditionSet> conditions;
};

void waitFor(Duration d) { sleepUntil(monotonicNow() + d); }

class RealTimeLoopTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!hasMulticastRoute(kUrl))
      GTEST_SKIP() << "SKIPPED: no multicast route here; ./run test makes one";
    lcm_ = std::make_unique<LcmLink>(kUrl);
  }

  LoopStatistics::Snapshot run(ScriptedDevice& device, ServiceNotifier* service = nullptr) {
    const auto station = std::make_unique<Station>(config_);
    Telemetry telemetry(sink_, RunMode::kSim, Duration::zero(), Duration(1));
    return realTimeLoop({device, *lcm_, *station, telemetry, nullptr, service}, kPeriod, stop_);
  }

  CoreConfig config_;
  CycleSink sink_;
  std::unique_ptr<LcmLink> lcm_;
  volatile std::sig_atomic_t stop_{0};
};

TEST_F(RealTimeLoopTest, OneStalledCycleIsSeenByTheSupervisor) {
  constexpr int kStalled = 10;
  ScriptedDevice device([this](int cycle) {
    if (cycle == kStalled) waitFor(kPeriod * (config_.overruns_in_a_row + 1));
    if (cycle == 2 * kStalled) stop_ = 1;
  });
  const auto summary = run(device);
  ASSERT_EQ(sink_.missed.size(), 2U * kStalled + 1);
  ASSERT_EQ(sink_.conditions.size(), sink_.missed.size());
  EXPECT_GE(sink_.missed[kStalled + 1], config_.overruns_in_a_row);
  EXPECT_TRUE(sink_.conditions[kStalled + 1].has(Condition::kOverruns));
  // Whatever this machine did to the other cycles: the condition begins with what the loop counted,
  // and stays for its recovery time.
  bool missed_before = false;
  for (std::size_t i = 0; i < sink_.missed.size(); ++i) {
    missed_before = missed_before || sink_.missed[i] >= config_.overruns_in_a_row;
    EXPECT_EQ(sink_.conditions[i].has(Condition::kOverruns), missed_before) << "cycle " << i;
  }
  EXPECT_GE(summary.skipped_periods, config_.overruns_in_a_row);
  EXPECT_EQ(device.written, 2 * kStalled + 1);
  EXPECT_TRUE(device.was_shut_down);
}

TEST_F(RealTimeLoopTest, ManyShortOverrunsAreSeenAsWell) {
  ScriptedDevice device([this](int cycle) {
    if (cycle == 20) stop_ = 1;
    waitFor(kPeriod + milliseconds(1));
  });
  run(device);
  EXPECT_EQ(sink_.missed.front(), 0);
  EXPECT_TRUE(sink_.conditions.back().has(Condition::kOverruns));
}

TEST_F(RealTimeLoopTest, ALoopThatIsAlwaysLateNeverFeedsTheWatchdog) {
  testing::NotifySocket manager(::testing::TempDir() + "tautline_loop_" + std::to_string(getpid()));
  ServiceNotifier service({.socket = manager.name(), .watchdog = milliseconds(40)});
  ScriptedDevice late([this](int cycle) {
    if (cycle == 10) stop_ = 1;
    waitFor(kPeriod + milliseconds(1));
  });
  run(late, &service);
  EXPECT_THAT(manager.take(), ElementsAre(StartsWith("STOPPING=1")));
}

TEST_F(RealTimeLoopTest, ALoopInTimeIsReadyThenFeedsThenStops) {
  testing::NotifySocket manager(::testing::TempDir() + "tautline_loop_" + std::to_string(getpid()));
  ServiceNotifier service({.socket = manager.name(), .watchdog = milliseconds(40)});
  std::vector<std::string> messages;
  const auto listen = [&] {
    for (std::string& m : manager.take()) messages.push_back(std::move(m));
  };
  std::size_t before_the_first_command = 1;
  ScriptedDevice device([&](int cycle) {
    listen();
    if (cycle == 0) before_the_first_command = messages.size();
    if (cycle == 20) stop_ = 1;
  });
  run(device, &service);
  listen();
  EXPECT_EQ(before_the_first_command, 0U);
  ASSERT_GE(messages.size(), 3U);
  EXPECT_THAT(messages.front(), StartsWith("READY=1"));
  EXPECT_EQ(messages[1], "WATCHDOG=1");
  EXPECT_THAT(messages.back(), StartsWith("STOPPING=1"));
}

}  // namespace
}  // namespace tautline
