// CanSocket over a SOCK_SEQPACKET pair: all that needs no kernel with CAN. The rest, against a real
// interface: vcan_test.cpp.

#include "drivers/can_socket.h"

#include <linux/can/error.h>

#include <ctime>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/clock.h"
#include "drivers/test/can_pair.h"

namespace tautline {
namespace {

using testing::CanPair;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

constexpr std::array<std::uint16_t, 2> kIds{0x100, 0x110};

CanConfig named(const std::string& interface) {
  CanConfig config;
  config.interface = interface;
  return config;
}

BusFrame frameWith(std::uint16_t id, std::uint8_t first) {
  BusFrame frame;
  frame.id = id;
  frame.size = 3;
  frame.data = {first, 2, 3};
  return frame;
}

can_frame errorFrame(canid_t classes, std::uint8_t controller = 0) {
  can_frame frame{};
  frame.can_id = CAN_ERR_FLAG | classes;
  frame.can_dlc = CAN_ERR_DLC;
  frame.data[1] = controller;
  return frame;
}

class CanSocketTest : public ::testing::Test {
 protected:
  CanSocketTest() {
    const CanOpenResult result = socket_.adopt(pair_.release());
    EXPECT_TRUE(result) << result.reason;
    cycle();
  }
  void cycle(Duration step = 10ms) {
    now_ += step;
    socket_.poll(now_);
  }
  int readAll() {
    int count = 0;
    for (BusFrame frame; socket_.read(frame); ++count) last_ = frame;
    return count;
  }

  CanPair pair_;
  CanSocket socket_{named(""), kIds};
  BusFrame last_;
  Time now_{5s};
};

TEST_F(CanSocketTest, ReceivesWhatIsOursWholeAndCountsTheRest) {
  pair_.send(frameWith(0x100, 7));
  pair_.send(frameWith(0x101, 8));
  can_frame extended = testing::canFrame(frameWith(0x100, 9));
  extended.can_id |= CAN_EFF_FLAG;
  pair_.send(extended);
  can_frame request = testing::canFrame(frameWith(0x100, 9));
  request.can_id |= CAN_RTR_FLAG;
  pair_.send(request);
  EXPECT_EQ(readAll(), 1);
  EXPECT_EQ(last_.id, 0x100);
  EXPECT_EQ(last_.size, 3);
  EXPECT_EQ(last_.data[0], 7);
  EXPECT_EQ(socket_.frameCounters().frames_in, 1U);
  EXPECT_EQ(socket_.frameCounters().frames_foreign, 3U);
}

TEST_F(CanSocketTest, SendsFramesAsTheKernelHasThem) {
  EXPECT_TRUE(socket_.write(frameWith(0x200, 0xAB)));
  const auto got = pair_.receive();
  ASSERT_EQ(got.size(), 1U);
  EXPECT_EQ(got[0].can_id, 0x200U);
  EXPECT_EQ(got[0].can_dlc, 3);
  EXPECT_EQ(got[0].data[0], 0xAB);
}

TEST_F(CanSocketTest, TakesNoMoreThanItsBudgetInOneCycle) {
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(pair_.send(frameWith(0x100, 1)));
  EXPECT_EQ(readAll(), CanSocket::kFramesPerCycle);
  EXPECT_EQ(readAll(), 0);
  cycle();
  EXPECT_EQ(readAll(), 100 - CanSocket::kFramesPerCycle);
}

TEST_F(CanSocketTest, StampsAreOnTheLoopsClock) {
  now_ = monotonicNow();
  pair_.send(frameWith(0x100, 1));
  cycle(50ms);  // the loop's clock runs ahead: the frame is 50 ms old
  EXPECT_EQ(readAll(), 1);
  EXPECT_LE(last_.time, now_);
  EXPECT_GE(last_.time, now_ - 51ms);
}

TEST_F(CanSocketTest, AnAgeThatTheStepOfAClockMakesIsNotBelieved) {
  readAll();  // empty: what comes now is younger than this cycle
  pair_.send(frameWith(0x100, 1));
  const timespec pause{0, 60'000'000};  // to the stamp's clock 60 ms, to the loop's only 10
  nanosleep(&pause, nullptr);
  cycle(10ms);
  EXPECT_EQ(readAll(), 1);
  EXPECT_EQ(last_.time, now_);
}

TEST_F(CanSocketTest, AFrameThatWaitedKeepsItsAge) {
  readAll();
  pair_.send(frameWith(0x100, 1));
  const timespec pause{0, 60'000'000};
  nanosleep(&pause, nullptr);
  cycle(200ms);  // the loop stood still
  EXPECT_EQ(readAll(), 1);
  EXPECT_LE(last_.time, now_ - 60ms);
}

TEST(ArrivalOf, IsWithinWhatIsPossible) {
  const Time now{5s};
  const Time earliest = now - 30ms;
  EXPECT_EQ(arrivalOf(10ms, now, earliest), now - 10ms);
  EXPECT_EQ(arrivalOf(0ms, now, earliest), now);
  EXPECT_EQ(arrivalOf(30ms, now, earliest), earliest);
  EXPECT_EQ(arrivalOf(31ms, now, earliest), now) << "stepped forward";
  EXPECT_EQ(arrivalOf(1h, now, earliest), now);
  EXPECT_EQ(arrivalOf(-1ms, now, earliest), now) << "stepped back";
  EXPECT_EQ(arrivalOf(-1h, now, earliest), now);
}

TEST_F(CanSocketTest, AFullBufferIsCountedAndCostsOnlyTheNewFrame) {
  int sent = 0;
  while (socket_.write(frameWith(0x200, 1)) && sent < 100000) ++sent;
  EXPECT_LT(sent, 100000);
  EXPECT_EQ(socket_.frameCounters().no_buffer, 1U);
  EXPECT_GT(socket_.counters().bytes_dropped, 0U);
  EXPECT_TRUE(socket_.connected());
  EXPECT_EQ(pair_.receive().size(), static_cast<std::size_t>(sent));
  EXPECT_TRUE(socket_.write(frameWith(0x200, 2)));
}

TEST_F(CanSocketTest, ErrorFramesNameTheBusesState) {
  const auto faultAfter = [this](const can_frame& frame) {
    pair_.send(frame);
    EXPECT_EQ(readAll(), 0);
    return socket_.fault();
  };
  EXPECT_EQ(faultAfter(errorFrame(CAN_ERR_ACK)), LinkFault::kNoAcknowledge);
  EXPECT_EQ(faultAfter(errorFrame(CAN_ERR_PROT | CAN_ERR_BUSERROR)), LinkFault::kBusErrors);
  EXPECT_EQ(faultAfter(errorFrame(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE)), LinkFault::kNone);
  EXPECT_EQ(faultAfter(errorFrame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE)), LinkFault::kBusErrors);
  EXPECT_EQ(faultAfter(errorFrame(CAN_ERR_BUSOFF)), LinkFault::kBusOff);
  EXPECT_EQ(faultAfter(errorFrame(CAN_ERR_PROT)), LinkFault::kBusOff);
  EXPECT_EQ(faultAfter(errorFrame(CAN_ERR_RESTARTED)), LinkFault::kNone);
  EXPECT_EQ(socket_.frameCounters().bus_errors, 7U);
  EXPECT_EQ(socket_.frameCounters().bus_off, 1U);
}

TEST_F(CanSocketTest, BusErrorsFadeAndBusOffEndsWithTheFirstFrame) {
  pair_.send(errorFrame(CAN_ERR_ACK));
  readAll();
  cycle(900ms);
  EXPECT_EQ(socket_.fault(), LinkFault::kNoAcknowledge);
  cycle(200ms);
  EXPECT_EQ(socket_.fault(), LinkFault::kNone);
  pair_.send(errorFrame(CAN_ERR_BUSOFF));
  readAll();
  cycle(10s);
  EXPECT_EQ(socket_.fault(), LinkFault::kBusOff);
  pair_.send(frameWith(0x110, 1));
  readAll();
  EXPECT_EQ(socket_.fault(), LinkFault::kNone);
}

TEST_F(CanSocketTest, NoticesThatTheOtherEndIsGone) {
  pair_.send(frameWith(0x100, 1));
  pair_.hangUp();
  EXPECT_EQ(readAll(), 1);
  EXPECT_FALSE(socket_.connected());
  EXPECT_EQ(socket_.status(), CanStatus::kClosed);
  EXPECT_FALSE(socket_.write(frameWith(0x200, 1)));
  for (int i = 0; i < 1000; ++i) cycle();
  EXPECT_FALSE(socket_.connected());
}

TEST_F(CanSocketTest, NoticesItWhileWritingToo) {
  pair_.hangUp();
  EXPECT_FALSE(socket_.write(frameWith(0x200, 1)));
  EXPECT_FALSE(socket_.connected());
}

TEST_F(CanSocketTest, APacketThatIsNoFrameIsCounted) {
  ASSERT_EQ(::send(pair_.farEnd(), "abc", 3, 0), 3);
  EXPECT_EQ(readAll(), 0);
  EXPECT_EQ(socket_.frameCounters().frames_bad, 1U);
  pair_.send(frameWith(0x100, 1));
  EXPECT_EQ(readAll(), 1);
}

TEST(CanSocketOpen, NamesTheInterfaceAndTheRemedy) {
  CanSocket socket(named("tautline_no0"), kIds);
  const CanOpenResult result = socket.open();
  ASSERT_FALSE(result);
  EXPECT_THAT(result.reason, HasSubstr("tautline_no0: "));
  if (result.status == CanStatus::kNoCan) {
    EXPECT_THAT(result.reason, HasSubstr("modprobe can-raw"));
  } else {
    EXPECT_EQ(result.status, CanStatus::kNoSuchInterface);
    EXPECT_THAT(result.reason, HasSubstr("ip link set tautline_no0 up type can bitrate 500000"));
  }
  EXPECT_EQ(socket.fault(),
            result.status == CanStatus::kNoCan ? LinkFault::kNoCan : LinkFault::kInterfaceMissing);
}

TEST(CanSocketOpen, EveryReasonHasItsFault) {
  EXPECT_EQ(faultOf(CanStatus::kOpen), LinkFault::kNone);
  EXPECT_EQ(faultOf(CanStatus::kNoCan), LinkFault::kNoCan);
  EXPECT_EQ(faultOf(CanStatus::kNotCan), LinkFault::kNotCan);
  EXPECT_EQ(faultOf(CanStatus::kPermission), LinkFault::kCanPermission);
  EXPECT_EQ(faultOf(CanStatus::kSettings), LinkFault::kCanSettings);
  EXPECT_EQ(faultOf(CanStatus::kRealDevice), LinkFault::kRealDevice);
  EXPECT_EQ(faultOf(CanStatus::kFailed), LinkFault::kPortFailed);
}

TEST(CanSocketOpen, RefusesWhatIsNoDescriptor) {
  CanSocket socket(named("can0"), kIds);
  EXPECT_EQ(socket.adopt(-1).status, CanStatus::kFailed);
  EXPECT_FALSE(socket.connected());
}

}  // namespace
}  // namespace tautline
