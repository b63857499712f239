/// @file
/// Any bytes through the serial framing of the Tautline bus and on through its messages. First
/// input byte: where the rest is split for the second pass.

#include <cstddef>
#include <cstdint>
#include <span>

#include "common/error.h"
#include "drivers/cobs_codec.h"

namespace tautline::bus {
namespace {

struct Outcome {
  FramingCounters counters;
  std::uint32_t frames{0};
  std::uint64_t hash{14695981039346656037U};

  void add(const DecodedSerial& d) {
    TAUTLINE_CHECK(d.frame.size <= kMaxData);
    counters.count(d.error);
    ++frames;
    mix(static_cast<std::uint8_t>(d.error));
    if (d.error != FramingError::kNone) return;
    for (const std::uint8_t byte : d.frame.bytes()) mix(byte);
    // What was accepted is exactly what the encoder would have sent.
    const SerialFrame again = encodeSerial(d.frame);
    const DecodedSerial back = decodeSerial(again.bytes().first(again.size - 1));
    TAUTLINE_CHECK(back.error == FramingError::kNone && back.frame.id == d.frame.id &&
                   back.frame.size == d.frame.size && back.frame.data == d.frame.data);
  }

 private:
  void mix(std::uint8_t byte) { hash = (hash ^ byte) * 1099511628211U; }
};

}  // namespace
}  // namespace tautline::bus

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tautline::bus;
  if (size == 0) return 0;
  const std::span<const std::uint8_t> bytes(data + 1, size - 1);
  const auto feed = [](FrameAssembler& assembler, std::span<const std::uint8_t> part,
                       Outcome& out) {
    assembler.push(part, [&out](const DecodedSerial& d) { out.add(d); });
  };
  FrameAssembler assembler;
  Outcome whole;
  feed(assembler, bytes, whole);
  TAUTLINE_CHECK(whole.counters.good() + whole.counters.bad() == whole.frames);

  FrameAssembler assembler_of_pieces;
  Outcome pieces;
  const std::size_t split = bytes.empty() ? 0 : data[0] % (bytes.size() + 1);
  feed(assembler_of_pieces, bytes.first(split), pieces);
  for (std::size_t i = split; i < bytes.size(); ++i)
    feed(assembler_of_pieces, bytes.subspan(i, 1), pieces);
  TAUTLINE_CHECK(pieces.hash == whole.hash && pieces.frames == whole.frames);
  return 0;
}
