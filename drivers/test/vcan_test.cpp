// CanSocket against a real virtual CAN interface (environment TAUTLINE_VCAN, default vcan0). Needs
// a kernel with SocketCAN and, for interfaces that come and go, root; says loudly what is missing.

#include "drivers/test/vcan.h"

#include <linux/can/error.h>

#include <ctime>
#include <string>

#include <gtest/gtest.h>

#include "common/clock.h"
#include "drivers/can_socket.h"
#include "drivers/tautline_device.h"
#include "drivers/test/can_pair.h"

namespace tautline {
namespace {

using testing::RawCan;
using testing::Vcan;
using namespace std::chrono_literals;

can_frame frameWith(canid_t id, std::uint8_t first = 0) {
  can_frame frame{};
  frame.can_id = id;
  frame.can_dlc = 2;
  frame.data[0] = first;
  return frame;
}

BusFrame busFrame(std::uint16_t id) {
  BusFrame frame;
  frame.id = id;
  frame.size = 8;
  frame.data = {1, 2, 3, 4, 5, 6, 7, 8};
  return frame;
}

CanConfig configFor(const std::string& name) {
  CanConfig config;
  config.interface = name;
  config.virtual_only = true;  // and so the check for it runs as well
  return config;
}

int readAll(CanSocket& socket, BusFrame* last = nullptr) {
  int count = 0;
  for (BusFrame frame; socket.read(frame); ++count) {
    if (last != nullptr) *last = frame;
  }
  return count;
}

/// On the interface of the environment.
class VcanTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string name = testing::vcanName();
    if (const std::string missing = testing::vcanMissing(name); !missing.empty())
      GTEST_SKIP() << missing;
    socket_ = std::make_unique<CanSocket>(configFor(name), kTautlineIds);
    const CanOpenResult opened = socket_->open();
    ASSERT_TRUE(opened) << opened.reason;
    node_ = std::make_unique<RawCan>(name);
    socket_->poll(now());
  }
  static Time now() { return monotonicNow(); }

  std::unique_ptr<CanSocket> socket_;
  std::unique_ptr<RawCan> node_;
};

TEST_F(VcanTest, SendsAndReceives) {
  ASSERT_TRUE(socket_->write(busFrame(0x200)));
  can_frame got{};
  ASSERT_TRUE(node_->receive(got));
  EXPECT_EQ(got.can_id, 0x200U);
  EXPECT_EQ(got.can_dlc, 8);
  EXPECT_EQ(got.data[7], 8);
  ASSERT_TRUE(node_->send(frameWith(0x110, 0x42)));
  BusFrame frame;
  ASSERT_TRUE(socket_->read(frame));
  EXPECT_EQ(frame.id, 0x110);
  EXPECT_EQ(frame.size, 2);
  EXPECT_EQ(frame.data[0], 0x42);
  EXPECT_FALSE(socket_->read(frame)) << "its own frame must not come back";
}

TEST_F(VcanTest, WhatIsNotOursIsCountedAndNothingElse) {
  const std::array<canid_t, 4> others{0x101, 0x300, 0x100 | CAN_EFF_FLAG, 0x100 | CAN_RTR_FLAG};
  for (const canid_t id : others) ASSERT_TRUE(node_->send(frameWith(id)));
  for (const std::uint16_t id : kTautlineIds) ASSERT_TRUE(node_->send(frameWith(id)));
  EXPECT_EQ(readAll(*socket_), static_cast<int>(kTautlineIds.size()));
  EXPECT_EQ(socket_->frameCounters().frames_foreign, 0U) << "the link's own socket hears them";
  socket_->poll(now());
  EXPECT_EQ(socket_->frameCounters().frames_foreign, others.size());
}

TEST_F(VcanTest, AFloodOfOthersIsCountedAndCostsAFewFramesACycle) {
  constexpr unsigned kFlood = 5000;
  unsigned sent = 0;
  for (unsigned i = 0; i < kFlood; ++i) sent += node_->send(frameWith(0x321)) ? 1U : 0U;
  socket_->poll(now());
  EXPECT_LE(socket_->frameCounters().frames_foreign, CanSocket::kForeignPerCycle);
  ASSERT_TRUE(node_->send(frameWith(0x100)));
  EXPECT_EQ(readAll(*socket_), 1) << "they leave room for ours";
  for (int cycle = 0; cycle < 10; ++cycle) socket_->poll(now());
  ASSERT_TRUE(node_->send(frameWith(0x321)));  // carries the kernel's count
  socket_->poll(now());
  EXPECT_EQ(socket_->frameCounters().frames_foreign, sent + 1);
  EXPECT_EQ(socket_->frameCounters().frames_lost, 0U);
}

TEST_F(VcanTest, ABusThatSpeaksSomethingElseIsNamed) {
  TautlineDevice device(*socket_, TautlineConfig{}, "tautline-can");
  SensorFrame frame;
  Time t = now();
  for (int i = 0; i < 250; ++i, t += 10ms) {
    ASSERT_TRUE(node_->send(frameWith(0x321)));
    device.read(t, frame);
  }
  EXPECT_EQ(frame.link.fault, LinkFault::kOtherProtocol);
  EXPECT_EQ(frame.link.frames_foreign, 250U);
}

TEST_F(VcanTest, StampsAreTheKernels) {
  const Time before = now();
  ASSERT_TRUE(node_->send(frameWith(0x100)));
  const Time after = now();
  const timespec pause{0, 50'000'000};
  nanosleep(&pause, nullptr);
  socket_->poll(now());
  BusFrame frame;
  ASSERT_TRUE(socket_->read(frame));
  // When it arrived, not when it was read; the two clocks are read one after the other.
  EXPECT_GE(frame.time, before - 5ms);
  EXPECT_LE(frame.time, after + 20ms);
}

TEST_F(VcanTest, InjectedErrorFramesAreNamed) {
  const auto inject = [this](canid_t classes) {
    can_frame frame = frameWith(CAN_ERR_FLAG | classes);
    frame.can_dlc = CAN_ERR_DLC;
    EXPECT_TRUE(node_->send(frame));
    EXPECT_EQ(readAll(*socket_), 0);
    return socket_->fault();
  };
  EXPECT_EQ(inject(CAN_ERR_ACK), LinkFault::kNoAcknowledge);
  EXPECT_EQ(inject(CAN_ERR_PROT | CAN_ERR_BUSERROR), LinkFault::kBusErrors);
  EXPECT_EQ(inject(CAN_ERR_LOSTARB), LinkFault::kBusErrors) << "lost arbitration is not delivered";
  EXPECT_EQ(inject(CAN_ERR_BUSOFF), LinkFault::kBusOff);
  EXPECT_EQ(inject(CAN_ERR_RESTARTED), LinkFault::kNone);
  EXPECT_EQ(socket_->frameCounters().bus_errors, 4U);
  EXPECT_EQ(socket_->frameCounters().bus_off, 1U);
  EXPECT_TRUE(socket_->connected());
}

TEST_F(VcanTest, AFloodIsBoundedACycleAndEveryFrameIsAccountedFor) {
  constexpr int kFlood = 5000;
  int sent = 0;
  for (int i = 0; i < kFlood; ++i) sent += node_->send(frameWith(0x100)) ? 1 : 0;
  socket_->poll(now());
  EXPECT_EQ(readAll(*socket_), CanSocket::kFramesPerCycle);
  int got = CanSocket::kFramesPerCycle;
  for (int cycle = 0; cycle < kFlood; ++cycle) {
    socket_->poll(now());
    const int count = readAll(*socket_);
    if (count == 0) break;
    got += count;
  }
  ASSERT_TRUE(node_->send(frameWith(0x110)));  // carries the kernel's count of what it gave up
  socket_->poll(now());
  EXPECT_EQ(readAll(*socket_), 1);
  EXPECT_GT(socket_->frameCounters().frames_lost, 0U);
  EXPECT_EQ(static_cast<unsigned>(got) + socket_->frameCounters().frames_lost,
            static_cast<unsigned>(sent));
}

TEST_F(VcanTest, WritingAFloodNeitherBlocksNorLosesTheLink) {
  constexpr unsigned kFlood = 50000;
  unsigned taken = 0;
  for (unsigned i = 0; i < kFlood; ++i) taken += socket_->write(busFrame(0x200)) ? 1U : 0U;
  EXPECT_EQ(taken + socket_->frameCounters().no_buffer, kFlood);
  EXPECT_TRUE(socket_->connected());
}

/// On an interface of its own, which it may switch off and delete.
class OwnVcanTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const int fd = ::socket(AF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
    if (fd < 0) GTEST_SKIP() << testing::vcanMissing(link_.name());
    ::close(fd);
    if (const int error = link_.create(); error != 0)
      GTEST_SKIP() << "SKIPPED: cannot make an interface of the test's own ("
                   << std::strerror(error) << "); run as root in a kernel with vcan";
  }
  /// Cycles of the loop until the socket is connected or not, at most `limit` of virtual time.
  bool until(bool connected, Duration limit = 5s) {
    for (const Time end = now_ + limit; now_ < end && socket_.connected() != connected;
         now_ += 10ms) {
      socket_.poll(now_);
      readAll(socket_);
    }
    return socket_.connected() == connected;
  }

  Vcan link_{"tautvcan9"};
  CanSocket socket_{configFor("tautvcan9"), kTautlineIds};
  Time now_{5s};
};

TEST_F(OwnVcanTest, AnInterfaceThatIsDownIsNamedAndTakenUpWhenItIsUp) {
  const CanOpenResult opened = socket_.open();
  EXPECT_EQ(opened.status, CanStatus::kDown);
  EXPECT_NE(opened.reason.find("ip link set tautvcan9 up"), std::string::npos) << opened.reason;
  EXPECT_EQ(socket_.fault(), LinkFault::kInterfaceDown);
  ASSERT_EQ(link_.setUp(true), 0);
  EXPECT_TRUE(until(true));
  EXPECT_EQ(socket_.counters().reconnects, 0U) << "it had never been connected";
}

TEST_F(OwnVcanTest, DownAndUpAgain) {
  ASSERT_EQ(link_.setUp(true), 0);
  ASSERT_TRUE(socket_.open());
  ASSERT_EQ(link_.setUp(false), 0);
  EXPECT_TRUE(until(false));
  EXPECT_EQ(socket_.status(), CanStatus::kDown);
  EXPECT_FALSE(socket_.write(busFrame(0x200)));
  EXPECT_FALSE(until(true, 5s)) << "it is still down";
  ASSERT_EQ(link_.setUp(true), 0);
  EXPECT_TRUE(until(true));
  EXPECT_EQ(socket_.counters().reconnects, 1U);
  const RawCan node(link_.name());
  ASSERT_TRUE(node.send(frameWith(0x100)));
  socket_.poll(now_);
  EXPECT_EQ(readAll(socket_), 1);
}

TEST_F(OwnVcanTest, DownIsNoticedWhileWritingToo) {
  ASSERT_EQ(link_.setUp(true), 0);
  ASSERT_TRUE(socket_.open());
  ASSERT_EQ(link_.setUp(false), 0);
  EXPECT_FALSE(socket_.write(busFrame(0x200)));
  EXPECT_FALSE(socket_.connected());
}

TEST_F(OwnVcanTest, DeletedAndMadeAnew) {
  ASSERT_EQ(link_.setUp(true), 0);
  ASSERT_TRUE(socket_.open());
  ASSERT_EQ(link_.remove(), 0);
  EXPECT_TRUE(until(false));
  EXPECT_FALSE(until(true, 3s));
  EXPECT_EQ(socket_.status(), CanStatus::kNoSuchInterface);
  EXPECT_EQ(socket_.fault(), LinkFault::kInterfaceMissing);
  ASSERT_EQ(link_.create(), 0);
  ASSERT_EQ(link_.setUp(true), 0);
  EXPECT_TRUE(until(true));
  EXPECT_EQ(socket_.counters().reconnects, 1U);
  const RawCan node(link_.name());
  ASSERT_TRUE(node.send(frameWith(0x100)));
  socket_.poll(now_);
  EXPECT_EQ(readAll(socket_), 1);
}

TEST_F(OwnVcanTest, DeletedIsNoticedWhileWritingToo) {
  ASSERT_EQ(link_.setUp(true), 0);
  ASSERT_TRUE(socket_.open());
  ASSERT_EQ(link_.remove(), 0);
  EXPECT_FALSE(socket_.write(busFrame(0x200)));
  EXPECT_FALSE(socket_.connected());
}

TEST(CanKinds, AnInterfaceOfAnotherKindIsNoCan) {
  if (const int fd = ::socket(AF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW); fd >= 0) {
    ::close(fd);
  } else {
    GTEST_SKIP() << testing::vcanMissing("lo");
  }
  CanSocket socket(configFor("lo"), kTautlineIds);
  EXPECT_EQ(socket.open().status, CanStatus::kNotCan);
  EXPECT_EQ(socket.fault(), LinkFault::kNotCan);
}

}  // namespace
}  // namespace tautline
