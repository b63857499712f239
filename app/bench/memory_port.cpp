#include "app/bench/memory_port.h"

#include <algorithm>
#include <array>

namespace tautline::bench {

void MemoryPort::poll(Time /*now*/) noexcept {
  if (connected_) return;
  // What the device says while nobody listens is gone, as on a real cable.
  std::array<std::uint8_t, 1024> lost{};
  while (simulator_.transmit(lost) > 0) {
  }
}

ReadResult MemoryPort::read(std::span<std::uint8_t> buffer) noexcept {
  if (!connected_) return {};
  const std::size_t count = filter_ ? readFiltered(buffer) : simulator_.transmit(buffer);
  counters_.bytes_in += count;
  for (std::size_t i = 0; garble_every_ > 0 && i < count; ++i) {
    if (++passed_ % garble_every_ == 0) buffer[i] ^= 0x20;
  }
  return {count};
}

std::size_t MemoryPort::readFiltered(std::span<std::uint8_t> buffer) {
  for (std::size_t n = simulator_.transmit(buffer); n > 0; n = simulator_.transmit(buffer)) {
    for (const std::uint8_t byte : buffer.first(n)) {
      message_.push_back(static_cast<char>(byte));
      if (message_.back() != filter_->end) continue;
      if (filter_->keep(message_)) filtered_ += message_;
      message_.clear();
    }
  }
  const std::size_t count = std::min(buffer.size(), filtered_.size());
  std::copy_n(filtered_.begin(), count, buffer.begin());
  filtered_.erase(0, count);
  return count;
}

WriteResult MemoryPort::write(std::span<const std::uint8_t> message) noexcept {
  if (!connected_) {
    counters_.bytes_dropped += static_cast<std::uint32_t>(message.size());
    return {};
  }
  simulator_.receive(message);
  counters_.bytes_out += message.size();
  return {true};
}

void MemoryPort::plug() noexcept {
  if (!connected_) ++counters_.reconnects;
  connected_ = true;
}

}  // namespace tautline::bench
