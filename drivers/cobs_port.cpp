#include "drivers/cobs_port.h"

#include "drivers/link_monitor.h"

namespace tautline {

using bus::DecodedSerial;
using bus::FramingError;

void CobsPort::poll(Time now) noexcept {
  bytes_.poll(now);
  now_ = now;
  budget_ = kFramesPerCycle;
  const std::uint32_t reconnects = bytes_.counters().reconnects;
  if (reconnects == reconnects_seen_) return;
  reconnects_seen_ = reconnects;
  assembler_.reset();  // a frame that the loss has cut must not run into the next
}

bool CobsPort::read(BusFrame& out) noexcept {
  if (budget_ == 0) return false;
  if (first_ == last_) fill();
  if (first_ == last_) return false;
  --budget_;
  out = waiting_[first_++];
  out.time = now_;
  return true;
}

/// Reads pieces until one has a frame, or nothing is there; noise costs budget too.
void CobsPort::fill() noexcept {
  first_ = last_ = 0;
  std::array<std::uint8_t, kPiece> piece;
  while (last_ == 0 && budget_ > 0) {
    const ReadResult got = bytes_.read(piece);
    if (got.count == 0) return;
    const std::span<const std::uint8_t> bytes(piece.data(), got.count);
    text_bytes_ += countText(bytes);
    assembler_.push(bytes, [this](const DecodedSerial& decoded) {
      framing_.count(decoded.error);
      if (decoded.error == FramingError::kNone && last_ < waiting_.size())
        waiting_[last_++] = decoded.frame;
    });
    if (last_ == 0) --budget_;
  }
}

bool CobsPort::write(const BusFrame& frame) noexcept {
  return bytes_.write(bus::encodeSerial(frame).bytes()).accepted;
}

FrameCounters CobsPort::frameCounters() const noexcept {
  FrameCounters out;
  out.frames_in = framing_.good();
  out.frames_bad = framing_.bad();
  return out;
}

}  // namespace tautline
