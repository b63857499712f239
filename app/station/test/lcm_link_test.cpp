// The station's LCM link over the real network stack of this machine (loopback).

#include "app/station/lcm_link.h"

#include <array>
#include <memory>
#include <optional>
#include <thread>

#include <gtest/gtest.h>
#include <tautline/operator_command_t.hpp>

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

  /// Sends commands until one arrives: a datagram may be lost, and the link's reader thread needs a
  /// moment.
  std::optional<OperatorCommand> exchange(const tautline::operator_command_t& command) {
    for (int i = 0; i < 200; ++i) {
      client_->publish(channel::kOperatorCommand, &command);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      link_->poll();
      if (link_->command()) return link_->command();
    }
    return std::nullopt;
  }

  std::unique_ptr<LcmLink> link_;
  std::unique_ptr<lcm::LCM> client_;
};

TEST_F(LcmLinkTest, DeliversACommandAsItWasSent) {
  tautline::operator_command_t command{};
  command.session = -77;
  command.sequence = 5;
  command.verb = static_cast<std::int8_t>(Request::kNavigate);
  command.mission_hash = 0x7fedcba987654321;
  const auto got = exchange(command);
  ASSERT_TRUE(got);
  EXPECT_EQ(got->session, -77);
  EXPECT_EQ(got->sequence, 5);
  EXPECT_EQ(got->request, Request::kNavigate);
  EXPECT_EQ(got->mission_hash, 0x7fedcba987654321U);
}

TEST_F(LcmLinkTest, ShortAndForeignBytesAreIgnored) {
  const std::array<std::uint8_t, 40> junk{1, 2, 3};
  for (unsigned size : {0U, 3U, 8U, 39U})
    client_->publish(channel::kOperatorCommand, junk.data(), size);
  for (unsigned size : {0U, 3U, 8U, 39U})
    client_->publish(channel::kMissionChunk, junk.data(), size);
  for (int i = 0; i < 40; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    link_->poll();
    EXPECT_FALSE(link_->command());
    EXPECT_EQ(link_->chunk(), nullptr);
  }
}

TEST_F(LcmLinkTest, SendsAndReceivesWithoutTheHeap) {
  if (!testing::MallocGuard::available())
    GTEST_SKIP() << "SKIPPED: the heap cannot be watched under a sanitizer";
  tautline::operator_command_t command{};
  command.sequence = 1;
  ASSERT_TRUE(exchange(command));  // LCM makes its table of channels with the first message of each
  std::array<std::uint8_t, 300> bytes{};
  ASSERT_TRUE(link_->publish(channel::kEstimate, 0, bytes));
  for (int i = 0; i < 500; ++i) {
    client_->publish(channel::kOperatorCommand, &command);
    const testing::MallocGuard guard;
    link_->publish(channel::kEstimate, 0, bytes);
    link_->poll();
    ASSERT_EQ(guard.allocations(), 0) << "cycle " << i;
  }
}

}  // namespace
}  // namespace tautline
