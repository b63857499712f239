// The flight of bus_flight.h where there is no CAN: over a socket pair that keeps frames apart.

#include "app/bench/test/bus_flight.h"

#include "drivers/test/can_pair.h"

namespace tautline::bench {
namespace {

TEST(BusFlight, DeviceAndEmulatedMachineFlyOverASocketPair) {
  testing::CanPair pair;
  CanSocket socket(CanConfig{.interface = ""}, kTautlineIds);
  ASSERT_TRUE(socket.adopt(pair.release()));
  sim::CanLink link(::dup(pair.farEnd()));
  BusFlight(socket, link).fly();
}

}  // namespace
}  // namespace tautline::bench
