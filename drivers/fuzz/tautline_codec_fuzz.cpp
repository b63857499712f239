/// @file
/// Any frames through the messages of the Tautline bus and their end-to-end check. The input is a
/// row of frames: identifier (low byte, high byte), size, data.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>

#include "common/error.h"
#include "drivers/tautline_codec.h"

namespace tautline::bus {
namespace {

/// Accepted values are in range, and encoding them gives values that are accepted again.
struct Accepted {
  std::uint8_t alive;

  void operator()(const std::monostate&) const {}
  template <class T>
  void operator()(const T& value) const {
    check(value);
    const Parsed again = parse(encode(value, alive));
    TAUTLINE_CHECK(again.error == MessageError::kNone && again.alive == alive);
    TAUTLINE_CHECK(std::holds_alternative<T>(again.value));
  }

  static void check(const Reel& v) { TAUTLINE_CHECK(v.tension >= 0.0 && std::abs(v.speed) < 8.2); }
  static void check(const Angles& v) { TAUTLINE_CHECK(kElevationRange.contains(v.elevation)); }
  static void check(const Attitude& v) {
    const double norm = std::sqrt(v.w * v.w + v.x * v.x + v.y * v.y + v.z * v.z);
    TAUTLINE_CHECK(std::abs(norm - 1.0) <= kQuaternionTolerance);
  }
  static void check(const VehicleStatus& v) {
    TAUTLINE_CHECK(v.mode >= FlightMode::kIdle && v.mode <= FlightMode::kFault);
  }
  static void check(const Rates& v) { TAUTLINE_CHECK(std::isfinite(v.length + v.elevation)); }
  static void check(const ModeCommand& v) { TAUTLINE_CHECK(v.mode <= BusMode::kStop); }
};

}  // namespace
}  // namespace tautline::bus

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tautline;
  using namespace tautline::bus;
  std::span<const std::uint8_t> rest(data, size);
  EndToEndCheck check;
  Time now{};
  while (rest.size() >= 3) {
    BusFrame frame;
    frame.id = static_cast<std::uint16_t>(rest[0] | (rest[1] & 0x7U) << 8U);
    frame.size = static_cast<std::uint8_t>(rest[2] % (kMaxData + 1));
    rest = rest.subspan(3);
    const std::size_t count = std::min<std::size_t>(frame.size, rest.size());
    std::copy_n(rest.begin(), count, frame.data.begin());
    rest = rest.subspan(count);

    Parsed parsed = parse(frame);
    TAUTLINE_CHECK((parsed.error == MessageError::kNone) ==
                   !std::holds_alternative<std::monostate>(parsed.value));
    if (parsed.error == MessageError::kCrc) {
      // No fuzzer guesses a CRC: with the right one, the values behind it are reached too.
      frame.data[frame.size - 1U] = crc8(frame.id, frame.bytes().first(frame.size - 1U));
      parsed = parse(frame);
      TAUTLINE_CHECK(parsed.error == MessageError::kNone ||
                     parsed.error == MessageError::kOutOfRange);
    }
    std::visit(Accepted{parsed.alive}, parsed.value);

    now += std::chrono::milliseconds(10);
    const EndToEnd result = check.check(now, parsed);
    TAUTLINE_CHECK(result != EndToEnd::kOk || parsed.error == MessageError::kNone);
    TAUTLINE_CHECK(check.check(now, parsed) != EndToEnd::kOk);  // the same frame twice
  }
  return 0;
}
