#include "app/station/telemetry.h"

#include <map>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/station/events.h"
#include "common/testing/malloc_guard.h"
#include "lcmtypes/channels.h"

namespace tautline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using namespace std::chrono_literals;

const std::string kPlace = "/dev/serial/by-id/usb-Maker_of_a_Ground_Station_with_a_long_name-if00";

/// Keeps the last message of each channel.
class LastMessages final : public TelemetrySink {
 public:
  LastMessages() {
    for (const char* channel : {channel::kEvent, channel::kVehicleState})
      last_[channel].reserve(4096);
  }
  bool publish(const char* channel, std::int64_t,
               std::span<const std::uint8_t> bytes) noexcept override {
    for (auto& [name, last] : last_)
      if (name == channel) last.assign(bytes.begin(), bytes.end());
    return true;
  }
  template <class Message>
  Message get(const char* channel) {
    Message message;
    const auto& bytes = last_.at(channel);
    EXPECT_GT(message.decode(bytes.data(), 0, static_cast<int>(bytes.size())), 0);
    return message;
  }

 private:
  std::map<std::string, std::vector<std::uint8_t>> last_;
};

class TelemetryTest : public ::testing::Test {
 protected:
  TelemetryTest() {
    telemetry_.setPlace(kPlace);
    output_.operators = &operators_;
  }
  void tell(EventCode code) {
    output_.events[0] = {code, {}, {}};
    output_.event_count = 1;
    telemetry_.publish(input_, output_);
  }

  LastMessages sink_;
  Telemetry telemetry_{sink_, RunMode::kSim, Duration::zero(), 10ms};
  CoreConfig config_;
  MissionStore missions_;
  OperatorDialogue operators_{config_, missions_};
  StepInput input_;
  StepOutput output_;
};

TEST_F(TelemetryTest, EveryFaultOfALinkHasItsTextAndARemedyThatNamesThePlace) {
  std::set<std::string> texts;
  for (const auto& fault : kLinkFaultNames) {
    if (fault.value == LinkFault::kNone) continue;
    tell(eventOf(fault.value));
    const auto event = sink_.get<tautline::event_t>(channel::kEvent);
    EXPECT_TRUE(texts.insert(event.text).second) << event.text;
    EXPECT_FALSE(event.remedy.empty()) << event.text;
    EXPECT_THAT(event.text + event.remedy, Not(HasSubstr("{}")));
  }
  tell(eventOf(LinkFault::kPortBusy));
  const auto busy = sink_.get<tautline::event_t>(channel::kEvent);
  EXPECT_EQ(busy.text, "another program has " + kPlace);
  EXPECT_THAT(busy.remedy, HasSubstr("fuser -v " + kPlace));
  tell(eventOf(LinkFault::kBusOff));
  EXPECT_THAT(sink_.get<tautline::event_t>(channel::kEvent).remedy,
              HasSubstr("ip link set " + kPlace + " down; ip link set " + kPlace + " up"));
}

TEST_F(TelemetryTest, TheVehiclesStateHasTheLinkWithItsPlace) {
  input_.sensors.link.frames_lost = 3;
  input_.sensors.link.frames_foreign = 5;
  input_.sensors.link.no_buffer = 7;
  telemetry_.publish(input_, output_);
  const auto vehicle = sink_.get<tautline::vehicle_state_t>(channel::kVehicleState);
  EXPECT_EQ(vehicle.link_place, kPlace);
  EXPECT_EQ(vehicle.link_frames_lost, 3);
  EXPECT_EQ(vehicle.link_frames_foreign, 5);
  EXPECT_EQ(vehicle.link_no_buffer, 7);
}

TEST_F(TelemetryTest, NoEventTouchesTheHeap) {
  if (!testing::MallocGuard::available())
    GTEST_SKIP() << "a sanitizer owns malloc in this build: nothing to count";
  output_.events[0].mode = Mode::kStandby;
  for (const auto& condition : kConditionNames)
    output_.events[0].reasons.set(condition.value, true);
  output_.event_count = 1;
  const testing::MallocGuard guard;
  for (const EventText& text : kEventTexts) {
    output_.events[0].code = text.code;
    telemetry_.publish(input_, output_);
  }
  EXPECT_EQ(guard.allocations() + guard.deallocations(), 0);
}

}  // namespace
}  // namespace tautline
