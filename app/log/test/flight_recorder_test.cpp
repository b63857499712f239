// One log for each arming: when it begins and ends, its name, what is in it, and the quota.

#include "app/log/flight_recorder.h"

#include <sys/stat.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tautline/mission_status_t.hpp>
#include <tautline/params_t.hpp>
#include <tautline/station_state_t.hpp>

#include "app/log/log_check.h"
#include "app/log/log_folder.h"
#include "common/vehicle.h"
#include "control/motion_executor.h"
#include "supervision/supervisor.h"

namespace tautline {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::int64_t kStart = 1'769'862'896'000'000;  // 2026-01-31 12:34:56 UTC [us]

template <class Message>
std::vector<std::uint8_t> encoded(const Message& m) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(m.getEncodedSize()));
  m.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

/// A station that says every 100 ms what it does, and a recorder that listens; virtual time.
class FlightRecorderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("tautline_recorder_" +
               std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    make(1ULL << 30U);
  }
  void TearDown() override {
    recorder_.reset();
    fs::remove_all(folder_);
  }

  void make(std::uint64_t quota) {
    recorder_ = std::make_unique<FlightRecorder>(
        FlightRecorderConfig{.folder = folder_, .quota = quota},
        [this](const std::string& text) { said_.push_back(text); });
  }

  [[nodiscard]] std::int64_t utime() const {
    return kStart + std::chrono::duration_cast<std::chrono::microseconds>(now_ - kBegin).count();
  }
  void send(const std::string& channel, const std::vector<std::uint8_t>& data) {
    recorder_->onMessage(channel, utime(), data, now_);
  }
  void sendParams() {
    params_t m{};
    m.program = "tautline-station";
    send("PARAMS", encoded(m));
  }
  /// The station is in `mode` for that long.
  void fly(Mode mode, Duration length, std::int64_t mission = 0) {
    for (const Time end = now_ + length; now_ < end; now_ += milliseconds(100)) {
      station_state_t m{};
      m.utime = utime();
      m.run_mode = static_cast<std::int8_t>(RunMode::kHil);
      m.mode = static_cast<std::int8_t>(mode);
      send("STATION_STATE", encoded(m));
      mission_status_t status{};
      status.mission_hash = mission;
      status.state = static_cast<std::int8_t>(mode == Mode::kAuto ? MissionState::kRunning
                                                                  : MissionState::kCompleted);
      send("MISSION_STATUS", encoded(status));
      recorder_->tick(now_);
    }
  }
  void silence(Duration length) {
    for (const Time end = now_ + length; now_ < end; now_ += milliseconds(100))
      recorder_->tick(now_);
  }
  [[nodiscard]] std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) names.insert(entry.path().filename());
    return names;
  }
  /// Times of the STATION_STATEs in the one log [s after kStart].
  [[nodiscard]] std::vector<double> timesIn(const std::string& name) const {
    std::vector<double> times;
    const LogCheck check = checkLog(folder_ / name, [&](const LogEvent& e) {
      if (e.channel == "STATION_STATE")
        times.push_back(static_cast<double>(e.utime - kStart) * 1e-6);
    });
    EXPECT_THAT(check.damage, IsEmpty());
    return times;
  }

  static constexpr Time kBegin{seconds(100)};
  fs::path folder_;
  Time now_{kBegin};
  std::vector<std::string> said_;
  std::unique_ptr<FlightRecorder> recorder_;
};

TEST_F(FlightRecorderTest, NothingIsWrittenInStandby) {
  fly(Mode::kStandby, seconds(20));
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(FlightRecorderTest, ALogFromTwoSecondsBeforeToTwoSecondsAfter) {
  sendParams();
  fly(Mode::kStandby, seconds(10));
  fly(Mode::kArmed, seconds(1));
  fly(Mode::kTakeoff, seconds(3));
  fly(Mode::kStandby, seconds(10));
  const std::string name = "2026-01-31T12-35-06Z_no-mission_HIL.lcm";
  ASSERT_THAT(files(), ElementsAre(name));
  const std::vector<double> times = timesIn(name);
  EXPECT_NEAR(times.front(), 8.0, 0.11);
  EXPECT_NEAR(times.back(), 16.0, 0.11);
  EXPECT_NEAR(static_cast<double>(times.size()), 80.0, 2.0) << "each once";
  int params = 0;
  checkLog(folder_ / name, [&](const LogEvent& e) { params += e.channel == "PARAMS"; });
  EXPECT_EQ(params, 1) << "sent long before, and needed by whoever replays it";
}

TEST_F(FlightRecorderTest, TheMissionThatIsFlownGivesTheName) {
  constexpr std::int64_t kOld = 0x1111111122222222;
  constexpr std::int64_t kFlown = -0x0102030405060708;
  fly(Mode::kStandby, seconds(3), kOld);
  fly(Mode::kArmed, seconds(1), kOld);
  EXPECT_THAT(files(), ElementsAre("2026-01-31T12-34-59Z_no-mission_HIL.lcm"));
  fly(Mode::kAuto, seconds(1), kFlown);
  EXPECT_THAT(files(), ElementsAre("2026-01-31T12-34-59Z_fefdfcfb_HIL.lcm")) << "while it flies";
  fly(Mode::kAuto, seconds(1), kOld);
  fly(Mode::kStandby, seconds(4));
  EXPECT_THAT(files(), ElementsAre("2026-01-31T12-34-59Z_fefdfcfb_HIL.lcm"));
  EXPECT_GT(timesIn(*files().begin()).size(), 60U);
}

TEST_F(FlightRecorderTest, AShortStandbyIsStillTheSameLogAndTheNextArmingIsAnother) {
  fly(Mode::kArmed, seconds(1));
  fly(Mode::kStandby, seconds(1));
  fly(Mode::kArmed, seconds(1));
  EXPECT_EQ(files().size(), 1U);
  fly(Mode::kStandby, seconds(5));
  fly(Mode::kArmed, seconds(1));
  EXPECT_EQ(files().size(), 2U);
}

TEST_F(FlightRecorderTest, AClockThatIsSetBackOverwritesNothing) {
  fly(Mode::kArmed, seconds(1));
  fly(Mode::kStandby, seconds(3));
  now_ = kBegin + seconds(0);  // the same second again
  make(1ULL << 30U);
  fly(Mode::kArmed, seconds(1));
  EXPECT_THAT(files(), ElementsAre("2026-01-31T12-34-56Z_no-mission_HIL.lcm",
                                   "2026-01-31T12-34-56Z_no-mission_HIL_2.lcm"));
}

TEST_F(FlightRecorderTest, ASilentStationIsSaidOnceAndRecordingGoesOn) {
  fly(Mode::kArmed, seconds(2));
  silence(seconds(20));
  EXPECT_EQ(
      std::count(said_.begin(), said_.end(), "the station is silent in flight; recording goes on"),
      1);
  EXPECT_FALSE(recorder_->file().empty());
  fly(Mode::kStandby, seconds(4));  // it came back, disarmed
  EXPECT_THAT(said_, Contains("the station is heard again"));
  EXPECT_TRUE(recorder_->file().empty());
}

TEST_F(FlightRecorderTest, ClosingInFlightLeavesAWholeLog) {
  fly(Mode::kArmed, seconds(2));
  recorder_->close();
  EXPECT_EQ(timesIn(*files().begin()).size(), 20U);
  EXPECT_THAT(said_.back(), HasSubstr("40 events, 0 lost"));
}

TEST_F(FlightRecorderTest, OldLogsMakeRoomButNeverTheOneBeingWritten) {
  const auto old = [&](const std::string& name, int age_hours) {
    std::ofstream(folder_ / name) << std::string(100'000, 'x');
    fs::last_write_time(folder_ / name,
                        fs::file_time_type::clock::now() - std::chrono::hours(age_hours));
  };
  old("a.lcm", 3);
  old("b.lcm.00", 2);
  old("c.lcm", 1);
  old("notes.txt", 9);
  old("lcm.html", 9);
  make(250'000);
  fly(Mode::kArmed, seconds(1));
  EXPECT_EQ(files().count("a.lcm"), 0U);
  EXPECT_EQ(files().count("b.lcm.00") + files().count("c.lcm") + files().count("notes.txt") +
                files().count("lcm.html"),
            4U);
  make(0);
  now_ += seconds(10);
  fly(Mode::kArmed, seconds(5));
  const fs::path current = recorder_->file();
  EXPECT_EQ(files().count(current.filename()), 1U);
  EXPECT_EQ(files().size(), 3U) << "notes, page, and the log that is being written";
}

}  // namespace
}  // namespace tautline
