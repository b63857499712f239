// The flight of bus_flight.h over a real CAN interface; see drivers/test/vcan_test.cpp.

#include "app/bench/test/bus_flight.h"
#include "common/error.h"
#include "drivers/test/vcan.h"

namespace tautline::bench {
namespace {

TEST(VcanFlight, DeviceAndEmulatedMachineFlyOverARealInterface) {
  const std::string name = testing::vcanName();
  if (const std::string missing = testing::vcanMissing(name); !missing.empty())
    GTEST_SKIP() << missing;
  CanConfig config;
  config.interface = name;
  config.virtual_only = true;
  CanSocket socket(config, kTautlineIds);
  const CanOpenResult opened = socket.open();
  ASSERT_TRUE(opened) << opened.reason;
  sim::CanLink link(name);
  BusFlight(socket, link).fly();
}

TEST(VcanFlight, TheSimulatorNamesAnInterfaceThatIsNotThere) {
  try {
    const sim::CanLink link("tautline_no0");
    FAIL() << "opened an interface that is not there";
  } catch (const InputError& e) {
    EXPECT_FALSE(e.problem().remedy.empty()) << e.what();
  }
}

}  // namespace
}  // namespace tautline::bench
