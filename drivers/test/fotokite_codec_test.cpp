#include "drivers/fotokite_codec.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/fotokite_protocol.h"
#include "drivers/test/text_fields.h"

namespace tautline::fotokite {
namespace {

using testing::readTextLine;

const std::vector<std::string> kGoodLines{
    "!GSStatus 10,532.11,15.62,912", "!GSStatus 0,0.5,16,-3.0", "!Attitude 0.71,0.00,-0.02,0.70",
    "!Gimbal 0.98,0.00,-0.17,0.00",  "!Pos 0.78,-0.52,1.20",    "!FlightStatus 2,63.20,8.10,192",
};

// All numbers of an accepted line, in wire order.
std::vector<double> valuesOf(const ParsedLine& line) {
  struct Visitor {
    std::vector<double> operator()(const Ignored&) const { return {}; }
    std::vector<double> operator()(const GroundStatus& v) const {
      return {static_cast<double>(v.mode), v.run_time, v.battery_voltage, v.length_counts};
    }
    std::vector<double> operator()(const Attitude& v) const { return {v.q.w, v.q.x, v.q.y, v.q.z}; }
    std::vector<double> operator()(const Gimbal& v) const { return {v.q.w, v.q.x, v.q.y, v.q.z}; }
    std::vector<double> operator()(const Position& v) const {
      return {v.elevation_from_vertical, v.azimuth, v.altitude};
    }
    std::vector<double> operator()(const FlightStatus& v) const {
      return {static_cast<double>(v.mode), v.on_time, v.backup_battery_voltage,
              static_cast<double>(v.flags)};
    }
  };
  return std::visit(Visitor{}, line.value);
}

std::vector<Range> rangesOf(LineKind kind) {
  const Range component{-1.0 - kQuaternionTolerance, 1.0 + kQuaternionTolerance};
  switch (kind) {
    case LineKind::kGroundStatus:
      return {kModeRange, kRunTimeRange, kVoltageRange, kCountsRange};
    case LineKind::kAttitude:
    case LineKind::kGimbal:
      return {component, component, component, component};
    case LineKind::kPosition:
      return {kElevationRange, kAzimuthRange, kAltitudeRange};
    case LineKind::kFlightStatus:
      return {kModeRange, kRunTimeRange, kVoltageRange, kFlagsRange};
    case LineKind::kParam:
    case LineKind::kUnknown:
      break;
  }
  return {};
}

TEST(ParseTelemetry, ReadsEveryKindOfLine) {
  const LineKind kinds[] = {LineKind::kGroundStatus, LineKind::kGroundStatus,
                            LineKind::kAttitude,     LineKind::kGimbal,
                            LineKind::kPosition,     LineKind::kFlightStatus};
  for (std::size_t i = 0; i < kGoodLines.size(); ++i) {
    const ParsedLine got = parseTelemetry(kGoodLines[i]);
    EXPECT_EQ(got.error, LineError::kNone) << kGoodLines[i];
    EXPECT_EQ(got.kind, kinds[i]) << kGoodLines[i];
    EXPECT_EQ(valuesOf(got), readTextLine(kGoodLines[i])->fields) << kGoodLines[i];
  }
}

TEST(ParseTelemetry, KnowsAndIgnoresParameterAnswers) {
  for (const char* line : {"!Param 117,10.0", "!Param", "!Param some text"}) {
    const ParsedLine got = parseTelemetry(line);
    EXPECT_EQ(got.error, LineError::kNone) << line;
    EXPECT_TRUE(std::holds_alternative<Ignored>(got.value)) << line;
  }
}

TEST(ParseTelemetry, SaysWhatIsWrong) {
  struct Case {
    const char* line;
    LineError error;
    LineKind kind;
  };
  const Case cases[] = {
      {"", LineError::kNotTelemetry, LineKind::kUnknown},
      {"GSStatus 10,1,2,3", LineError::kNotTelemetry, LineKind::kUnknown},
      {"0.52,1.20", LineError::kNotTelemetry, LineKind::kUnknown},  // the rest of a cut line
      {"!", LineError::kUnknownHeader, LineKind::kUnknown},
      {"!Po 0.78,-0.52,1.20", LineError::kUnknownHeader, LineKind::kUnknown},
      {"!Pos,0.78,-0.52,1.20", LineError::kUnknownHeader, LineKind::kUnknown},
      {"!Pos", LineError::kNotANumber, LineKind::kPosition},
      {"!Pos ", LineError::kNotANumber, LineKind::kPosition},
      {"!Pos 0.78,-0.52", LineError::kFieldCount, LineKind::kPosition},
      {"!Pos 0.78,-0.52,1.20,4", LineError::kFieldCount, LineKind::kPosition},
      {"!Pos 0.78,-0.52,1.20,", LineError::kFieldCount, LineKind::kPosition},
      {"!Pos 0.78,,1.20", LineError::kNotANumber, LineKind::kPosition},
      {"!Pos 0.78,-0.5x,1.20", LineError::kNotANumber, LineKind::kPosition},
      {"!Pos  0.78,-0.52,1.20", LineError::kNotANumber, LineKind::kPosition},
      {"!Pos 0.78,-0.52,1.20!Pos 0.78,-0.52,1.20", LineError::kNotANumber, LineKind::kPosition},
      {"!Pos nan,-0.52,1.20", LineError::kOutOfRange, LineKind::kPosition},
      {"!Pos 0.78,inf,1.20", LineError::kOutOfRange, LineKind::kPosition},
      {"!Pos 0.78,-0.52,1e999", LineError::kOutOfRange, LineKind::kPosition},
      {"!Attitude 0.5,0,0,0.5", LineError::kOutOfRange, LineKind::kAttitude},  // not a rotation
      {"!Gimbal 0,0,0,0", LineError::kOutOfRange, LineKind::kGimbal},
      {"!FlightStatus 2.5,63.20,8.10,0", LineError::kNotANumber, LineKind::kFlightStatus},
      {"!FlightStatus 256,63.20,8.10,0", LineError::kOutOfRange, LineKind::kFlightStatus},
      {"!FlightStatus 2,63.20,8.10,65536", LineError::kOutOfRange, LineKind::kFlightStatus},
      {"!GSStatus 10,-1,15.62,912", LineError::kOutOfRange, LineKind::kGroundStatus},
  };
  for (const Case& c : cases) {
    const ParsedLine got = parseTelemetry(c.line);
    EXPECT_EQ(got.error, c.error) << c.line;
    EXPECT_EQ(got.kind, c.kind) << c.line;
    EXPECT_TRUE(std::holds_alternative<Ignored>(got.value)) << c.line;
  }
}

TEST(ParseTelemetry, AcceptsTheEndsOfEachRangeAndNothingBeyond) {
  for (const std::string& line : kGoodLines) {
    const LineKind kind = parseTelemetry(line).kind;
    if (kind == LineKind::kAttitude || kind == LineKind::kGimbal)
      continue;  // the norm decides there
    const auto good = *readTextLine(line);
    const std::vector<Range> ranges = rangesOf(kind);
    for (std::size_t field = 0; field < ranges.size(); ++field) {
      const auto with = [&](double value) {
        std::ostringstream out;
        out.precision(15);
        out << good.name;
        for (std::size_t i = 0; i < good.fields.size(); ++i) {
          out << (i == 0 ? ' ' : ',') << (i == field ? value : good.fields[i]);
        }
        return parseTelemetry(out.str()).error;
      };
      const double step = ranges[field].max - ranges[field].min > 100 ? 1.0 : 0.01;
      EXPECT_EQ(with(ranges[field].min), LineError::kNone) << line << " field " << field;
      EXPECT_EQ(with(ranges[field].max), LineError::kNone) << line << " field " << field;
      EXPECT_EQ(with(ranges[field].min - step), LineError::kOutOfRange)
          << line << " field " << field;
      EXPECT_EQ(with(ranges[field].max + step), LineError::kOutOfRange)
          << line << " field " << field;
    }
  }
}

std::string garbled(std::string line, std::mt19937& random) {
  const auto any = [&random](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n)(random);
  };
  const std::string likely = "0123456789.,-+!eE \r\0nif";
  for (std::size_t changes = 1 + any(3); changes > 0; --changes) {
    const std::size_t at = any(line.size());
    const char c = any(3) == 0 ? static_cast<char>(any(255)) : likely[any(likely.size() - 1)];
    switch (any(4)) {
      case 0:
        line.insert(at, 1, c);
        break;
      case 1:
        if (at < line.size()) line[at] = c;
        break;
      case 2:
        if (at < line.size()) line.erase(at, 1 + any(5));
        break;
      case 3:
        line.resize(at);  // cut, and the next one runs into it
        line += kGoodLines[any(kGoodLines.size() - 1)];
        break;
      default:
        line += line.substr(at);
        break;
    }
  }
  return line;
}

TEST(ParseTelemetry, NeverAcceptsAGarbledLineOutOfRange) {
  std::mt19937 random(20180205);
  int accepted = 0;
  int rejected = 0;
  for (int i = 0; i < 100000; ++i) {
    const std::string line =
        garbled(kGoodLines[static_cast<std::size_t>(i) % kGoodLines.size()], random);
    const ParsedLine got = parseTelemetry(line);
    if (got.error != LineError::kNone) {
      ++rejected;
      ASSERT_TRUE(std::holds_alternative<Ignored>(got.value)) << line;
      continue;
    }
    ++accepted;
    if (got.kind == LineKind::kParam) continue;
    const std::vector<double> values = valuesOf(got);
    const std::vector<Range> ranges = rangesOf(got.kind);
    ASSERT_EQ(values.size(), ranges.size()) << line;
    for (std::size_t k = 0; k < values.size(); ++k)
      ASSERT_TRUE(ranges[k].contains(values[k])) << line;
    const auto want = readTextLine(line);
    ASSERT_TRUE(want.has_value()) << line;
    ASSERT_EQ(values, want->fields) << line;
  }
  EXPECT_GT(accepted, 5000);  // the sweep reaches both outcomes
  EXPECT_GT(rejected, 50000);
}

struct Received {
  std::vector<std::string> lines;
  int too_long{0};
  bool operator==(const Received&) const = default;
};

void push(LineAssembler& assembler, std::string_view bytes, Received& out) {
  assembler.push(std::span(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()),
                 [&out](std::string_view line, LineError error) {
                   if (error == LineError::kTooLong) {
                     ++out.too_long;
                   } else {
                     out.lines.emplace_back(line);
                   }
                 });
}

TEST(LineAssembler, TakesBothLineEndsAndSkipsEmptyLines) {
  LineAssembler assembler;
  Received got;
  push(assembler, "one\ntwo\r\n\n\r\nthree\n\rfour\r\nunfinished", got);
  EXPECT_EQ(got.lines, (std::vector<std::string>{"one", "two", "three", "\rfour"}));
  EXPECT_EQ(got.too_long, 0);
  push(assembler, " business\n", got);
  EXPECT_EQ(got.lines.back(), "unfinished business");
}

TEST(LineAssembler, DiscardsAnOverlongLineAndIsWholeAgainAtTheNext) {
  LineAssembler assembler;
  Received got;
  const std::string longest(LineAssembler::kMaxLine, 'x');
  push(assembler, longest + "\n" + longest + "y\n" + std::string(100000, 'z') + "\nnext\n", got);
  EXPECT_EQ(got.lines, (std::vector<std::string>{longest, "next"}));
  EXPECT_EQ(got.too_long, 2);
}

TEST(LineAssembler, GivesTheSameLinesHoweverTheStreamIsSplit) {
  std::mt19937 random(7);
  std::string stream;
  for (int i = 0; i < 200; ++i) {
    stream += kGoodLines[random() % kGoodLines.size()];
    stream += random() % 2 == 0 ? "\r\n" : "\n";
    if (random() % 20 == 0) stream += std::string(random() % 400, '#');
    if (random() % 10 == 0) stream += std::string(1, '\0');
  }
  LineAssembler whole;
  Received want;
  push(whole, stream, want);
  ASSERT_GT(want.lines.size(), 150U);
  for (int trial = 0; trial < 200; ++trial) {
    LineAssembler assembler;
    Received got;
    const std::size_t largest = 1 + random() % 64;  // 1: a byte at a time
    for (std::size_t at = 0; at < stream.size();) {
      const std::size_t count = std::min(stream.size() - at, 1 + random() % largest);
      push(assembler, std::string_view(stream).substr(at, count), got);
      at += count;
    }
    ASSERT_EQ(got, want) << "pieces up to " << largest;
  }
}

TEST(LineAssembler, ForgetsAnUnfinishedLineOnReset) {
  LineAssembler assembler;
  Received got;
  push(assembler, "!Pos 0.7", got);
  assembler.reset();
  push(assembler, "!Pos 0.78,-0.52,1.20\n", got);
  EXPECT_EQ(got.lines, std::vector<std::string>{"!Pos 0.78,-0.52,1.20"});
}

TEST(LineCounters, CountsByKindAndInAll) {
  LineCounters counters;
  for (const LineError error :
       {LineError::kNone, LineError::kNone, LineError::kOutOfRange, LineError::kTooLong,
        LineError::kTooLong, LineError::kNotTelemetry}) {
    counters.count(error);
  }
  EXPECT_EQ(counters.good(), 2U);
  EXPECT_EQ(counters.bad(), 4U);
  EXPECT_EQ(counters[LineError::kTooLong], 2U);
  EXPECT_EQ(counters[LineError::kFieldCount], 0U);
}

// The text of a command through the independent parser, without its line end.
testing::TextLine parsed(const Command& command) {
  std::string text(command.text());
  EXPECT_EQ(text.back(), '\n');
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  text.pop_back();
  return readTextLine(text).value_or(testing::TextLine{});
}

TEST(FormatCommand, RoundTripsThroughAnIndependentParser) {
  constexpr double kRounding = 0.5e-6 + 1e-12;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 20000; ++i) {
    const double scale = std::pow(10.0, -8.0 * std::abs(unit(random)));  // small values too
    const double e = scale * kMaxElevationRate * unit(random);
    const double a = scale * kMaxAzimuthRate * unit(random);
    const double v = scale * kMaxReelRate * unit(random);
    const testing::TextLine pos2 = parsed(formatPos2(e, a, v));
    ASSERT_EQ(pos2.name, "Pos2");
    ASSERT_EQ(pos2.fields.size(), 3U);
    ASSERT_NEAR(pos2.fields[0], e, kRounding);
    ASSERT_NEAR(pos2.fields[1], a, kRounding);
    ASSERT_NEAR(pos2.fields[2], v, kRounding);

    const double g = scale * kMaxGimbalRate * unit(random);
    const testing::TextLine gimbal = parsed(formatGimbal(g, -g));
    ASSERT_EQ(gimbal.name, "Gimbal");
    ASSERT_NEAR(gimbal.fields.at(0), g, kRounding);
    ASSERT_NEAR(gimbal.fields.at(1), -g, kRounding);

    const testing::TextLine yaw = parsed(formatYaw(e));
    ASSERT_EQ(yaw.name, "Yaw");
    ASSERT_NEAR(yaw.fields.at(0), e, kRounding);
  }
}

TEST(FormatCommand, IsWrittenAsTheDeviceReadsIt) {
  EXPECT_EQ(formatPos2(0.1, -0.05, 120.0).text(), "Pos2 0.100000,-0.050000,120.000000\n");
  EXPECT_EQ(formatPos(0.0, 0.0, 0.0).text(), "Pos 0.000000,0.000000,0.000000\n");
  EXPECT_EQ(formatSetParameter(kTelemetryRateParameter, 10.0).text(), "Pset 117,10.0\n");
  EXPECT_EQ(formatSetParameter(kTetherControllerParameter, 1).text(), "Pset 79,1\n");
  EXPECT_EQ(formatLine(kTakeoffCommand).text(), "StartTakeoff\n");
  EXPECT_EQ(formatLine("").text(), "\n");
}

TEST(FormatCommand, ClampsToTheDevicesLimitsAndNeverSendsWhatIsNotANumber) {
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double sign : {1.0, -1.0}) {
    const testing::TextLine pos2 = parsed(formatPos2(sign * 9.0, sign * 9.0, sign * 1e300));
    EXPECT_EQ(pos2.fields, (std::vector<double>{sign * 0.25, sign * 0.2, sign * 10000.0}));
    EXPECT_EQ(parsed(formatYaw(sign)).fields, std::vector<double>{sign * 0.4});
    EXPECT_EQ(parsed(formatGimbal(sign, sign)).fields,
              (std::vector<double>{sign * 0.3, sign * 0.3}));
    for (const double bad : {sign * inf, sign * nan}) {
      EXPECT_EQ(parsed(formatPos2(bad, bad, bad)).fields, (std::vector<double>{0.0, 0.0, 0.0}));
      EXPECT_EQ(parsed(formatYaw(bad)).fields, std::vector<double>{0.0});
    }
  }
}

TEST(FormatCommand, NeverWritesANegativeZeroOrPastItsBuffer) {
  EXPECT_EQ(formatYaw(-1e-9).text(), "Yaw 0.000000\n");
  Command command;
  for (int i = 0; i < 100; ++i) command.append(-1e300, 6).append("text");
  EXPECT_EQ(command.text().size(), Command::kMaxSize);
}

}  // namespace
}  // namespace tautline::fotokite
