#pragma once

/// @file
/// Terminal settings through the kernel's own interface (termios2), which takes any baud rate; the
/// C library's knows the standard ones only, and its header cannot be included next to the
/// kernel's.

namespace tautline {

/// The part of a terminal's settings that the project sets, as the kernel reports it.
struct SerialSettings {
  bool raw_8n1{
      false};  ///< No translation, echo, signals, flow control; 8 data bits, no parity, 1 stop bit.
  bool returns_at_once{false};  ///< VMIN = VTIME = 0.
  int baud{0};                  ///< [bit/s], as the adapter will really do it.
};

/// Sets raw 8N1, VMIN 0, VTIME 0 and `baud` on `fd`. False with errno set: not a terminal, or
/// refused. Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] bool setSerialSettings(int fd, int baud) noexcept;

/// Reads the settings back. False with errno set: not a terminal.
/// Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] bool getSerialSettings(int fd, SerialSettings& out) noexcept;

/// Asks the driver to hand over each byte as it comes instead of collecting some
/// (ASYNC_LOW_LATENCY). False where the driver has no such flag (pseudo terminals, CDC-ACM) or
/// refuses. Real-time safe: no allocation, no locks, no exceptions.
bool setLowLatency(int fd) noexcept;

}  // namespace tautline
