#include "sim_hil/tautline_wire.h"

#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tautline::sim {
namespace {

/// 200#2C017D3078E8435B: rates 0.3 m/s, 0.1, -0.05 and 0.2 rad/s.
TautlineFrame rates() { return {0x200, 8, {0x2C, 0x01, 0x7D, 0x30, 0x78, 0xE8, 0x43, 0x5B}}; }

std::string hexOf(const WireBytes& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes.bytes()) {
    std::array<char, 3> digits{};
    std::snprintf(digits.data(), digits.size(), "%02X", byte);
    text += digits.data();
  }
  return text;
}

struct Heard {
  std::vector<TautlineFrame> frames;
  std::string replies;
};

Heard hear(WireParser& parser, std::span<const std::uint8_t> bytes) {
  Heard heard;
  parser.push(
      bytes, [&](const TautlineFrame& frame) { heard.frames.push_back(frame); },
      [&](std::span<const std::uint8_t> reply) {
        heard.replies.append(reply.begin(), reply.end());
      });
  return heard;
}

Heard hear(WireParser& parser, const std::string& text) {
  return hear(parser, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

TEST(TautlineWire, EncodesGoldenFrames) {
  EXPECT_EQ(hexOf(encodeFrame(Wire::kCobs, rates())), "010D02082C017D3078E8435BD28B00");
  EXPECT_EQ(hexOf(encodeFrame(Wire::kCobs, {0x210, 7, {0, 0, 0, 0, 0, 0, 0xCA}})),
            "04100207010101010104CAD60C00");
  const WireBytes slcan = encodeFrame(Wire::kSlcan, rates());
  EXPECT_EQ(std::string(slcan.bytes().begin(), slcan.bytes().end()), "t20082C017D3078E8435B\r");
  EXPECT_EQ(encodeFrame(Wire::kCanFrame, rates()).size, 16U);
}

TEST(TautlineWire, AnyFrameComesBackOnEveryWireByteByByte) {
  std::mt19937 random(5);
  for (const Wire wire : {Wire::kCobs, Wire::kSlcan, Wire::kCanFrame}) {
    WireParser parser(wire);
    for (int i = 0; i < 2000; ++i) {
      TautlineFrame frame;
      frame.id = static_cast<std::uint16_t>(random() % 0x800);
      frame.size = static_cast<std::uint8_t>(random() % 9);
      for (std::size_t k = 0; k < frame.size; ++k)
        frame.data[k] = static_cast<std::uint8_t>(random() % 3 == 0 ? 0 : random());
      const WireBytes sent = encodeFrame(wire, frame);
      std::vector<TautlineFrame> got;
      for (const std::uint8_t byte : sent.bytes()) {
        for (const TautlineFrame& f : hear(parser, std::span(&byte, 1)).frames) got.push_back(f);
      }
      ASSERT_EQ(got.size(), 1U) << static_cast<int>(wire) << " " << hexOf(sent);
      EXPECT_EQ(got[0].id, frame.id);
      EXPECT_EQ(got[0].size, frame.size);
      EXPECT_EQ(got[0].data, frame.data);
    }
    EXPECT_EQ(parser.bad(), 0U);
  }
}

TEST(TautlineWire, NoiseIsCountedAndTheNextFrameIsWhole) {
  WireParser cobs(Wire::kCobs);
  const WireBytes good = encodeFrame(Wire::kCobs, rates());
  EXPECT_TRUE(hear(cobs, std::string("\x05noise and more noise, much longer than a frame can be") +
                             std::string(1, '\0'))
                  .frames.empty());
  EXPECT_EQ(hear(cobs, good.bytes()).frames.size(), 1U);
  EXPECT_EQ(cobs.bad(), 1U);
  WireParser slcan(Wire::kSlcan);
  EXPECT_TRUE(hear(slcan, "t20Z8\rt9001FF\rt2009\r").frames.empty());
  EXPECT_EQ(slcan.bad(), 3U);
  EXPECT_EQ(hear(slcan, "t2001FF\r").frames.size(), 1U);
}

TEST(TautlineWire, AnswersTheCommandsOfASlcanClient) {
  WireParser parser(Wire::kSlcan);
  EXPECT_EQ(hear(parser, "C\rS6\rO\r").replies, "\r\r\r");
  EXPECT_EQ(hear(parser, "V\r").replies, "V1013\r");
  EXPECT_EQ(parser.bad(), 0U);
}

}  // namespace
}  // namespace tautline::sim
