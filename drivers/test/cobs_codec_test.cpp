#include "drivers/cobs_codec.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/test/tautline_golden.h"

namespace tautline::bus {
namespace {

using testing::bytesOfHex;
using testing::frameOf;

std::vector<DecodedSerial> feed(FrameAssembler& assembler, const std::vector<std::uint8_t>& bytes) {
  std::vector<DecodedSerial> out;
  assembler.push(bytes, [&out](const DecodedSerial& frame) { out.push_back(frame); });
  return out;
}

bool same(const BusFrame& a, const BusFrame& b) {
  return a.id == b.id && a.size == b.size && a.data == b.data;
}

TEST(CobsCodec, WritesAndReadsGoldenFrames) {
  for (const testing::GoldenFrame& golden : testing::kGoldenFrames) {
    const BusFrame frame = frameOf(golden.candump);
    const SerialFrame sent = encodeSerial(frame);
    const std::vector<std::uint8_t> want = bytesOfHex(golden.serial);
    EXPECT_TRUE(std::equal(sent.bytes().begin(), sent.bytes().end(), want.begin(), want.end()))
        << golden.candump;
    FrameAssembler assembler;
    const auto got = feed(assembler, want);
    ASSERT_EQ(got.size(), 1U);
    EXPECT_EQ(got[0].error, FramingError::kNone);
    EXPECT_TRUE(same(got[0].frame, frame)) << golden.candump;
  }
}

TEST(CobsCodec, AnyFrameComesBackHoweverTheStreamIsSplit) {
  std::mt19937 random(3);
  FrameAssembler assembler;
  for (int i = 0; i < 3000; ++i) {
    BusFrame frame;
    frame.id = static_cast<std::uint16_t>(random() % 0x800);
    frame.size = static_cast<std::uint8_t>(random() % 9);
    for (std::size_t k = 0; k < frame.size; ++k)  // many zeros: they are what COBS is about
      frame.data[k] = static_cast<std::uint8_t>(random() % 2 == 0 ? 0 : random());
    const SerialFrame sent = encodeSerial(frame);
    ASSERT_LE(sent.size, kMaxCobs + 1);
    EXPECT_EQ(std::count(sent.bytes().begin(), sent.bytes().end(), 0), 1);
    std::vector<DecodedSerial> got;
    const std::size_t split = random() % sent.size;
    for (const auto part : {sent.bytes().first(split), sent.bytes().subspan(split)})
      assembler.push(part, [&got](const DecodedSerial& d) { got.push_back(d); });
    ASSERT_EQ(got.size(), 1U);
    ASSERT_EQ(got[0].error, FramingError::kNone);
    EXPECT_TRUE(same(got[0].frame, frame));
  }
}

TEST(CobsCodec, ACutFrameCostsItselfAndTheNextNothing) {
  FrameAssembler assembler;
  std::vector<std::uint8_t> bytes = bytesOfHex(testing::kReelGolden.serial);
  bytes.resize(6);
  bytes.push_back(0);
  const auto whole = bytesOfHex(testing::kRatesGolden.serial);
  bytes.insert(bytes.end(), whole.begin(), whole.end());
  const auto got = feed(assembler, bytes);
  ASSERT_EQ(got.size(), 2U);
  EXPECT_NE(got[0].error, FramingError::kNone);
  EXPECT_EQ(got[1].error, FramingError::kNone);
}

TEST(CobsCodec, NamesWhatIsWrong) {
  FrameAssembler assembler;
  auto bytes = bytesOfHex(testing::kReelGolden.serial);
  bytes[5] ^= 0x01;
  EXPECT_EQ(feed(assembler, bytes).at(0).error, FramingError::kCrc);
  EXPECT_EQ(feed(assembler, {0x09, 0x01, 0x02, 0x00}).at(0).error, FramingError::kCobs);
  EXPECT_EQ(feed(assembler, {0x03, 0x01, 0x02, 0x00}).at(0).error, FramingError::kLength);
  EXPECT_TRUE(feed(assembler, {0x00, 0x00}).empty());
  EXPECT_EQ(feed(assembler, std::vector<std::uint8_t>(100, 0x41)).size(), 0U);
  EXPECT_EQ(feed(assembler, {0x00}).at(0).error, FramingError::kTooLong);
  EXPECT_EQ(feed(assembler, bytesOfHex(testing::kReelGolden.serial)).at(0).error,
            FramingError::kNone);
}

TEST(CobsCodec, EveryFlippedBitIsNoticed) {
  for (const testing::GoldenFrame& golden : testing::kGoldenFrames) {
    const auto bytes = bytesOfHex(golden.serial);
    for (std::size_t bit = 0; bit < 8 * (bytes.size() - 1); ++bit) {
      auto bad = bytes;
      bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ (1U << (bit % 8)));
      FrameAssembler assembler;
      for (const DecodedSerial& got : feed(assembler, bad))
        EXPECT_NE(got.error, FramingError::kNone) << golden.candump << " bit " << bit;
    }
  }
}

}  // namespace
}  // namespace tautline::bus
