#include "control/reel_dead_zone.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace tautline {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(10);

/// A reel that follows every rate outside the band and stands still inside.
double reelRate(double command, const ReelDeadZoneConfig& band) {
  return command > band.min_rate_mps && command < band.max_rate_mps ? 0.0 : command;
}

double averageRate(const ReelDeadZoneConfig& band, double rate, double seconds) {
  ReelDeadZone zone(band);
  const int n = static_cast<int>(seconds * 100.0);
  double paid_out = 0.0;
  for (int i = 0; i < n; ++i) paid_out += reelRate(zone.compensate(kStep, rate), band) * 0.01;
  return paid_out / seconds;
}

TEST(ReelDeadZone, PaysOutTheRightLengthOnAverageThroughTheDevicesBand) {
  const ReelDeadZoneConfig device;
  for (double rate = -0.8; rate <= 0.8; rate += 0.03) {
    EXPECT_NEAR(averageRate(device, rate, 60.0), rate, 0.003) << rate;
  }
  EXPECT_EQ(reelRate(-0.45, device), 0.0);  // without compensation it would stand still
}

TEST(ReelDeadZone, PaysOutTheRightLengthThroughABandAroundRest) {
  const ReelDeadZoneConfig band{.min_rate_mps = -0.1, .max_rate_mps = 0.05};
  for (const double rate : {-0.2, -0.09, -0.01, 0.004, 0.03, 0.07}) {
    EXPECT_NEAR(averageRate(band, rate, 60.0), rate, 0.001) << rate;
  }
  ReelDeadZone zone(band);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(zone.compensate(kStep, 0.0), 0.0);
}

TEST(ReelDeadZone, OwesNeverMoreThanADwellsWorth) {
  const ReelDeadZoneConfig device;
  ReelDeadZone zone(device);
  double owed = 0.0;
  for (int i = 0; i < 5000; ++i) {
    owed += (-0.4 - reelRate(zone.compensate(kStep, -0.4), device)) * 0.01;
    EXPECT_LT(std::abs(owed), 0.228 * 2.0 * device.dwell_s);
  }
}

TEST(ReelDeadZone, DwellsLongEnoughForTheReel) {
  const ReelDeadZoneConfig device;
  ReelDeadZone zone(device);
  double last = zone.compensate(kStep, -0.45);
  int dwelt = 0, shortest = 1000;
  for (int i = 0; i < 2000; ++i) {
    const double out = zone.compensate(kStep, -0.45);
    ++dwelt;
    if (out != last) {
      shortest = std::min(shortest, dwelt);
      dwelt = 0;
    }
    last = out;
  }
  EXPECT_GE(shortest, 20);
  EXPECT_LT(shortest, 1000);
}

TEST(ReelDeadZone, PassesEverythingWithoutABandAndNothingThatIsNotFinite) {
  ReelDeadZone none({.min_rate_mps = 0.0, .max_rate_mps = 0.0});
  for (const double rate : {-0.45, -1e-9, 0.0, 0.2}) EXPECT_EQ(none.compensate(kStep, rate), rate);
  ReelDeadZone zone{ReelDeadZoneConfig{}};
  EXPECT_EQ(zone.compensate(kStep, std::numeric_limits<double>::quiet_NaN()), 0.0);
  EXPECT_EQ(zone.compensate(kStep, std::numeric_limits<double>::infinity()), 0.0);
}

}  // namespace
}  // namespace tautline
