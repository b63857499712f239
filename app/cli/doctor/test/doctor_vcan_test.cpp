// What the doctor says of real CAN interfaces; needs a kernel that has SocketCAN (./run vcan).

#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/cli/doctor/station_checks.h"
#include "app/station/station_config.h"
#include "drivers/test/vcan.h"

namespace tautline::cli {
namespace {

using ::testing::HasSubstr;

Finding check(const std::string& interface) {
  StationConfig config;
  config.run_mode = RunMode::kHil;
  config.device = DeviceKind::kTautlineCan;
  config.can.interface = interface;
  Machine machine;
  machine.config = std::make_shared<const StationConfig>(config);
  return checkCan(machine);
}

TEST(DoctorVcan, MissingDownAndUp) {
  const std::string name = tautline::testing::vcanName();
  if (const std::string missing = tautline::testing::vcanMissing(name); !missing.empty())
    GTEST_SKIP() << missing;
  const tautline::testing::Vcan bus("doctor0");
  const Finding none = check(bus.name());
  EXPECT_EQ(none.status, FindingStatus::kProblem);
  EXPECT_THAT(none.measured, HasSubstr("no such interface"));
  EXPECT_THAT(none.remedy, HasSubstr("ip -brief link show type can"));
  ASSERT_EQ(bus.create(), 0);
  const Finding down = check(bus.name());
  EXPECT_EQ(down.status, FindingStatus::kProblem);
  EXPECT_THAT(down.measured, HasSubstr("is down"));
  EXPECT_THAT(down.remedy, HasSubstr("sudo ip link set doctor0 up"));
  ASSERT_EQ(bus.setUp(true), 0);
  const Finding up = check(bus.name());
  EXPECT_EQ(up.status, FindingStatus::kOk);
  EXPECT_EQ(up.measured, "doctor0 is up, virtual (vcan)");
}

}  // namespace
}  // namespace tautline::cli
