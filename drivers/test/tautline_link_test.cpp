// What is wrong with a link, as the device tells it.

#include <string>

#include <gtest/gtest.h>

#include "drivers/test/tautline_rig.h"

namespace tautline {
namespace {

using bus::BusMode;
using testing::CanLink;
using testing::flying;
using testing::of;
using testing::Rig;
using testing::Sensors;
using testing::SerialLink;
using namespace std::chrono_literals;

class TautlineLinkTest : public testing::OverBothLinks {};

TEST_P(TautlineLinkTest, NamesASilentLinkAndItsReturn) {
  rig_.run(1500ms);
  EXPECT_EQ(rig_.frame.link.fault, LinkFault::kNone);
  rig_.silent = true;
  rig_.run(2100ms);
  EXPECT_EQ(rig_.frame.link.fault, LinkFault::kSilent);
  rig_.silent = false;
  rig_.run(20ms);
  EXPECT_EQ(rig_.frame.link.fault, LinkFault::kNone);
}

TEST_P(TautlineLinkTest, NamesASensorAtAnotherRate) {
  rig_.run(1500ms);
  for (const int more : {2, 0}) {  // the reel three times as often as agreed, then right again
    for (int i = 0; i < 350; ++i) {
      for (int k = 0; k < more; ++k) link_->send(rig_.sensors.next(bus::Reel{20000, 0, 0}, 0));
      rig_.run(10ms);
    }
    EXPECT_EQ(rig_.frame.link.fault, more > 0 ? LinkFault::kSensorRate : LinkFault::kNone);
  }
  EXPECT_TRUE(rig_.frame.reel.valid);
}

TEST_P(TautlineLinkTest, NamesASensorThatIsTooSlow) {
  rig_.silent = true;
  for (int i = 0; i < 350; ++i) {
    if (i % 3 == 0) rig_.sendSensorsNow();
    rig_.run(10ms);
  }
  EXPECT_EQ(rig_.frame.link.fault, LinkFault::kSensorRate);
}

TEST_P(TautlineLinkTest, NamesTwoSendersOfOneMessage) {
  Sensors second;
  second.skip(0, 7);
  for (int i = 0; i < 350; ++i) {
    link_->send(second.next(bus::Reel{1, 0, 0}, 0));
    rig_.run(10ms);
  }
  EXPECT_EQ(rig_.frame.link.fault, LinkFault::kUnreliable);
}

TEST_P(TautlineLinkTest, NamesAnotherStation) {
  link_->send(bus::encode(bus::Rates{}, 3));
  rig_.run(20ms);
  EXPECT_EQ(rig_.frame.link.fault, LinkFault::kAnotherStation);
  rig_.run(2100ms);
  EXPECT_EQ(rig_.frame.link.fault, LinkFault::kNone);
}

TEST_P(TautlineLinkTest, CountsWhatIsNotItsOwnWhereTheLinkDoes) {
  BusFrame frame;
  frame.id = 0x345;
  link_->send(frame);
  rig_.run(20ms);
  EXPECT_EQ(rig_.frame.link.frames_foreign, std::string(GetParam()) == "can" ? 1U : 0U);
}

TEST_P(TautlineLinkTest, NamesFramesOfAnotherProtocol) {
  rig_.silent = true;
  for (int i = 0; i < 250; ++i) {
    BusFrame frame;
    frame.id = static_cast<std::uint16_t>(0x300 + i % 5);
    frame.size = 8;
    link_->send(frame);
    rig_.run(10ms);
  }
  EXPECT_EQ(rig_.frame.link.fault, LinkFault::kOtherProtocol);
  EXPECT_FALSE(rig_.frame.reel.valid);
}

INSTANTIATE_TEST_SUITE_P(Links, TautlineLinkTest, ::testing::Values("can", "serial"),
                         testing::linkName);

TEST(TautlineDeviceOnCan, CountsFramesThatTheBusDoesNotTake) {
  CanLink link;
  Rig rig(link);
  rig.silent = true;
  for (int i = 0; i < 100000 && rig.frame.link.no_buffer == 0; ++i) {
    rig.device().read(rig.now, rig.frame);
    rig.device().write(rig.now += 10ms, flying());  // nobody reads the far end
  }
  EXPECT_GT(rig.frame.link.no_buffer, 0U);
  EXPECT_TRUE(rig.frame.link.connected);
}

TEST(TautlineDeviceOnSerial, NamesGarbageAndText) {
  SerialLink link;
  Rig rig(link);
  rig.silent = true;
  unsigned noise = 1;
  for (int i = 0; i < 250; ++i) {
    std::string bytes;
    for (int k = 0; k < 20; ++k) {
      noise = noise * 1664525U + 1013904223U;
      bytes.push_back(static_cast<char>(noise >> 24U));
    }
    link.pty.send(bytes);
    rig.run(10ms);
  }
  EXPECT_EQ(rig.frame.link.fault, LinkFault::kGarbage);
  EXPECT_GT(rig.frame.link.lines_bad, 0U);
  for (int i = 0; i < 250; ++i) {
    link.pty.send("!Pos 0.78,-0.52,1.20\r\n");
    rig.run(10ms);
  }
  EXPECT_EQ(rig.frame.link.fault, LinkFault::kOtherProtocol);
  rig.silent = false;
  rig.run(20ms);
  EXPECT_EQ(rig.frame.link.fault, LinkFault::kNone);
}

TEST(TautlineDeviceOnSerial, StartsAnewAfterReplugging) {
  SerialLink link;
  Rig rig(link);
  rig.run(100ms, flying());
  const bus::SerialFrame cut = bus::encodeSerial(rig.sensors.next(bus::Reel{1, 0, 0}, 0));
  link.pty.send({reinterpret_cast<const char*>(cut.buffer.data()), 5});
  rig.silent = true;
  rig.run(20ms, flying());
  link.pty.unplug();
  for (int i = 0; i < 50; ++i, rig.now += 10ms) rig.device().read(rig.now, rig.frame);
  EXPECT_FALSE(rig.frame.link.connected);
  EXPECT_EQ(rig.frame.link.fault, LinkFault::kPortMissing);
  link.pty.plug();
  rig.run(2s, flying());
  EXPECT_TRUE(rig.frame.link.connected);
  EXPECT_EQ(rig.frame.link.reconnects, 1U);
  rig.silent = false;
  rig.sensors.skip(0, 5);  // the device has counted on
  const std::uint32_t bad = rig.frame.link.lines_bad;
  const auto modes = of<bus::ModeCommand>(rig.run(100ms, flying()));
  EXPECT_EQ(rig.frame.link.lines_bad, bad);
  ASSERT_FALSE(modes.empty());
  EXPECT_EQ(modes.front().mode, BusMode::kArmed);
}

}  // namespace
}  // namespace tautline
