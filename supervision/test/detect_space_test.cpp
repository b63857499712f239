// Fence, batteries, link, machine and parked readings.

#include <cmath>

#include <gtest/gtest.h>

#include "supervision/detect/fence.h"
#include "supervision/detect/host_watch.h"
#include "supervision/detect/link_watch.h"
#include "supervision/detect/parked_check.h"
#include "supervision/detect/power_watch.h"

namespace tautline {
namespace {

using C = Condition;

TEST(Fence, EachSideOfIt) {
  FenceConfig config;
  config.max_length_m = 3.0;
  config.min_height_m = -0.5;
  config.max_height_m = 2.0;
  config.min_elevation_rad = -0.6;
  config.max_elevation_rad = 1.2;
  config.min_clearance_m = 0.4;
  config.keep_out.add({{1.0, 0.0, 1.0}, {2.0, 1.0, 2.0}});
  FenceObstacle triangle{.bottom_m = 0.0, .top_m = 1.0};
  for (const Eigen::Vector2d& corner : {Eigen::Vector2d(3.0, -2.0), {4.0, -2.0}, {3.0, -1.0}})
    triangle.footprint_zx_m.add(corner);
  config.obstacles.add(triangle);
  const Fence fence(config);
  const auto at = [&](double x, double y, double z, double length = 1.0, bool flying = true) {
    Findings out;
    fence.update({flying, length, {x, y, z}}, out);
    return out.raised;
  };
  EXPECT_TRUE(at(0.0, 0.5, 1.0).empty());
  EXPECT_EQ(at(0.0, 0.5, 1.0, 3.1), ConditionSet{C::kFenceLength});
  EXPECT_EQ(at(0.0, 2.1, 1.0), ConditionSet{C::kFenceAltitude});
  EXPECT_EQ(at(0.0, -0.6, 1.5), ConditionSet{C::kFenceAltitude});
  EXPECT_EQ(at(0.0, 1.0, 0.2), ConditionSet{C::kFenceElevation});
  EXPECT_EQ(at(0.0, -0.4, 0.2), ConditionSet{C::kFenceElevation});
  EXPECT_TRUE(at(0.0, -0.4, 0.2, 1.0, false).empty()) << "parked beside the reel";
  EXPECT_EQ(at(1.5, 0.5, 1.5), ConditionSet{C::kFenceKeepOut});
  EXPECT_EQ(at(1.5, 0.5, 1.5, 1.0, false), ConditionSet{C::kFenceKeepOut});
  EXPECT_EQ(at(-1.5, 0.5, 2.7), ConditionSet{C::kFenceClearance});
  EXPECT_TRUE(at(-1.5, 0.5, 2.5).empty());
  EXPECT_EQ(at(-1.5, 1.3, 3.2), ConditionSet{C::kFenceClearance}) << "above it";
  EXPECT_TRUE(at(-1.5, 1.5, 3.2).empty());
}

TEST(Fence, FullListsAreBoundedWork) {
  FenceConfig config;
  FenceObstacle round{.bottom_m = 0.0, .top_m = 1.0};
  for (int i = 0; i < 32; ++i)
    round.footprint_zx_m.add({std::cos(0.19634954 * i), std::sin(0.19634954 * i)});
  while (config.obstacles.add(round)) {
  }
  EXPECT_EQ(config.obstacles.all().size(), kMaxFenceObstacles);
  EXPECT_NEAR(clearance({0.0, 0.5, 3.0}, config.obstacles), 2.0, 1e-6);
  EXPECT_NEAR(clearance({0.0, 0.5, 0.0}, config.obstacles), -0.5, 1e-6) << "inside";
}

TEST(PowerWatch, ThresholdsAndDevicesWithoutASensor) {
  const PowerWatch watch{PowerConfig{}};
  const auto at = [&](std::optional<double> battery, std::optional<double> backup) {
    Findings out;
    watch.update(battery, backup, out);
    return out.raised;
  };
  EXPECT_TRUE(at(12.0, 4.0).empty());
  EXPECT_EQ(at(11.0, 4.0), ConditionSet{C::kBatteryLow});
  EXPECT_EQ(at(10.5, {}), (ConditionSet{C::kBatteryLow, C::kBatteryCritical}));
  EXPECT_EQ(at(12.0, 3.4), ConditionSet{C::kBackupBatteryLow});
  EXPECT_TRUE(at({}, {}).empty());
}

TEST(LinkWatch, TooManyBadMessagesAndBackAgain) {
  LinkWatch watch{LinkWatchConfig{}};
  std::uint32_t good = 0;
  std::uint32_t bad = 0;
  Time now{};
  const auto run = [&](double seconds, std::uint32_t good_ones, std::uint32_t bad_ones) {
    Findings out;
    for (const Time end = now + fromSeconds(seconds); now < end;
         now += std::chrono::milliseconds(100)) {
      out = {};
      watch.update(now, good += good_ones, bad += bad_ones, out);
    }
    return out.raised.has(C::kCrcRate);
  };
  EXPECT_FALSE(run(10.0, 10, 1));
  EXPECT_TRUE(run(4.1, 10, 2));
  EXPECT_FALSE(run(4.1, 10, 0));
  EXPECT_FALSE(run(10.0, 0, 0)) << "silence is not for this one";
}

/// A machine on which all is well.
struct Host {
  HostWatchConfig config;
  HostFacts facts{.run_mode = RunMode::kReal,
                  .device = DeviceReality::kReal,
                  .real_time = true,
                  .clock_synchronized = true,
                  .recorder = RecorderStatus{{}, true, 2'000'000'000, 1'000'000'000}};
  Time now{};

  template <class Each>
  ConditionSet run(double seconds, const Each& each) {
    HostWatch watch(config);
    ConditionSet seen;
    for (const Time end = now + fromSeconds(seconds); now < end;
         now += std::chrono::milliseconds(10)) {
      if (facts.recorder) facts.recorder->heard = now;
      each();
      Findings out;
      watch.update(now, true, facts, out);
      seen = seen | out.raised;
    }
    return seen;
  }
  ConditionSet run(double seconds = 5.0) {
    return run(seconds, [] {});
  }
};

TEST(HostWatch, AGoodMachineRaisesNothing) { EXPECT_TRUE(Host{}.run().empty()); }

TEST(HostWatch, WhatIsMissingForARealFlight) {
  Host bare;
  bare.facts.recorder.reset();
  bare.facts.real_time = false;
  bare.facts.device = DeviceReality::kEmulated;
  EXPECT_EQ(bare.run(), (ConditionSet{C::kLogOff, C::kRealTimeMissing, C::kSimMismatch}));
  bare.facts.run_mode = RunMode::kHil;
  EXPECT_TRUE(bare.run().empty()) << "a bench needs neither";
  bare.facts.device = DeviceReality::kReal;
  EXPECT_EQ(bare.run(), ConditionSet{C::kSimMismatch});
  bare.facts.device = DeviceReality::kUnknown;
  bare.config.log = Required::kAlways;
  EXPECT_EQ(bare.run(), ConditionSet{C::kLogOff});
}

TEST(HostWatch, ARecorderThatStopsOrFallsSilent) {
  Host host;
  host.facts.recorder->recording = false;
  EXPECT_EQ(host.run(), ConditionSet{C::kLogOff});
  host.facts.recorder->recording = true;
  const Time last = host.now;
  EXPECT_TRUE(host.run(2.9, [&] { host.facts.recorder->heard = last; }).empty());
  EXPECT_EQ(host.run(0.5, [&] { host.facts.recorder->heard = last; }), ConditionSet{C::kLogOff});
  host.facts.recorder->disk_free = 900'000'000;
  EXPECT_EQ(host.run(), ConditionSet{C::kDiskLow});
}

TEST(HostWatch, Clocks) {
  Host host;
  int cycle = 0;
  EXPECT_EQ(host.run(1.0,
                     [&] {
                       if (++cycle == 50) host.facts.unix_offset += std::chrono::seconds(2);
                     }),
            ConditionSet{C::kClockJump});
  cycle = 0;
  EXPECT_EQ(host.run(1.0,
                     [&] {
                       if (++cycle == 50) host.now += std::chrono::milliseconds(600);
                     }),
            ConditionSet{C::kClockJump});
  cycle = 0;
  EXPECT_TRUE(
      host.run(5.0, [&] { host.facts.unix_offset += std::chrono::microseconds(5); }).empty())
      << "an adjusted clock does not jump";
  host.facts.clock_synchronized = false;
  EXPECT_TRUE(host.run().empty()) << "not asked for";
  host.config.synchronized_clock = Required::kReal;
  EXPECT_EQ(host.run(), ConditionSet{C::kClockJump});
}

TEST(HostWatch, LateAllTheTimeAndLateOnce) {
  Host host;
  int cycle = 0;
  EXPECT_TRUE(host.run(5.0,
                       [&] {
                         host.facts.lateness =
                             ++cycle == 100 ? std::chrono::milliseconds(50) : Duration::zero();
                       })
                  .empty());
  EXPECT_EQ(host.run(5.0, [&] { host.facts.lateness = std::chrono::milliseconds(8); }),
            ConditionSet{C::kLoopJitter});
}

TEST(ParkedCheck, TheReadingsAreThoseOfHome) {
  const Eigen::Vector3d home(0.3, -0.2, 0.9);
  const double L = std::sqrt(0.3 * 0.3 + 0.2 * 0.2 + 0.9 * 0.9);
  const double phi = std::atan2(0.3, 0.9);
  const auto at = [&](std::optional<double> length, std::optional<double> azimuth) {
    ParkedCheck check(ParkedCheckConfig{}, home);
    Findings out;
    check.update(Time{}, length, azimuth, out);
    return out.raised;
  };
  EXPECT_TRUE(at(L + 0.1, phi - 0.1 + 2.0 * 3.14159265358979).empty());
  EXPECT_EQ(at(1.42 * L, phi), ConditionSet{C::kLengthUncalibrated});
  EXPECT_EQ(at(L, phi + 1.57), ConditionSet{C::kAzimuthUncalibrated});
  EXPECT_TRUE(at({}, {}).empty());
  ParkedCheck below(ParkedCheckConfig{}, {0.1, -1.0, 0.1});
  Findings out;
  below.update(Time{}, {}, 3.0, out);
  EXPECT_TRUE(out.raised.empty()) << "under the reel azimuth means nothing";
}

TEST(ParkedCheck, ASwayingTetherIsNoWrongAzimuth) {
  ParkedCheck check(ParkedCheckConfig{}, {0.0, -0.2, 0.9});
  for (int i = 0; i < 500; ++i) {
    Findings out;
    check.update(Time{} + std::chrono::milliseconds(10 * i), {}, 0.8 * std::sin(0.3 * i), out);
    EXPECT_TRUE(out.raised.empty()) << "cycle " << i;
  }
}

}  // namespace
}  // namespace tautline
