#include "drivers/flight_log_codec.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>

namespace tautline {
namespace {

constexpr std::size_t kColumns = 22;
constexpr std::size_t kColumnsWithoutContact = 19;
constexpr std::string_view kBlanks = " \t\r";

/// "20180205174014"; nothing for what is no date.
std::optional<std::int64_t> secondOf(std::string_view stamp) noexcept {
  constexpr std::size_t kDigits = 14;
  std::int64_t number = 0;
  const char* const end = stamp.data() + stamp.size();
  const auto done = std::from_chars(stamp.data(), end, number);
  if (stamp.size() != kDigits || done.ec != std::errc{} || done.ptr != end || number < 0)
    return std::nullopt;
  const auto take = [&number](std::int64_t base) {
    const std::int64_t part = number % base;
    number /= base;
    return static_cast<int>(part);
  };
  const int second = take(100);
  const int minute = take(100);
  const int hour = take(100);
  const int day = take(100);
  const int month = take(100);
  const std::chrono::year_month_day date{std::chrono::year(static_cast<int>(number)),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!date.ok() || hour > 23 || minute > 59 || second > 60) return std::nullopt;
  const std::chrono::sys_seconds time = std::chrono::sys_days(date) + std::chrono::hours(hour) +
                                        std::chrono::minutes(minute) + std::chrono::seconds(second);
  return time.time_since_epoch().count();
}

/// NaN is set: a result, if no good one.
bool isSet(double value) noexcept {
  constexpr double kBeyond = 1e100;
  return std::fpclassify(value) != FP_SUBNORMAL && !(std::abs(value) > kBeyond);
}

}  // namespace

ParsedFlightLogRow parseFlightLogRow(std::string_view line, FlightLogLayout layout) noexcept {
  ParsedFlightLogRow out;
  std::array<double, kColumns> value{};
  std::size_t count = 0;
  const auto fail = [&out](FlightLogError error) {
    out.error = error;
    return out;
  };
  for (std::size_t at = line.find_first_not_of(kBlanks); at != std::string_view::npos;
       at = line.find_first_not_of(kBlanks, at)) {
    const std::size_t end = std::min(line.find_first_of(kBlanks, at), line.size());
    const std::string_view field = line.substr(at, end - at);
    at = end;
    if (count == kColumns) return fail(FlightLogError::kFieldCount);
    if (count == 0) {
      const auto second = secondOf(field);
      if (!second) return fail(FlightLogError::kNotANumber);
      out.row.second = *second;
    } else {
      const auto done = std::from_chars(field.data(), field.data() + field.size(), value[count]);
      // A number that no double holds is a number, and in no range.
      const bool held = done.ec == std::errc{};
      const bool number = held || done.ec == std::errc::result_out_of_range;
      if (!held) value[count] = std::numeric_limits<double>::quiet_NaN();
      if (!number || done.ptr != field.data() + field.size())
        return fail(FlightLogError::kNotANumber);
    }
    ++count;
  }
  if (count != kColumns && count != kColumnsWithoutContact)
    return fail(FlightLogError::kFieldCount);
  const bool has_contact = count == kColumns;
  const bool last = layout == FlightLogLayout::kPositionLast && !has_contact;
  const auto point = [&value](std::size_t at) {
    return Eigen::Vector3d(value[at], value[at + 1], value[at + 2]);
  };
  const std::size_t target = last ? 4 : 7;
  const std::size_t present = last ? 7 : 10;
  FlightLogRow& row = out.row;
  row.p_WTarget = point(1);
  row.target_length = value[target];
  row.target_elevation = value[target + 1];
  row.target_azimuth = value[target + 2];
  row.acceptance_radius = value[count - 3];
  row.reached = value[count - 1] != 0.0;
  row.p_WD = point(last ? 10 : 4);
  row.length = value[present];
  row.elevation = value[present + 1];
  row.azimuth = value[present + 2];
  if (has_contact) row.p_WA = point(13);
  bool set = isSet(row.length) && isSet(row.elevation) && isSet(row.azimuth);
  bool good = kLogLengthRange.contains(row.length) && kLogElevationRange.contains(row.elevation) &&
              kLogAzimuthRange.contains(row.azimuth);
  for (int i = 0; i < 3; ++i) {
    set = set && isSet(row.p_WD[i]) && isSet(row.p_WA[i]);
    good =
        good && kLogPositionRange.contains(row.p_WD[i]) && kLogPositionRange.contains(row.p_WA[i]);
  }
  if (!set) return fail(FlightLogError::kUninitialized);
  return good ? out : fail(FlightLogError::kOutOfRange);
}

}  // namespace tautline
