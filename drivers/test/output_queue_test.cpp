#include "drivers/output_queue.h"

#include <deque>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace tautline {
namespace {

std::span<const std::uint8_t> bytesOf(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string take(OutputQueue& queue, std::size_t count) {
  const auto pending = queue.pending().first(count);
  const std::string text(pending.begin(), pending.end());
  queue.consume(count);
  return text;
}

std::string takeAll(OutputQueue& queue) { return take(queue, queue.pending().size()); }

TEST(OutputQueue, KeepsTheOrder) {
  OutputQueue queue;
  EXPECT_EQ(queue.push(bytesOf("one\n")), 0U);
  EXPECT_EQ(queue.push(bytesOf("two\n")), 0U);
  EXPECT_EQ(take(queue, 6), "one\ntw");
  EXPECT_EQ(queue.push(bytesOf("three\n")), 0U);
  EXPECT_EQ(takeAll(queue), "o\nthree\n");
  EXPECT_TRUE(queue.pending().empty());
}

TEST(OutputQueue, GivesUpTheOldestButNeverAMessageThatIsPartlySent) {
  OutputQueue queue;
  const std::string first(200, 'a');
  const std::string second(200, 'b');
  const std::string third(200, 'c');
  EXPECT_EQ(queue.push(bytesOf(first)), 0U);
  EXPECT_EQ(queue.push(bytesOf(second)), 0U);
  EXPECT_EQ(take(queue, 1), "a");
  EXPECT_EQ(queue.push(bytesOf(third)), second.size());
  EXPECT_EQ(takeAll(queue), first.substr(1) + third);
}

TEST(OutputQueue, RefusesAMessageThatCannotFit) {
  OutputQueue queue;
  const std::string large(OutputQueue::kMaxMessage + 1, 'x');
  EXPECT_EQ(queue.push(bytesOf("before\n")), 0U);
  EXPECT_EQ(queue.push(bytesOf(large)), large.size());
  EXPECT_EQ(takeAll(queue), "before\n");
}

TEST(OutputQueue, ClearTellsWhatWasLost) {
  OutputQueue queue;
  EXPECT_EQ(queue.push(bytesOf("0123456789")), 0U);
  EXPECT_EQ(take(queue, 4), "0123");
  EXPECT_EQ(queue.clear(), 6U);
  EXPECT_TRUE(queue.pending().empty());
}

// Random use: what comes out is whole messages in order, and each byte is sent, given up or still
// there.
TEST(OutputQueue, OnlyWholeMessagesComeOutAndNoByteIsLostFromTheCount) {
  std::mt19937 random(3);
  OutputQueue queue;
  std::string out;
  std::deque<std::string> pushed;
  std::size_t total = 0;
  std::size_t dropped = 0;
  for (int i = 0; i < 20000; ++i) {
    if (random() % 2 == 0) {
      const std::string message = "<" + std::to_string(i) + std::string(random() % 90, '.') + ">";
      dropped += queue.push(bytesOf(message));
      pushed.push_back(message);
      total += message.size();
    } else {
      out += take(queue, random() % (queue.pending().size() + 1));
    }
    ASSERT_EQ(total, out.size() + dropped + queue.pending().size());
  }
  out += takeAll(queue);
  EXPECT_GT(dropped, 0U);
  for (std::size_t at = 0; at < out.size();) {
    const std::size_t end = out.find('>', at);
    ASSERT_NE(end, std::string::npos);
    const std::string message = out.substr(at, end + 1 - at);
    while (!pushed.empty() && pushed.front() != message) pushed.pop_front();
    ASSERT_FALSE(pushed.empty()) << message << " was cut or came out of order";
    at = end + 1;
  }
}

}  // namespace
}  // namespace tautline
