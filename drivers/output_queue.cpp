#include "drivers/output_queue.h"

#include <algorithm>

namespace tautline {

std::size_t OutputQueue::push(std::span<const std::uint8_t> message) noexcept {
  const std::size_t oldest = sent_ > 0 ? 1 : 0;  // the first that may still be given up
  if (message.empty() || message.size() > kMaxMessage) return message.size();

  std::size_t dropped = 0;
  while (count_ == kMaxMessages || size_ + message.size() > kMaxBytes) {
    dropped += lengths_[oldest];
    eraseMessage(oldest);
  }
  std::copy(message.begin(), message.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(size_));
  size_ += message.size();
  lengths_[count_++] = message.size();
  return dropped;
}

void OutputQueue::consume(std::size_t count) noexcept {
  sent_ += count;
  while (count_ > 0 && sent_ >= lengths_[0]) {
    sent_ -= lengths_[0];
    eraseMessage(0);
  }
}

std::size_t OutputQueue::clear() noexcept {
  const std::size_t pending_bytes = size_ - sent_;
  size_ = count_ = sent_ = 0;
  return pending_bytes;
}

void OutputQueue::eraseMessage(std::size_t index) noexcept {
  std::size_t begin = 0;
  for (std::size_t i = 0; i < index; ++i) begin += lengths_[i];
  const std::size_t end = begin + lengths_[index];
  std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(end),
            bytes_.begin() + static_cast<std::ptrdiff_t>(size_),
            bytes_.begin() + static_cast<std::ptrdiff_t>(begin));
  std::copy(lengths_.begin() + static_cast<std::ptrdiff_t>(index) + 1,
            lengths_.begin() + static_cast<std::ptrdiff_t>(count_),
            lengths_.begin() + static_cast<std::ptrdiff_t>(index));
  size_ -= end - begin;
  --count_;
}

}  // namespace tautline
