#pragma once

/// @file
/// The emulated device's text buffers, both of fixed size. Real-time safe: no allocation, no locks,
/// no exceptions.

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace tautline::sim {

/// Collects bytes into lines that end in "\n", "\r" or both. Lines that are too long are dropped up
/// to their end.
class InputLine {
 public:
  template <class OnLine>
  void push(std::span<const std::uint8_t> bytes, OnLine&& on_line) noexcept {
    for (const std::uint8_t byte : bytes) {
      if (byte != '\n' && byte != '\r') {
        if (size_ < text_.size()) text_[size_] = static_cast<char>(byte);
        size_ = std::min(size_ + 1, text_.size() + 1);
        continue;
      }
      if (size_ > 0 && size_ <= text_.size()) on_line(std::string_view(text_.data(), size_));
      size_ = 0;
    }
  }

 private:
  std::array<char, 96> text_{};
  std::size_t size_{0};  // one more than fits: too long
};

/// One telemetry line under construction: "!Header a,b,c\r\n".
class TelemetryLine {
 public:
  explicit TelemetryLine(std::string_view header) noexcept { append(header); }

  TelemetryLine& field(double value, int decimals) noexcept {
    separate();
    // Zero has no sign on this wire.
    double scale = 1.0;
    for (int i = 0; i < decimals; ++i) scale *= 10.0;
    if (value > -0.5 / scale && value <= 0.0) value = 0.0;
    const auto done = std::to_chars(text_.data() + size_, text_.data() + text_.size(), value,
                                    std::chars_format::fixed, decimals);
    if (done.ec == std::errc{}) size_ = static_cast<std::size_t>(done.ptr - text_.data());
    return *this;
  }
  TelemetryLine& field(std::int64_t value) noexcept {
    separate();
    const auto done = std::to_chars(text_.data() + size_, text_.data() + text_.size(), value);
    if (done.ec == std::errc{}) size_ = static_cast<std::size_t>(done.ptr - text_.data());
    return *this;
  }
  [[nodiscard]] std::string_view finish() noexcept {
    append("\r\n");
    return {text_.data(), size_};
  }

 private:
  void separate() noexcept { append(first_ ? " " : ","), first_ = false; }
  void append(std::string_view text) noexcept {
    const std::size_t n = std::min(text.size(), text_.size() - size_);
    std::copy_n(text.data(), n, text_.data() + size_);
    size_ += n;
  }

  std::array<char, 128> text_{};
  std::size_t size_{0};
  bool first_{true};
};

/// Bytes waiting for the client. A line that does not fit is dropped whole.
class OutputLines {
 public:
  bool put(std::string_view line) noexcept {
    if (line.size() > kCapacity - (head_ - tail_)) return false;
    for (const char c : line) ring_[head_++ % kCapacity] = static_cast<std::uint8_t>(c);
    return true;
  }
  std::size_t take(std::span<std::uint8_t> out) noexcept {
    const std::size_t n = std::min(out.size(), head_ - tail_);
    for (std::size_t i = 0; i < n; ++i) out[i] = ring_[tail_++ % kCapacity];
    return n;
  }

 private:
  static constexpr std::size_t kCapacity = 8192;
  std::array<std::uint8_t, kCapacity> ring_{};
  std::size_t head_{0};
  std::size_t tail_{0};
};

}  // namespace tautline::sim
