// Logs that were cut and holed at many places, against a count by brute force of the events whose
// bytes were touched.

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>
#include <tautline/estimate_t.hpp>
#include <tautline/station_state_t.hpp>

#include "app/log/event_log_reader.h"
#include "app/log/event_log_writer.h"
#include "app/log/log_check.h"
#include "common/error.h"

namespace tautline {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

fs::path testFile(const std::string& name) {
  const fs::path folder = fs::path(::testing::TempDir()) / "tautline_event_log_test";
  fs::create_directories(folder);
  return folder / name;
}

std::string contents(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
fs::path write(const std::string& name, const std::string& bytes) {
  const fs::path file = testFile(name);
  std::ofstream(file, std::ios::binary) << bytes;
  return file;
}

/// First byte and the one behind the last, of every event, as they were written.
struct Extent {
  std::size_t begin;
  std::size_t end;
};

/// A log of `events` events: our types, foreign bytes that hold sync words, empty data.
class SampleLog {
 public:
  explicit SampleLog(int events) {
    const fs::path file = testFile("whole.lcm");
    std::mt19937 random(7);
    {
      EventLogWriter writer(file);
      for (int i = 0; i < events; ++i) {
        const auto [channel, data] = sample(i, random);
        EXPECT_TRUE(writer.write(channel, 1'000'000 + i, data));
        sizes_.push_back(28 + channel.size() + data.size());
      }
    }
    bytes_ = contents(file);
    std::size_t at = 0;
    for (const std::size_t size : sizes_) {
      extents_.push_back({at, at + size});
      at += size;
    }
    EXPECT_EQ(at, bytes_.size());
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  [[nodiscard]] const std::vector<Extent>& extents() const { return extents_; }

 private:
  static std::pair<std::string, std::vector<std::uint8_t>> sample(int i, std::mt19937& random) {
    if (i % 7 == 3) return {"EMPTY", {}};
    if (i % 7 == 5) {
      std::vector<std::uint8_t> foreign(random() % 300);
      for (auto& byte : foreign) byte = static_cast<std::uint8_t>(random());
      constexpr std::array<std::uint8_t, 4> kSyncWord{0xED, 0xA1, 0xDA, 0x01};
      foreign.insert(foreign.end(), kSyncWord.begin(), kSyncWord.end());
      return {"FOREIGN", foreign};
    }
    estimate_t m{};
    m.utime = i;
    for (double& p : m.position_cov_m2) p = static_cast<double>(random()) * 1e-9;
    m.nis = 1.0 / (1 + i);
    std::vector<std::uint8_t> data(static_cast<std::size_t>(m.getEncodedSize()));
    m.encode(data.data(), 0, static_cast<int>(data.size()));
    return {"ESTIMATE", data};
  }

  std::string bytes_;
  std::vector<std::size_t> sizes_;
  std::vector<Extent> extents_;
};

struct ReadBack {
  std::vector<std::int64_t> numbers;
  std::int64_t lost{};
  bool at_least{};
  std::size_t places{};
};

ReadBack readAll(const fs::path& file) {
  EventLogReader reader(file);
  ReadBack out;
  while (const auto event = reader.next()) {
    EXPECT_EQ(event->utime, 1'000'000 + event->number);
    out.numbers.push_back(event->number);
  }
  for (const LogDamage& d : reader.damage()) {
    out.lost += d.events_lost;
    out.at_least = out.at_least || d.at_least;
  }
  out.places = reader.damage().size();
  return out;
}

/// Numbers of the events of which no byte lies in [begin, end).
std::vector<std::int64_t> untouched(const SampleLog& log, std::size_t begin, std::size_t end) {
  std::vector<std::int64_t> out;
  for (std::size_t i = 0; i < log.extents().size(); ++i) {
    const Extent& e = log.extents()[i];
    if (e.end <= begin || e.begin >= end) out.push_back(static_cast<std::int64_t>(i));
  }
  return out;
}

TEST(EventLog, WhatIsWrittenIsReadByUsAndByLcm) {
  const SampleLog log(500);
  const ReadBack all = readAll(testFile("whole.lcm"));
  EXPECT_EQ(all.numbers.size(), 500U);
  EXPECT_EQ(all.places, 0U);
  lcm::LogFile lcm_reader(testFile("whole.lcm").string(), "r");
  int events = 0;
  while (const lcm::LogEvent* event = lcm_reader.readNextEvent()) {
    EXPECT_EQ(event->eventnum, events);
    ++events;
  }
  EXPECT_EQ(events, 500);
}

TEST(EventLog, CutAnywhereOnlyTheCutEventIsLost) {
  const SampleLog log(400);
  int cuts = 0;
  for (std::size_t cut = 997; cut < log.bytes().size(); cut += 997, ++cuts) {
    const fs::path file = write("cut.lcm", log.bytes().substr(0, cut));
    const ReadBack got = readAll(file);
    ASSERT_EQ(got.numbers, untouched(log, cut, log.bytes().size())) << "cut at " << cut;
    const bool between = std::any_of(log.extents().begin(), log.extents().end(),
                                     [&](const Extent& e) { return e.begin == cut; });
    ASSERT_EQ(got.places, between ? 0U : 1U) << cut;
    ASSERT_EQ(got.lost, between ? 0 : 1) << cut;
  }
  EXPECT_GT(cuts, 60);
}

TEST(EventLog, EveryCutWithinOneEventIsSeen) {
  const SampleLog log(3);
  for (std::size_t cut = log.extents()[1].end + 1; cut < log.bytes().size(); ++cut) {
    const ReadBack got = readAll(write("cut.lcm", log.bytes().substr(0, cut)));
    ASSERT_EQ(got.numbers.size(), 2U) << cut;
    ASSERT_EQ(got.lost, 1) << cut;
    ASSERT_TRUE(got.at_least);
  }
}

class Holes : public ::testing::TestWithParam<std::size_t> {};

TEST_P(Holes, OnlyTouchedEventsAreLostAndAllOfThemAreCounted) {
  const SampleLog log(400);
  std::mt19937 random(3);
  for (const bool noise : {false, true}) {
    for (std::size_t begin = 997; begin + GetParam() < log.bytes().size(); begin += 997) {
      std::string bytes = log.bytes();
      for (std::size_t i = 0; i < GetParam(); ++i)
        bytes[begin + i] = noise ? static_cast<char>(random()) : '\0';
      auto expected = untouched(log, begin, begin + GetParam());
      // Damage that begins where an event ends: nothing shows that this event is whole; nor do
      // some bytes of the next sync word in front of noise.
      const auto in_front = std::find_if(
          log.extents().begin(), log.extents().end(),
          [&](const Extent& e) { return begin >= e.end && begin - e.end < (noise ? 4U : 1U); });
      if (in_front != log.extents().end())
        std::erase(expected, static_cast<std::int64_t>(in_front - log.extents().begin()));
      const ReadBack got = readAll(write("holed.lcm", bytes));
      ASSERT_EQ(got.numbers, expected)
          << "hole at " << begin << (noise ? " of noise" : " of zeros");
      const auto lost = static_cast<std::int64_t>(log.extents().size() - expected.size());
      if (got.at_least) {  // the last event itself is among them
        ASSERT_LE(got.lost, lost);
      } else {
        ASSERT_EQ(got.lost, lost) << begin;
      }
    }
  }
}
// Longer than any event here: shorter ones may lie within an event's data, where no reader can see
// them (docs/operator_tools.md).
INSTANTIATE_TEST_SUITE_P(Sizes, Holes, ::testing::Values(512, 4096, 10'000));

TEST(EventLog, ABlockThatIsMissingIsCounted) {
  const SampleLog log(100);
  const Extent first = log.extents()[10];
  const Extent last = log.extents()[19];
  const ReadBack whole_events = readAll(
      write("short.lcm", log.bytes().substr(0, first.begin) + log.bytes().substr(last.end)));
  EXPECT_EQ(whole_events.numbers.size(), 90U);
  EXPECT_EQ(whole_events.lost, 10);
  EXPECT_FALSE(whole_events.at_least);
  const ReadBack beginning = readAll(write("short.lcm", log.bytes().substr(first.begin)));
  EXPECT_EQ(beginning.numbers.size(), 90U);
  EXPECT_EQ(beginning.lost, 0) << "a piece of a longer log is whole by itself";
  const ReadBack torn = readAll(write("short.lcm", log.bytes().substr(first.begin + 5)));
  EXPECT_EQ(torn.numbers.size(), 89U);
  EXPECT_EQ(torn.lost, 11);
}

TEST(EventLog, TwoLogsInOneFileAreNoDamage) {
  const SampleLog log(50);
  EventLogReader reader(write("two.lcm", log.bytes() + log.bytes()));
  int events = 0;
  while (reader.next()) ++events;
  EXPECT_EQ(events, 100);
  EXPECT_TRUE(reader.damage().empty());
}

TEST(EventLog, ADamagedNumberCostsItsEvent) {
  const SampleLog log(50);
  std::string bytes = log.bytes();
  bytes[log.extents()[20].begin + 6] = '\x10';
  const ReadBack got = readAll(write("number.lcm", bytes));
  EXPECT_EQ(got.numbers.size(), 49U);
  EXPECT_EQ(got.lost, 1);
  EXPECT_EQ(got.places, 1U);
}

TEST(EventLog, DamageSaysWhereWhatAndHowMuch) {
  const SampleLog log(50);
  std::string bytes = log.bytes();
  const Extent hit = log.extents()[20];
  bytes[hit.begin + 21] = 'x';  // in the length of its channel
  const LogCheck check = checkLog(write("said.lcm", bytes), [](const LogEvent&) {});
  ASSERT_EQ(check.damage.size(), 1U);
  EXPECT_EQ(check.damage[0].offset, hit.begin);
  EXPECT_EQ(check.damage[0].bytes, hit.end - hit.begin);
  EXPECT_THAT(describe(check.damage[0]), HasSubstr("; 1 event lost"));
  EXPECT_EQ(summary(check.damage), "damaged in 1 place, 1 event lost");
}

TEST(EventLog, DataThatIsNoMessageOfItsChannelIsDamage) {
  const SampleLog log(50);
  const LogCheck whole = checkLog(testFile("whole.lcm"), [](const LogEvent&) {});
  EXPECT_TRUE(whole.damage.empty());
  EXPECT_EQ(whole.events, 50);
  std::string bytes = log.bytes();
  ASSERT_EQ(bytes.substr(log.extents()[21].begin + 28, 8), "ESTIMATE");
  bytes[log.extents()[21].begin + 28 + 8 + 2] ^= '\x55';  // in its fingerprint
  std::vector<std::int64_t> sound;
  const LogCheck check =
      checkLog(write("type.lcm", bytes), [&](const LogEvent& e) { sound.push_back(e.number); });
  EXPECT_EQ(sound.size(), 49U);
  EXPECT_EQ(std::count(sound.begin(), sound.end(), 21), 0);
  ASSERT_EQ(check.damage.size(), 1U);
  EXPECT_EQ(check.damage[0].offset, log.extents()[21].begin);
}

TEST(EventLog, WhatIsNoLogIsSaidPlainly) {
  const auto problemOf = [](const fs::path& file) {
    try {
      EventLogReader reader(file);
    } catch (const InputError& error) {
      return error.problem().problem;
    }
    return std::string("none");
  };
  EXPECT_THAT(problemOf("/nowhere.lcm"), HasSubstr("No such file"));
  EXPECT_THAT(problemOf(::testing::TempDir()), HasSubstr("no regular file"));
  EXPECT_THAT(problemOf(write("empty.lcm", "")), HasSubstr("empty"));
  EXPECT_THAT(problemOf(write("text.lcm", "hello, this is no log")), HasSubstr("no event"));
}

TEST(EventLog, ALogIsLockedWhileItIsWritten) {
  const fs::path file = testFile("locked.lcm");
  {
    EventLogWriter writer(file);
    EXPECT_TRUE(isBeingWritten(file));
  }
  EXPECT_FALSE(isBeingWritten(file));
}

}  // namespace
}  // namespace tautline
