// The station's LCM link over the real network stack of this machine (loopback).

#include "app/station/lcm_link.h"

#include <array>
#include <memory>
#include <optional>
#include <thread>

#include <gtest/gtest.h>
#include <tautline/heartbeat_t.hpp>
#include <tautline/operator_command_t.hpp>

#include "app/station/input_message.h"
#include "common/clock.h"
#include "common/multicast.h"
#include "common/testing/malloc_guard.h"
#include "lcmtypes/channels.h"

namespace tautline {
namespace {

constexpr const char* kUrl = "udpm://239.255.76.67:7683?ttl=0";

class LcmLinkTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!hasMulticastRoute(kUrl))
      GTEST_SKIP() << "SKIPPED: no multicast route here; ./run test makes one";
    link_ = std::make_unique<LcmLink>(kUrl);
    client_ = std::make_unique<lcm::LCM>(kUrl);
    ASSERT_TRUE(client_->good());
  }

  /// Sends heartbeat and command until the command arrives: a datagram may be lost, and the link's
  /// reader thread needs a moment.
  std::optional<OperatorCommand> exchange(tautline::operator_command_t command) {
    for (int i = 0; i < 200; ++i) {
      sendFresh(command);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      if (const StepInput in = poll(); in.command) return in.command;
    }
    return std::nullopt;
  }
  void sendFresh(tautline::operator_command_t& command) {
    tautline::heartbeat_t beat{};
    command.utime = beat.utime = toMicroseconds(monotonicNow());
    beat.session = command.session;
    command.sequence = beat.sequence = ++sequence_;
    client_->publish(channel::kHeartbeat, &beat);
    client_->publish(channel::kOperatorCommand, &command);
  }
  StepInput poll() {
    StepInput in;
    link_->poll(monotonicNow(), -77);
    link_->inbox().fill(in);
    return in;
  }
  std::int64_t refused(AckResult result) const {
    return link_->inbox().counts()[static_cast<std::size_t>(result)];
  }

  std::int64_t sequence_{0};
  std::unique_ptr<LcmLink> link_;
  std::unique_ptr<lcm::LCM> client_;
};

TEST_F(LcmLinkTest, DeliversACommandAsItWasSent) {
  tautline::operator_command_t command{};
  command.session = -77;
  command.verb = static_cast<std::int8_t>(Request::kNavigate);
  command.mission_hash = 0x7fedcba987654321;
  put(command.name, operatorName("anna@bench"));
  const auto got = exchange(command);
  ASSERT_TRUE(got);
  EXPECT_EQ(got->session, -77);
  EXPECT_LE(got->sequence, sequence_);
  EXPECT_EQ(got->request, Request::kNavigate);
  EXPECT_EQ(got->mission_hash, 0x7fedcba987654321U);
  EXPECT_STREQ(got->name.data(), "anna@bench");
}

TEST_F(LcmLinkTest, ShortForeignAndLongBytesAreCountedAndNothingElse) {
  const std::array<std::uint8_t, 400> junk{1, 2, 3};
  const char* const channels[] = {channel::kOperatorCommand, channel::kMissionChunk,
                                  channel::kHeartbeat, channel::kTeleop};
  for (const char* name : channels)
    for (const unsigned size : {0U, 3U, 8U, 39U, 400U}) client_->publish(name, junk.data(), size);
  for (int i = 0; i < 40; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const StepInput in = poll();
    EXPECT_FALSE(in.command || in.heartbeat || in.sticks || in.turned_away);
    EXPECT_EQ(in.chunk, nullptr);
  }
  EXPECT_GT(refused(AckResult::kMalformed), 0);
}

TEST_F(LcmLinkTest, OfManyInACycleTheEmergencyStopIsTaken) {
  tautline::operator_command_t command{};
  command.session = -77;
  ASSERT_TRUE(exchange(command));
  for (const Request request : {Request::kArm, Request::kHold, Request::kEstop, Request::kLand}) {
    command.verb = static_cast<std::int8_t>(request);
    sendFresh(command);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const StepInput in = poll();
  ASSERT_TRUE(in.command);
  EXPECT_EQ(in.command->request, Request::kEstop);
}

TEST_F(LcmLinkTest, SendsAndReceivesWithoutTheHeap) {
  if (!testing::MallocGuard::available())
    GTEST_SKIP() << "SKIPPED: the heap cannot be watched under a sanitizer";
  tautline::operator_command_t command{};
  command.session = -77;
  ASSERT_TRUE(exchange(command));  // LCM makes its table of channels with the first message of each
  std::array<std::uint8_t, 300> bytes{};
  ASSERT_TRUE(link_->publish(channel::kEstimate, 0, bytes));
  for (int i = 0; i < 500; ++i) {
    sendFresh(command);
    const testing::MallocGuard guard;
    link_->publish(channel::kEstimate, 0, bytes);
    link_->poll(monotonicNow(), -77);
    ASSERT_EQ(guard.allocations(), 0) << "cycle " << i;
  }
}

}  // namespace
}  // namespace tautline
