/// @file
/// Any bytes through the Fotokite codec. First input byte: where the rest is split for the second
/// pass.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <variant>

#include "common/error.h"
#include "drivers/fotokite_codec.h"

namespace tautline::fotokite {
namespace {

bool nearlyUnit(const Quaternion& q) {
  const double norm = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return std::abs(norm - 1.0) <= kQuaternionTolerance;
}

struct InRange {
  bool operator()(const Ignored&) const { return true; }
  bool operator()(const GroundStatus& v) const {
    return kRunTimeRange.contains(v.run_time) && kVoltageRange.contains(v.battery_voltage) &&
           kCountsRange.contains(v.length_counts);
  }
  bool operator()(const Attitude& v) const { return nearlyUnit(v.q); }
  bool operator()(const Gimbal& v) const { return nearlyUnit(v.q); }
  bool operator()(const Position& v) const {
    return kElevationRange.contains(v.elevation_from_vertical) &&
           kAzimuthRange.contains(v.azimuth) && kAltitudeRange.contains(v.altitude);
  }
  bool operator()(const FlightStatus& v) const {
    return kRunTimeRange.contains(v.on_time) && kVoltageRange.contains(v.backup_battery_voltage);
  }
};

struct Outcome {
  LineCounters counters;
  std::uint32_t lines{0};
  std::uint64_t hash{14695981039346656037U};  // of every line and its outcome

  void add(std::string_view line, LineError assembled) {
    TAUTLINE_CHECK(line.size() <= LineAssembler::kMaxLine);
    ParsedLine parsed;
    parsed.error = assembled;
    if (assembled == LineError::kNone) parsed = parseTelemetry(line);
    TAUTLINE_CHECK(parsed.error == LineError::kNone ||
                   std::holds_alternative<Ignored>(parsed.value));
    TAUTLINE_CHECK(std::visit(InRange{}, parsed.value));
    counters.count(parsed.error);
    ++lines;
    for (const char c : line) mix(static_cast<std::uint8_t>(c));
    mix(static_cast<std::uint8_t>(parsed.error));
    mix(static_cast<std::uint8_t>(parsed.kind));
  }

 private:
  void mix(std::uint8_t byte) { hash = (hash ^ byte) * 1099511628211U; }
};

void feed(LineAssembler& assembler, std::span<const std::uint8_t> bytes, Outcome& out) {
  assembler.push(bytes, [&out](std::string_view line, LineError error) { out.add(line, error); });
}

}  // namespace
}  // namespace tautline::fotokite

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tautline::fotokite;
  if (size == 0) return 0;
  const std::span<const std::uint8_t> bytes(data + 1, size - 1);

  LineAssembler assembler;
  Outcome whole;
  feed(assembler, bytes, whole);
  TAUTLINE_CHECK(whole.counters.good() + whole.counters.bad() == whole.lines);

  LineAssembler assembler_of_pieces;
  Outcome pieces;
  const std::size_t split = bytes.empty() ? 0 : data[0] % (bytes.size() + 1);
  feed(assembler_of_pieces, bytes.first(split), pieces);
  for (std::size_t i = split; i < bytes.size(); ++i)
    feed(assembler_of_pieces, bytes.subspan(i, 1), pieces);
  TAUTLINE_CHECK(pieces.hash == whole.hash && pieces.lines == whole.lines);
  return 0;
}
