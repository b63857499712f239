// Faults over LCM while the machine runs. Needs a multicast route.

#include "sim_hil/fault_inbox.h"

#include <unistd.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "common/error.h"
#include "common/multicast.h"
#include "lcmtypes/channels.h"
#include "sim_hil/fault_schedule.h"

namespace tautline::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class FaultInboxTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!hasMulticastRoute(url_)) GTEST_SKIP() << "no multicast route: " << kMulticastRemedy;
    inbox_.emplace(url_, SimDevice::kFotokite);
    sender_.emplace(url_);
  }

  void send(std::int64_t utime, const std::string& text) {
    sim_fault_t message;
    message.utime = utime;
    message.fault = text;
    sender_->publish(channel::kSimFault, &message);
  }

  /// Until it is true, or has not been for two seconds.
  bool soon(const std::function<bool()>& done) {
    for (int i = 0; i < 200 && !done(); ++i) {
      inbox_->poll(simulator_);
      simulator_.advanceTo(simulator_.now() + milliseconds(10));
      ::usleep(10'000);
    }
    return done();
  }

  std::string url_ =
      "udpm://239.255.76.67:" + std::to_string(10000 + ::getpid() % 50000) + "?ttl=0";
  Scene world_ = [] {
    Scene scene;
    scene.floor = -0.3;
    return scene;
  }();
  Simulator simulator_{SimConfig{}, world_, 1};
  std::optional<FaultInbox> inbox_;
  std::optional<lcm::LCM> sender_;
};

TEST_F(FaultInboxTest, TheTimeCountsFromTheArrival) {
  simulator_.advanceTo(Time{} + seconds(20));
  send(1, "bus unplug 0.5 1");
  EXPECT_FALSE(simulator_.unplugged());
  ASSERT_TRUE(soon([&] { return simulator_.unplugged(); }));
  EXPECT_GE(simulator_.now(), Time{} + seconds(20) + milliseconds(500));
  EXPECT_TRUE(soon([&] { return !simulator_.unplugged(); }));
}

TEST_F(FaultInboxTest, ACopyIsTakenOnce) {
  // Were each of them taken there would be no room for the last.
  for (int i = 0; i < static_cast<int>(kMaxFaults) + 4; ++i) send(7, "encoder off 100");
  send(8, "bus unplug 0");
  EXPECT_TRUE(soon([&] { return simulator_.unplugged(); }));
}

TEST_F(FaultInboxTest, WhatIsNoneIsRefusedInALine) {
  ::testing::internal::CaptureStderr();
  send(1, "encoder snag 0");
  send(2, "loop delayed 0");
  send(3, "encoder off");
  for (int i = 0; i <= static_cast<int>(kMaxFaults); ++i) send(10 + i, "encoder off 100");
  send(99, "bus crc 0");
  static_cast<void>(soon([] { return false; }));
  const std::string said = ::testing::internal::GetCapturedStderr();
  for (const char* part : {"SIM_FAULT refused: ", "not supported", "is not in the machine",
                           "has 2 words", "too many faults", "has no such bus"})
    EXPECT_NE(said.find(part), std::string::npos) << part << " in " << said;
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 5) << said;
}

TEST(FaultInbox, WithoutAWayForItsPacketsItSaysWhatToDo) {
  if (hasMulticastRoute(kDefaultLcmUrl)) GTEST_SKIP() << "there is a multicast route";
  EXPECT_THROW(FaultInbox(kDefaultLcmUrl, SimDevice::kFotokite), InputError);
}

}  // namespace
}  // namespace tautline::sim
