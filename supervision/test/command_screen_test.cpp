#include "supervision/command_screen.h"

#include <limits>

#include <gtest/gtest.h>

namespace tautline {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using S = OperatorStream;
using A = AckResult;

/// A station and a client whose clocks are `skew` apart; messages take `delay`.
struct Link {
  CommandScreen screen{AuthorityConfig{}};
  Time now{seconds(1000)};
  Duration skew{seconds(-77'000)};
  std::int64_t session{5};
  std::int64_t sequence{0};

  MessageHead head(Duration delay, std::int64_t number) const {
    return {toMicroseconds(now - delay + skew), session, number};
  }
  A send(S stream, Duration delay = milliseconds(2)) {
    return screen.look(now, stream, head(delay, ++sequence));
  }
  A command(Duration delay = milliseconds(2)) { return send(S::kCommands, delay); }
  A beat(Duration delay = milliseconds(2)) { return send(S::kHeartbeats, delay); }
  void beatFor(Duration d, Duration delay = milliseconds(2)) {
    for (const Time end = now + d; now < end; now += milliseconds(200)) beat(delay);
  }
};

TEST(CommandScreen, TakesNothingFromASessionNotYetHeard) {
  Link link;
  EXPECT_EQ(link.command(), A::kNoHeartbeat);
  EXPECT_EQ(link.beat(), A::kAccepted);
  EXPECT_EQ(link.command(), A::kAccepted);
}

TEST(CommandScreen, AgeIsJudgedWhateverTheClocksSay) {
  for (const Duration skew :
       {Duration(seconds(-77'000)), Duration(0), Duration(seconds(9'000'000))}) {
    Link link;
    link.skew = skew;
    link.beatFor(seconds(1));
    EXPECT_EQ(link.command(milliseconds(2 + 299)), A::kAccepted);
    EXPECT_EQ(link.command(milliseconds(2 + 301)), A::kLate);
  }
}

TEST(CommandScreen, TheQuickestHeartbeatCounts) {
  Link link;
  link.beatFor(seconds(1), milliseconds(250));
  EXPECT_EQ(link.command(milliseconds(400)), A::kAccepted) << "250 ms are the way, 150 ms the age";
  link.beat(milliseconds(10));
  EXPECT_EQ(link.command(milliseconds(400)), A::kLate);
}

TEST(CommandScreen, ALateHeartbeatIsNoSignOfLife) {
  Link link;
  link.beatFor(seconds(1));
  EXPECT_EQ(link.beat(milliseconds(500)), A::kLate);
}

TEST(CommandScreen, AClockSetBackIsForgivenWithinAMinute) {
  Link link;
  link.beatFor(seconds(40));
  link.skew -= seconds(20);
  EXPECT_EQ(link.command(), A::kLate);
  link.beatFor(seconds(61));
  EXPECT_EQ(link.command(), A::kAccepted);
}

TEST(CommandScreen, AClockSetForwardIsForgivenWithTheNextHeartbeat) {
  Link link;
  link.beatFor(seconds(5));
  link.skew += seconds(20);
  link.beat();
  EXPECT_EQ(link.command(), A::kAccepted);
  EXPECT_EQ(link.command(milliseconds(400)), A::kLate);
}

TEST(CommandScreen, ADriftingClockNeverMakesMessagesLate) {
  Link link;
  for (int minute = 0; minute < 240; ++minute) {
    link.beatFor(seconds(60));
    link.skew -= milliseconds(12);  // 200 ppm, three times a bad quartz
    ASSERT_EQ(link.command(), A::kAccepted) << "minute " << minute;
  }
}

TEST(CommandScreen, OlderSequencesAreRefusedTheLastPassesAgain) {
  Link link;
  link.beat();
  link.sequence = 10;
  ASSERT_EQ(link.command(), A::kAccepted);  // 11
  for (std::int64_t old : {1, 9, 10})
    EXPECT_EQ(link.screen.look(link.now, S::kCommands, link.head({}, old)), A::kReplayed);
  EXPECT_EQ(link.screen.look(link.now, S::kCommands, link.head({}, 11)), A::kAccepted);
  EXPECT_EQ(link.screen.look(link.now, S::kCommands, link.head({}, 11)), A::kFlooded)
      << "at most ten times a second";
  link.now += milliseconds(101);
  EXPECT_EQ(link.screen.look(link.now, S::kCommands, link.head({}, 11)), A::kAccepted);
}

TEST(CommandScreen, HeartbeatsAndSticksNeverPassTwice) {
  Link link;
  ASSERT_EQ(link.beat(), A::kAccepted);
  for (const S stream : {S::kHeartbeats, S::kSticks}) {
    ASSERT_EQ(link.send(stream), A::kAccepted);
    EXPECT_EQ(link.screen.look(link.now, stream, link.head({}, link.sequence)), A::kReplayed);
  }
}

TEST(CommandScreen, AByteForByteCopyIsLate) {
  Link link;
  link.beatFor(seconds(1));
  const MessageHead copy = link.head(milliseconds(2), 1000);
  ASSERT_EQ(link.screen.look(link.now, S::kCommands, copy), A::kAccepted);
  link.now += seconds(1);
  EXPECT_EQ(link.screen.look(link.now, S::kCommands, copy), A::kLate);
}

TEST(CommandScreen, ALateOrFloodedCommandIsNotRemembered) {
  Link link;
  link.beat();
  const std::int64_t number = 500;
  ASSERT_EQ(link.screen.look(link.now, S::kCommands, link.head(seconds(1), number)), A::kLate);
  EXPECT_EQ(link.screen.look(link.now, S::kCommands, link.head({}, number)), A::kAccepted);
}

TEST(CommandScreen, OneSessionsFloodIsNoOtherSessionsLoss) {
  Link flood;
  flood.beat();
  int passed = 0;
  const AuthorityConfig config;
  for (int i = 0; i < 10'000; ++i) {
    passed += flood.command() == A::kAccepted;
    flood.now += std::chrono::microseconds(100);
  }
  EXPECT_LE(passed, 2.0 * config.max_messages_per_s + 1.0);
  EXPECT_GE(passed, config.max_messages_per_s);
  const MessageHead other{toMicroseconds(flood.now), 99, 1};
  ASSERT_EQ(flood.screen.look(flood.now, S::kHeartbeats, other), A::kAccepted);
  EXPECT_EQ(flood.screen.look(flood.now, S::kCommands, other), A::kAccepted);
}

TEST(CommandScreen, SessionsThatSpeakAreNeverPushedOut) {
  Link link;
  link.beat();
  for (std::int64_t stranger = 100; stranger < 200; ++stranger) {
    const A result =
        link.screen.look(link.now, S::kHeartbeats, {toMicroseconds(link.now), stranger, 1});
    EXPECT_EQ(result, stranger < 115 ? A::kAccepted : A::kFlooded) << stranger;
  }
  EXPECT_EQ(link.command(), A::kAccepted);
  link.now += seconds(11);  // all of them silent: the next one gets a place
  EXPECT_EQ(link.screen.look(link.now, S::kHeartbeats, {toMicroseconds(link.now), 200, 1}),
            A::kAccepted);
}

TEST(CommandScreen, HeadsThatCannotBeAreMalformed) {
  Link link;
  link.beat();
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  for (const MessageHead head : {MessageHead{0, 0, 1}, MessageHead{0, 5, 0}, MessageHead{0, 5, -1},
                                 MessageHead{kMost, 5, 9}, MessageHead{-kMost, 5, 9}})
    EXPECT_EQ(link.screen.look(link.now, S::kCommands, head), A::kMalformed);
}

TEST(CommandScreen, CountsByReasonAndAnswersAFew) {
  Link link;
  link.beat();
  link.command();
  link.command(seconds(5));
  link.screen.countRefused(A::kMalformed);
  const AckCounts& counts = link.screen.counts();
  EXPECT_EQ(counts[static_cast<std::size_t>(A::kAccepted)], 2);
  EXPECT_EQ(counts[static_cast<std::size_t>(A::kLate)], 1);
  EXPECT_EQ(counts[static_cast<std::size_t>(A::kMalformed)], 1);
  int answered = 0;
  for (int i = 0; i < 1000; ++i) {
    answered += link.screen.mayAnswer(link.now);
    link.now += milliseconds(1);
  }
  EXPECT_GE(answered, 20);
  EXPECT_LE(answered, 41);
}

}  // namespace
}  // namespace tautline
