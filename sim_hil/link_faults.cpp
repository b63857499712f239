#include "sim_hil/link_faults.h"

#include <algorithm>
#include <cmath>

namespace tautline::sim {
namespace {

constexpr double kBurst = 64.0;  // bytes that a slow line may have saved up

std::uint8_t randomByte(Random& random) noexcept {
  return static_cast<std::uint8_t>(128.0 * (1.0 + random.signedUniform()));
}

}  // namespace

const Fault* FaultyLink::active(FaultMode mode, const FaultSchedule& faults) const noexcept {
  if (const Fault* f = faults.active(FaultTarget::kVehicleLink, mode)) return f;
  return uplink_ ? faults.active(FaultTarget::kUplink, mode) : nullptr;
}

bool FaultyLink::cut(const FaultSchedule& faults) const noexcept {
  return open_ || active(FaultMode::kOff, faults) != nullptr ||
         faults.active(FaultTarget::kBus, FaultMode::kBusOff) != nullptr;
}

bool FaultyLink::needed(FaultSchedule& faults) noexcept {
  if (head_ != tail_) return true;
  if (faults.empty()) return false;
  open_ = contact_.open(active(FaultMode::kIntermittent, faults), faults);
  return cut(faults) || active(FaultMode::kGarbage, faults) != nullptr ||
         active(FaultMode::kSlow, faults) != nullptr ||
         active(FaultMode::kDelayed, faults) != nullptr;
}

void FaultyLink::put(std::span<const std::uint8_t> bytes, FaultSchedule& faults) noexcept {
  open_ = contact_.open(active(FaultMode::kIntermittent, faults), faults);
  const bool full = bytes.size() > kBytes - (head_ - tail_) || piece_head_ - piece_tail_ == kPieces;
  if (bytes.empty() || full || cut(faults)) return;
  const Fault* garbage = active(FaultMode::kGarbage, faults);
  for (const std::uint8_t byte : bytes) {
    const bool damaged = garbage != nullptr && faults.chance(garbage->value);
    bytes_[head_++ % kBytes] = damaged ? randomByte(faults.random()) : byte;
  }
  const Fault* late = active(FaultMode::kDelayed, faults);
  const Duration delay = late != nullptr ? fromSeconds(late->value) : Duration::zero();
  pieces_[piece_head_++ % kPieces] = {faults.now() + delay, bytes.size()};
}

std::size_t FaultyLink::take(std::span<std::uint8_t> out, FaultSchedule& faults) noexcept {
  std::size_t allowed = out.size();
  if (const Fault* slow = active(FaultMode::kSlow, faults)) {
    budget_ = std::fmin(budget_ + slow->value * toSeconds(faults.now() - last_take_),
                        std::fmax(kBurst, 0.1 * slow->value));
    allowed = std::min(allowed, static_cast<std::size_t>(budget_));
  }
  last_take_ = faults.now();
  std::size_t taken = 0;
  while (taken < allowed && piece_tail_ != piece_head_) {
    Piece& piece = pieces_[piece_tail_ % kPieces];
    if (piece.due > faults.now()) break;
    const std::size_t count = std::min(piece.size, allowed - taken);
    for (std::size_t i = 0; i < count; ++i) out[taken++] = bytes_[tail_++ % kBytes];
    piece.size -= count;
    if (piece.size == 0) ++piece_tail_;
  }
  budget_ -= std::fmin(budget_, static_cast<double>(taken));
  return taken;
}

}  // namespace tautline::sim
