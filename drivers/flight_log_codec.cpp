#include "drivers/flight_log_codec.h"

#include <algorithm>
#include <charconv>
#include <chrono>
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

}  // namespace

ParsedFlightLogRow parseFlightLogRow(std::string_view line) noexcept {
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
  FlightLogRow& row = out.row;
  row.p_WD = {value[4], value[5], value[6]};
  row.length = value[10];
  row.elevation = value[11];
  row.azimuth = value[12];
  if (count == kColumns) row.p_WA = {value[13], value[14], value[15]};
  bool good = kLogLengthRange.contains(row.length) && kLogElevationRange.contains(row.elevation) &&
              kLogAzimuthRange.contains(row.azimuth);
  for (int i = 0; i < 3; ++i)
    good =
        good && kLogPositionRange.contains(row.p_WD[i]) && kLogPositionRange.contains(row.p_WA[i]);
  return good ? out : fail(FlightLogError::kOutOfRange);
}

}  // namespace tautline
