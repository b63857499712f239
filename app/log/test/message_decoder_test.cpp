// The one decoder against lcm-gen's own encoder, and against bytes that nobody encoded.

#include "app/log/message_decoder.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tautline/estimate_t.hpp>
#include <tautline/mission_chunk_t.hpp>
#include <tautline_test/everything_t.hpp>

#include "lcmtypes/message_table.h"

namespace tautline {

[[nodiscard]] MessageTable testMessageTable();

namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

template <class Message>
Bytes encoded(const Message& message) {
  Bytes bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

tautline_test::everything_t everything() {
  tautline_test::everything_t m{};
  m.small = -7;
  m.octet = 250;
  m.medium = -30000;
  m.second_medium = 12;
  m.count = 2;
  m.large = std::numeric_limits<std::int64_t>::min();
  m.single = 0.25F;
  m.exact = -1.0 / 3.0;
  m.flag = 1;
  m.text = "a, \"b\"\nc";
  for (int i = 0; i < 6; ++i) m.matrix[i / 3][i % 3] = i + 0.5;
  m.list = {5, -6};
  m.names[0] = "";
  m.names[1] = "second";
  m.part.number = 1;
  m.part.name = "one";
  m.parts.resize(2);
  m.parts[0].number = 20;
  m.parts[1].name = "twenty-one";
  m.pair[1].number = 31;
  return m;
}

const MessageInfo& infoOf(const Bytes& bytes) {
  const MessageInfo* info = findMessage(bytes, testMessageTable());
  EXPECT_NE(info, nullptr);
  return *info;
}

TEST(MessageDecoder, EveryKindOfField) {
  const Bytes bytes = encoded(everything());
  const MessageInfo& info = infoOf(bytes);
  EXPECT_STREQ(info.name, "tautline_test.everything_t");
  const auto m = decode(info, bytes);
  ASSERT_TRUE(m);
  EXPECT_EQ(m->dump(),
            R"({"small":-7,"octet":250,"medium":-30000,"second_medium":12,"count":2,)"
            R"("large":-9223372036854775808,"single":0.25,"exact":-0.3333333333333333,"flag":true,)"
            R"("text":"a, \"b\"\nc","matrix":[[0.5,1.5,2.5],[3.5,4.5,5.5]],"list":[5,-6],)"
            R"("names":["","second"],"part":{"number":1,"name":"one"},)"
            R"("parts":[{"number":20,"name":""},{"number":0,"name":"twenty-one"}],)"
            R"("pair":[{"number":0,"name":""},{"number":31,"name":""}]})");
}

TEST(MessageDecoder, CommentsAreThoseOfTheFile) {
  const auto& fields = infoOf(encoded(everything())).fields;
  EXPECT_STREQ(fields[0].comment, "with a comment; and a second sentence");
  EXPECT_STREQ(fields[9].comment, "\"quoted\" \\ text");
  EXPECT_STREQ(fields[1].comment, "");
}

TEST(MessageDecoder, FlatFieldsAreAsManyWhateverTheLengths) {
  tautline_test::everything_t m = everything();
  const Bytes bytes = encoded(m);
  const auto flat = flatten(infoOf(bytes), *decode(infoOf(bytes), bytes));
  std::vector<std::string> names;
  for (const FlatField& field : flat) names.push_back(field.name);
  EXPECT_THAT(names,
              ElementsAre("small", "octet", "medium", "second_medium", "count", "large", "single",
                          "exact", "flag", "text", "matrix[0][0]", "matrix[0][1]", "matrix[0][2]",
                          "matrix[1][0]", "matrix[1][1]", "matrix[1][2]", "list", "names[0]",
                          "names[1]", "part.number", "part.name", "parts", "pair[0].number",
                          "pair[0].name", "pair[1].number", "pair[1].name"));
  EXPECT_EQ(flat[9].value, "a, \"b\"\nc");
  EXPECT_EQ(flat[16].value, "[5,-6]");
  m.count = 0;
  m.list.clear();
  m.parts.clear();
  const Bytes fewer = encoded(m);
  EXPECT_EQ(flatten(infoOf(fewer), *decode(infoOf(fewer), fewer)).size(), flat.size());
}

// Whatever length is cut or byte is changed: decoded or not, never more. Run under the sanitizers.
TEST(MessageDecoder, NoBytesAreTrusted) {
  const Bytes bytes = encoded(everything());
  const MessageInfo& info = infoOf(bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(decode(info, std::span(bytes).first(size))) << size;
  Bytes longer = bytes;
  longer.push_back(0);
  EXPECT_FALSE(decode(info, longer));
  int decoded = 0;
  for (std::size_t at = 8; at < bytes.size(); ++at) {
    for (const std::uint8_t value : Bytes{0x00, 0x01, 0x7F, 0x80, 0xFF}) {
      Bytes changed = bytes;
      changed[at] = value;
      if (const auto m = decode(info, changed)) {
        ++decoded;
        EXPECT_FALSE(flatten(info, *m).empty());
      }
    }
  }
  EXPECT_GT(decoded, 0);
}

TEST(MessageDecoder, AHugeLengthCostsNothing) {
  Bytes bytes = encoded(everything());
  const std::size_t count = 8 + 1 + 1 + 2 + 2;  // fingerprint and what is in front of `count`
  for (std::size_t i = 0; i < 4; ++i) bytes[count + i] = i == 0 ? 0x7F : 0xFF;
  EXPECT_FALSE(decode(infoOf(bytes), bytes));
}

TEST(MessageDecoder, TheProjectsOwnTypes) {
  estimate_t m{};
  m.utime = 1'700'000'000'000'001;
  m.valid = 1;
  m.position_m[1] = 1.25;
  m.nis = std::numeric_limits<double>::quiet_NaN();
  const Bytes bytes = encoded(m);
  const MessageInfo* info = findMessage(bytes);
  ASSERT_NE(info, nullptr);
  EXPECT_STREQ(info->name, "tautline.estimate_t");
  const auto decoded = decode(*info, bytes);
  ASSERT_TRUE(decoded);
  EXPECT_EQ((*decoded)["utime"], 1'700'000'000'000'001);
  EXPECT_EQ((*decoded)["valid"], true);
  EXPECT_EQ((*decoded)["position_m"][1], 1.25);
  EXPECT_THAT(decoded->dump(), HasSubstr("\"nis\":null"));
  EXPECT_EQ(flatten(*info, *decoded).back().value, "nan");
  EXPECT_TRUE(decode(*findMessage(encoded(mission_chunk_t{})), encoded(mission_chunk_t{})));
  EXPECT_GE(messageTable().size(), 14U);
}

TEST(MessageDecoder, UnknownTypesAreNotFound) {
  EXPECT_EQ(findMessage(Bytes(100, 0xAB)), nullptr);
  EXPECT_EQ(findMessage(Bytes(7, 0)), nullptr);
  EXPECT_EQ(findMessage({}), nullptr);
}

}  // namespace
}  // namespace tautline
