#pragma once

/// @file
/// Messages waiting for a slow device. Fixed size; when full, the oldest messages give way, because
/// an old rate command is worth less than a new one. A message that is partly sent is never
/// touched: a cut line must not reach the device.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tautline {

/// Real-time safe: no allocation, no locks, no exceptions.
class OutputQueue {
 public:
  static constexpr std::size_t kMaxBytes = 512;
  static constexpr std::size_t kMaxMessages = 32;
  static constexpr std::size_t kMaxMessage =
      kMaxBytes / 2;  ///< Fits behind any message that is partly sent.

  /// Appends `message`; returns the bytes given up for it: older messages, or `message` itself if
  /// longer than kMaxMessage.
  [[nodiscard]] std::size_t push(std::span<const std::uint8_t> message) noexcept;

  /// What is to be sent next, in order.
  [[nodiscard]] std::span<const std::uint8_t> pending() const noexcept {
    return {bytes_.data() + sent_, size_ - sent_};
  }

  /// The first `count` <= pending().size() bytes went out.
  void consume(std::size_t count) noexcept;

  /// Forgets everything; returns the bytes that were still pending.
  std::size_t clear() noexcept;

 private:
  void eraseMessage(std::size_t index) noexcept;

  std::array<std::uint8_t, kMaxBytes> bytes_{};
  std::array<std::size_t, kMaxMessages> lengths_{};
  std::size_t size_{
      0};  ///< Bytes in use, including those of the first message that are already sent.
  std::size_t count_{0};  ///< Messages in use.
  std::size_t sent_{0};   ///< Bytes of the first message that are already sent, < lengths_[0].
};

}  // namespace tautline
