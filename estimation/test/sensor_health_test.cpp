#include "estimation/sensor_health.h"

#include <limits>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

namespace tautline {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Streams at one rate, seen by a 100 Hz loop.
class Bench {
 public:
  explicit Bench(double rate_hz) : interval_(fromSeconds(1.0 / rate_hz)) {
    frame_.vehicle.value.phase = VehiclePhase::kFlying;
  }

  SensorFrame& frame() { return frame_; }
  VehicleCommand& command() { return command_; }
  bool sending{true};
  double length{1.0};

  SensorHealth run(double seconds) {
    SensorHealth health;
    for (const Time end = now_ + fromSeconds(seconds); now_ < end; now_ += fromSeconds(0.01)) {
      if (sending && now_ >= next_) {
        next_ = now_ + interval_;
        send(frame_.reel);
        send(frame_.angles);
        send(frame_.attitude);
        send(frame_.vehicle);
        frame_.reel.value.length = length;
      }
      health = monitor_.update(now_, frame_, command_);
    }
    return health;
  }

 private:
  template <class T>
  void send(Sample<T>& sample) {
    sample.time = now_;
    sample.valid = true;
    ++sample.sequence;
  }

  SensorMonitor monitor_{SensorHealthConfig{}};
  Duration interval_;
  Time now_{};
  Time next_{};
  SensorFrame frame_;
  VehicleCommand command_;
};

TEST(SensorHealth, EverythingIsMissingAtFirst) {
  SensorMonitor monitor{SensorHealthConfig{}};
  const SensorHealth health = monitor.update(Time{}, SensorFrame{}, VehicleCommand{});
  EXPECT_EQ(health.bits(), 0x1111u);
}

TEST(SensorHealth, StalenessFollowsEachStreamsOwnPeriod) {
  const struct {
    double rate, still_good, stale;
  } table[] = {{100, 0.4, 0.6}, {10, 0.4, 0.6}, {1, 1.9, 3.2}};
  for (const auto& row : table) {
    Bench bench(row.rate);
    EXPECT_EQ(bench.run(40.0).bits(), 0u) << row.rate;
    bench.sending = false;
    EXPECT_EQ(bench.run(row.still_good).bits(), 0u) << row.rate;
    EXPECT_EQ(bench.run(row.stale - row.still_good + 0.1).bits(), 0x2222u) << row.rate;
    bench.sending = true;
    EXPECT_EQ(bench.run(0.1).bits(), 0u) << row.rate;
  }
}

TEST(SensorHealth, AnOutageDoesNotTeachALongerPeriod) {
  Bench bench(10);
  bench.run(20.0);
  bench.sending = false;
  bench.run(30.0);
  bench.sending = true;
  const SensorHealth health = bench.run(1.0);
  EXPECT_LT(health[SensorStream::kReel].period, 0.13);
}

TEST(SensorHealth, ASlowerStreamIsLearned) {
  Bench fast(10);
  EXPECT_NEAR(fast.run(20.0)[SensorStream::kAngles].period, 0.1, 0.005);
}

TEST(SensorHealth, ImplausibleReadingsAreOutOfRange) {
  Bench bench(10);
  bench.run(1.0);
  bench.length = kNan;
  EXPECT_TRUE(bench.run(0.3)[SensorStream::kReel].has(SensorFault::kRange));
  bench.length = -0.5;
  EXPECT_TRUE(bench.run(0.3)[SensorStream::kReel].has(SensorFault::kRange));
  bench.length = 1e9;
  EXPECT_TRUE(bench.run(0.3)[SensorStream::kReel].has(SensorFault::kRange));
  bench.length = 2.0;
  EXPECT_FALSE(bench.run(0.3)[SensorStream::kReel].has(SensorFault::kRange));
  bench.frame().angles.value.theta = 1.7;
  EXPECT_TRUE(bench.run(0.3)[SensorStream::kAngles].has(SensorFault::kRange));
  bench.frame().angles.value = TetherAngles{.theta = 0.3, .phi = kNan, .altitude = {}};
  EXPECT_TRUE(bench.run(0.3)[SensorStream::kAngles].has(SensorFault::kRange));
  bench.frame().attitude.value.R_WB.coeffs().setZero();
  EXPECT_TRUE(bench.run(0.3)[SensorStream::kAttitude].has(SensorFault::kRange));
}

TEST(SensorHealth, AReadingThatDoesNotFollowItsCommandIsStuck) {
  Bench bench(10);
  bench.command().engaged = true;
  bench.command().length_rate = 0.2;
  EXPECT_FALSE(bench.run(1.0)[SensorStream::kReel].has(SensorFault::kStuck));
  EXPECT_TRUE(bench.run(1.0)[SensorStream::kReel].has(SensorFault::kStuck));
  bench.length += 0.003;
  EXPECT_FALSE(bench.run(0.2)[SensorStream::kReel].has(SensorFault::kStuck));

  bench.command() = VehicleCommand{};
  bench.command().engaged = true;
  bench.command().azimuth_rate = -0.1;
  EXPECT_TRUE(bench.run(2.0)[SensorStream::kAngles].has(SensorFault::kStuck));
  EXPECT_FALSE(bench.run(0.1)[SensorStream::kReel].has(SensorFault::kStuck));
}

TEST(SensorHealth, FindsStepsThatNothingCanMake) {
  SensorMonitor monitor{SensorHealthConfig{}};
  SensorFrame frame;
  frame.vehicle.value.phase = VehiclePhase::kFlying;
  frame.vehicle.sequence = 1;
  Time now{};
  const auto sample = [&](double length, double theta, double phi, double period) {
    now += fromSeconds(period);
    frame.reel.value.length = length;
    frame.angles.value.theta = theta;
    frame.angles.value.phi = phi;
    frame.reel.time = frame.angles.time = now;
    frame.reel.valid = frame.angles.valid = true;
    ++frame.reel.sequence;
    ++frame.angles.sequence;
    const SensorHealth& health = monitor.update(now, frame, {});
    return std::pair(health[SensorStream::kReel].jumped(), health[SensorStream::kAngles].jumped());
  };
  const std::pair none{false, false};
  for (int i = 0; i < 50; ++i) EXPECT_EQ(sample(1.0 + 0.06 * i, 0.02 * i, 0.02 * i, 0.1), none);
  const double L = 1.0 + 0.06 * 49;
  EXPECT_EQ(sample(L + 0.6, 0.98, 0.98, 0.1), std::pair(true, false));
  EXPECT_EQ(sample(L + 0.6, 0.98, 1.98, 0.1), std::pair(false, true));
  EXPECT_EQ(sample(L + 0.6, 0.98, 1.98, 0.1), none) << "it is over with the next sample";
  EXPECT_EQ(sample(L + 2.0, 0.98, 1.98, 2.0), none) << "an outage gives time to move";
  sample(L + 2.0, 1.5, 0.0, 2.0);
  EXPECT_EQ(sample(L + 2.0, 1.5, kPi, 0.1), none) << "at the pole azimuth may turn round";
  frame.vehicle.value.phase = VehiclePhase::kIdle;
  EXPECT_EQ(sample(L + 2.0, -1.0, 0.0, 0.1), none) << "a parked tether lies slack";
}

TEST(SensorHealth, HoldingStillIsNotStuck) {
  Bench bench(10);
  bench.command().engaged = true;
  EXPECT_EQ(bench.run(60.0).bits(), 0u);
  // Corrections that cancel each other ask for no lasting motion.
  for (int i = 0; i < 20; ++i) {
    bench.command().length_rate = i % 2 == 0 ? 0.2 : -0.2;
    EXPECT_EQ(bench.run(1.0).bits(), 0u);
  }
  // At the end of the vehicle's elevation range more of it has no effect.
  bench.frame().angles.value.theta = 1.56;
  bench.command().length_rate = 0.0;
  bench.command().elevation_rate = 0.2;
  EXPECT_EQ(bench.run(5.0).bits(), 0u);
}

}  // namespace
}  // namespace tautline
