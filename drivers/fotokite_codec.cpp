#include "drivers/fotokite_codec.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>

#include "drivers/fotokite_protocol.h"

namespace tautline::fotokite {
namespace {

// The fields behind a header. Remembers the first thing that is wrong; what is read after that does
// not count.
class Fields {
 public:
  explicit Fields(std::string_view text) noexcept : rest_(text) {}

  double number(const Range& range) noexcept {
    const std::string_view field = next();
    double value = 0.0;
    const char* const end = field.data() + field.size();
    const auto [stop, code] = std::from_chars(field.data(), end, value);
    if (code == std::errc::result_out_of_range) {
      fail(LineError::kOutOfRange);
    } else if (code != std::errc{} || stop != end) {
      fail(LineError::kNotANumber);
    } else if (!range.contains(value)) {  // also NaN and infinity, which from_chars accepts
      fail(LineError::kOutOfRange);
    }
    return value;
  }

  template <class Integer>
  Integer integer(const Range& range) noexcept {
    const double value = number(range);
    if (error_ != LineError::kNone) return 0;
    if (value != std::floor(value)) fail(LineError::kNotANumber);
    return static_cast<Integer>(value);
  }

  Quaternion quaternion() noexcept {
    const Range component{-1.0 - kQuaternionTolerance, 1.0 + kQuaternionTolerance};
    const double w = number(component);
    const double x = number(component);
    const double y = number(component);
    const double z = number(component);
    const double norm = std::sqrt(w * w + x * x + y * y + z * z);
    if (!(std::abs(norm - 1.0) <= kQuaternionTolerance)) fail(LineError::kOutOfRange);
    return {w, x, y, z};
  }

  // To be called last: anything left over is one field too many.
  [[nodiscard]] LineError finish() noexcept {
    if (more_) fail(LineError::kFieldCount);
    return error_;
  }

 private:
  std::string_view next() noexcept {
    if (!more_) {
      fail(LineError::kFieldCount);
      return {};
    }
    const std::size_t comma = rest_.find(',');
    const std::string_view field = rest_.substr(0, comma);
    more_ = comma != std::string_view::npos;
    rest_ = more_ ? rest_.substr(comma + 1) : std::string_view{};
    return field;
  }

  void fail(LineError error) noexcept {
    if (error_ == LineError::kNone) error_ = error;
  }

  std::string_view rest_;
  bool more_{true};
  LineError error_{LineError::kNone};
};

GroundStatus readGroundStatus(Fields& in) noexcept {
  GroundStatus out;
  out.mode = in.integer<std::uint8_t>(kModeRange);
  out.run_time = in.number(kRunTimeRange);
  out.battery_voltage = in.number(kVoltageRange);
  out.length_counts = in.number(kCountsRange);
  return out;
}

Position readPosition(Fields& in) noexcept {
  Position out;
  out.elevation_from_vertical = in.number(kElevationRange);
  out.azimuth = in.number(kAzimuthRange);
  out.altitude = in.number(kAltitudeRange);
  return out;
}

FlightStatus readFlightStatus(Fields& in) noexcept {
  FlightStatus out;
  out.mode = in.integer<std::uint8_t>(kModeRange);
  out.on_time = in.number(kRunTimeRange);
  out.backup_battery_voltage = in.number(kVoltageRange);
  out.flags = in.integer<std::uint16_t>(kFlagsRange);
  return out;
}

LineKind kindOf(std::string_view header) noexcept {
  if (header == kGroundStatusHeader) return LineKind::kGroundStatus;
  if (header == kAttitudeHeader) return LineKind::kAttitude;
  if (header == kGimbalHeader) return LineKind::kGimbal;
  if (header == kPositionHeader) return LineKind::kPosition;
  if (header == kFlightStatusHeader) return LineKind::kFlightStatus;
  if (header == kParamHeader) return LineKind::kParam;
  return LineKind::kUnknown;
}

double clampRate(double rate, double limit) noexcept {
  return std::isfinite(rate) ? std::clamp(rate, -limit, limit) : 0.0;
}

constexpr int kRateDecimals = 6;

Command formatMotion(std::string_view name, double elevation_rate, double azimuth_rate,
                     double reel) noexcept {
  Command out;
  out.append(name).append(' ');
  out.append(clampRate(elevation_rate, kMaxElevationRate), kRateDecimals).append(',');
  out.append(clampRate(azimuth_rate, kMaxAzimuthRate), kRateDecimals).append(',');
  out.append(clampRate(reel, kMaxReelRate), kRateDecimals).append('\n');
  return out;
}

}  // namespace

ParsedLine parseTelemetry(std::string_view line) noexcept {
  ParsedLine out;
  if (!line.starts_with('!')) {
    out.error = LineError::kNotTelemetry;
    return out;
  }
  const std::size_t space = line.find(' ');
  out.kind = kindOf(line.substr(0, space));
  Fields fields(space == std::string_view::npos ? std::string_view{} : line.substr(space + 1));
  switch (out.kind) {
    case LineKind::kUnknown:
      out.error = LineError::kUnknownHeader;
      return out;
    case LineKind::kParam:
      return out;
    case LineKind::kGroundStatus:
      out.value = readGroundStatus(fields);
      break;
    case LineKind::kAttitude:
      out.value = Attitude{fields.quaternion()};
      break;
    case LineKind::kGimbal:
      out.value = Gimbal{fields.quaternion()};
      break;
    case LineKind::kPosition:
      out.value = readPosition(fields);
      break;
    case LineKind::kFlightStatus:
      out.value = readFlightStatus(fields);
      break;
  }
  out.error = fields.finish();
  if (out.error != LineError::kNone) out.value = Ignored{};
  return out;
}

std::uint32_t LineCounters::bad() const noexcept {
  return std::accumulate(of.begin(), of.end(), std::uint32_t{0}) - good();
}

std::span<const std::uint8_t> Command::bytes() const noexcept {
  return {reinterpret_cast<const std::uint8_t*>(buffer_.data()), size_};
}

Command& Command::append(std::string_view text) noexcept {
  const std::size_t count = std::min(text.size(), buffer_.size() - size_);
  std::copy_n(text.data(), count, buffer_.data() + size_);
  size_ += count;
  return *this;
}

Command& Command::append(double value, int decimals) noexcept {
  constexpr double kLargest = 1e9;
  std::int64_t scale = 1;
  for (int i = 0; i < decimals; ++i) scale *= 10;

  const double bounded = std::isnan(value) ? 0.0 : std::clamp(value, -kLargest, kLargest);
  const std::int64_t scaled = std::llround(bounded * static_cast<double>(scale));
  if (scaled < 0) append('-');

  std::array<char, 20> digits{};
  const std::int64_t magnitude = std::abs(scaled);
  const auto whole = std::to_chars(digits.data(), digits.data() + digits.size(), magnitude / scale);
  append(std::string_view(digits.data(), static_cast<std::size_t>(whole.ptr - digits.data())));
  if (decimals == 0) return *this;

  append('.');
  for (std::int64_t place = scale / 10; place > 0; place /= 10) {
    append(static_cast<char>('0' + magnitude / place % 10));
  }
  return *this;
}

Command formatPos(double elevation_rate, double azimuth_rate,
                  double length_change_counts) noexcept {
  return formatMotion(kPosCommand, elevation_rate, azimuth_rate, length_change_counts);
}

Command formatPos2(double elevation_rate, double azimuth_rate, double reel_counts_per_s) noexcept {
  return formatMotion(kPos2Command, elevation_rate, azimuth_rate, reel_counts_per_s);
}

Command formatYaw(double yaw_rate) noexcept {
  Command out;
  out.append(kYawCommand).append(' ');
  out.append(clampRate(yaw_rate, kMaxYawRate), kRateDecimals).append('\n');
  return out;
}

Command formatGimbal(double pitch_rate, double roll_rate) noexcept {
  Command out;
  out.append(kGimbalCommand).append(' ');
  out.append(clampRate(pitch_rate, kMaxGimbalRate), kRateDecimals).append(',');
  out.append(clampRate(roll_rate, kMaxGimbalRate), kRateDecimals).append('\n');
  return out;
}

Command formatSetParameter(int id, double value) noexcept {
  Command out;
  out.append(kSetParameterCommand)
      .append(' ')
      .append(id, 0)
      .append(',')
      .append(value, 1)
      .append('\n');
  return out;
}

Command formatSetParameter(int id, int value) noexcept {
  Command out;
  out.append(kSetParameterCommand)
      .append(' ')
      .append(id, 0)
      .append(',')
      .append(value, 0)
      .append('\n');
  return out;
}

Command formatLine(std::string_view text) noexcept {
  Command out;
  out.append(text).append('\n');
  return out;
}

}  // namespace tautline::fotokite
