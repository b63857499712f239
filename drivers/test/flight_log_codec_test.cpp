#include "drivers/flight_log_codec.h"

#include <random>
#include <string>

#include <gtest/gtest.h>

namespace tautline {
namespace {

// Rows as the published flights have them, uninitialized numbers included.
const std::string kRow =
    "20180205174015 0.172676 0.657591 0.172607 0.00370414 0.5108 0.0033 0.696742 1.21992 -0.785194 "
    "0.5075 1.57 -0.52 0.0033 0.0033 0.0033 6.95321e-310 1.08694e-322 2.37152e+231 0.4 0.280649 1 ";

std::string replaced(std::size_t column, const std::string& with) {
  std::string out;
  std::size_t at = 0;
  for (std::size_t i = 0; i < 22; ++i) {
    const std::size_t end = kRow.find(' ', at);
    out += (i == column ? with : kRow.substr(at, end - at)) + " ";
    at = end + 1;
  }
  return out;
}

TEST(FlightLogCodec, ReadsTheColumnsThatAreUsed) {
  const ParsedFlightLogRow parsed = parseFlightLogRow(kRow);
  ASSERT_EQ(parsed.error, FlightLogError::kNone);
  EXPECT_EQ(parsed.row.second, 1517852415);  // 2018-02-05T17:40:15Z
  EXPECT_TRUE(parsed.row.p_WD.isApprox(Eigen::Vector3d(0.00370414, 0.5108, 0.0033)));
  EXPECT_EQ(parsed.row.length, 0.5075);
  EXPECT_EQ(parsed.row.elevation, 1.57);
  EXPECT_EQ(parsed.row.azimuth, -0.52);
  EXPECT_TRUE(parsed.row.p_WTarget.isApprox(Eigen::Vector3d(0.172676, 0.657591, 0.172607)));
  EXPECT_EQ(parsed.row.target_length, 0.696742);
  EXPECT_EQ(parsed.row.target_elevation, 1.21992);
  EXPECT_EQ(parsed.row.target_azimuth, -0.785194);
  EXPECT_EQ(parsed.row.acceptance_radius, 0.4);
  EXPECT_TRUE(parsed.row.reached);
  EXPECT_TRUE(parsed.row.p_WA.isApprox(Eigen::Vector3d::Constant(0.0033)));
  EXPECT_EQ(parseFlightLogRow(kRow + "\r").error, FlightLogError::kNone);
}

TEST(FlightLogCodec, ReadsTheEarlierRowsWithoutContact) {
  const ParsedFlightLogRow parsed = parseFlightLogRow(
      "20180130201920 1 1 1 0.5 0.6 0.7 1.7 0.6 -0.8 1.6 0.99 -0.72 6.9e-310 6.9e-310 6.9e-310 0.4 "
      "1 0");
  ASSERT_EQ(parsed.error, FlightLogError::kNone);
  EXPECT_EQ(parsed.row.length, 1.6);
  EXPECT_TRUE(parsed.row.p_WA.isZero());
}

TEST(FlightLogCodec, ReadsTheEarliestRowsWithThePositionLast) {
  const ParsedFlightLogRow parsed = parseFlightLogRow(
      "20180130185438 0.165 1.33 0.165 1.40209 nan 0.785398 0.76328 1.27 -0.6 0.186646 0.729009 "
      "0.127691 4.9e-324 4.9e-324 6.9e-310 1 0.602536 1 ",
      FlightLogLayout::kPositionLast);
  ASSERT_EQ(parsed.error, FlightLogError::kNone);
  EXPECT_EQ(parsed.row.target_length, 1.40209);
  EXPECT_EQ(parsed.row.length, 0.76328);
  EXPECT_EQ(parsed.row.elevation, 1.27);
  EXPECT_EQ(parsed.row.azimuth, -0.6);
  EXPECT_TRUE(parsed.row.p_WD.isApprox(Eigen::Vector3d(0.186646, 0.729009, 0.127691)));
  EXPECT_EQ(parsed.row.acceptance_radius, 1.0);
  EXPECT_TRUE(parsed.row.reached);
}

TEST(FlightLogCodec, NamesWhatIsWrong) {
  EXPECT_EQ(parseFlightLogRow("").error, FlightLogError::kFieldCount);
  EXPECT_EQ(parseFlightLogRow(kRow + "1").error, FlightLogError::kFieldCount);
  EXPECT_EQ(parseFlightLogRow(kRow.substr(0, 100)).error, FlightLogError::kFieldCount);
  EXPECT_EQ(parseFlightLogRow(replaced(0, "20181305174015")).error, FlightLogError::kNotANumber);
  EXPECT_EQ(parseFlightLogRow(replaced(0, "201801051740")).error, FlightLogError::kNotANumber);
  EXPECT_EQ(parseFlightLogRow(replaced(8, "1.2x")).error, FlightLogError::kNotANumber);
  EXPECT_EQ(parseFlightLogRow(replaced(10, "-0.1")).error, FlightLogError::kOutOfRange);
  EXPECT_EQ(parseFlightLogRow(replaced(11, "nan")).error, FlightLogError::kOutOfRange);
  EXPECT_EQ(parseFlightLogRow(replaced(12, "7")).error, FlightLogError::kOutOfRange);
  EXPECT_EQ(parseFlightLogRow(replaced(12, "1e+231")).error, FlightLogError::kUninitialized);
  EXPECT_EQ(parseFlightLogRow(replaced(4, "6.9e-310")).error, FlightLogError::kUninitialized);
  EXPECT_EQ(parseFlightLogRow(replaced(8, "nan")).error, FlightLogError::kNone);
  EXPECT_EQ(parseFlightLogRow(replaced(14, "1e999")).error, FlightLogError::kOutOfRange);
  EXPECT_EQ(parseFlightLogRow(replaced(17, "1e999")).error, FlightLogError::kNone);
}

TEST(FlightLogCodec, AnyBytesAreAllowed) {
  std::mt19937 random(9);
  for (int i = 0; i < 20000; ++i) {
    std::string line = kRow;
    for (int k = 0; k < 3; ++k) line[random() % line.size()] = static_cast<char>(random());
    const ParsedFlightLogRow parsed = parseFlightLogRow(line);
    const bool in_range = kLogElevationRange.contains(parsed.row.elevation) &&
                          kLogLengthRange.contains(parsed.row.length);
    EXPECT_TRUE(parsed.error != FlightLogError::kNone || in_range) << line;
  }
}

}  // namespace
}  // namespace tautline
