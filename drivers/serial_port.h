#pragma once

/// @file
/// A serial line of the machine (USB CDC-ACM, FTDI, UART, pseudo terminal): raw 8N1, one owner,
/// never blocking. A device that is unplugged is noticed, reported and reopened under the same path
/// when it comes back.

#include <cstdint>
#include <string>

#include "common/fields.h"
#include "drivers/back_off.h"
#include "drivers/byte_port.h"
#include "drivers/output_queue.h"

namespace tautline {

struct SerialConfig {
  std::string device{"/dev/ttyACM0"};  ///< A path of /dev/serial/by-id survives replugging.
  int baud{115200};                    ///< [bit/s], any rate the kernel and the adapter offer.
  bool low_latency{true};  ///< Ask the driver not to hold bytes back; harmless where it cannot.

  bool pseudo_terminal_only{false};  ///< Set by a bench's program, so that it can never move a
                                     ///< real machine; no key in files.

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("device", device, "path of the serial device");
    v.field("baud", baud, Range{50, 4000000}, "bits per second, 8N1");
    v.field("low_latency", low_latency, "ask the kernel driver not to hold bytes back");
  }
};

enum class SerialStatus : std::uint8_t {
  kOpen,
  kNoSuchDevice,
  kPermission,
  kBusy,        ///< Another program has it.
  kNotATty,     ///< The path is something else than a serial line.
  kRealDevice,  ///< Only a pseudo terminal is allowed, and this is none.
  kSettings,    ///< Raw mode or baud rate did not read back as set.
  kUnplugged,   ///< Was open and went away.
  kFailed,      ///< Anything else; errno tells.
};

/// What open() found. Not real-time safe: start-up only.
struct SerialOpenResult {
  SerialStatus status{SerialStatus::kOpen};
  std::string reason;  ///< One line: what is wrong and what to do about it; empty if open.

  explicit operator bool() const noexcept { return status == SerialStatus::kOpen; }
};

/// Invariant: fd_ is a non-blocking descriptor exactly while connected().
/// All but the constructors, open() and adopt(): real-time safe: no allocation, no locks, no
/// exceptions.
class SerialPort final : public BytePort {
 public:
  explicit SerialPort(SerialConfig config);
  ~SerialPort() override;

  /// Opens the configured device. After a failure, poll() keeps trying, so that a caller may choose
  /// to go on. Not real-time safe: start-up only.
  [[nodiscard]] SerialOpenResult open();

  /// Takes over `fd`, opened by someone else (pty, socket pair); settings are applied where it is a
  /// terminal. When it goes away, poll() reopens the configured device; an empty device path means
  /// never. Not real-time safe: start-up only.
  [[nodiscard]] SerialOpenResult adopt(int fd);

  void poll(Time now) noexcept override;
  [[nodiscard]] ReadResult read(std::span<std::uint8_t> buffer) noexcept override;
  WriteResult write(std::span<const std::uint8_t> message) noexcept override;
  [[nodiscard]] bool connected() const noexcept override { return fd_ >= 0; }
  [[nodiscard]] PortCounters counters() const noexcept override;
  [[nodiscard]] LinkFault fault() const noexcept override;

  /// Why the last attempt to open failed, or kUnplugged, or kOpen.
  [[nodiscard]] SerialStatus status() const noexcept { return status_; }

  /// While connected: the far end is a program, not a machine.
  [[nodiscard]] bool isPseudoTerminal() const noexcept { return pseudo_terminal_; }

 private:
  [[nodiscard]] SerialStatus tryOpen() noexcept;
  void flush() noexcept;
  void disconnect() noexcept;

  SerialConfig config_;
  OutputQueue output_;
  PortCounters counters_;
  int fd_{-1};
  bool socket_{false};  ///< fd_ is a socket: written with send(), which raises no SIGPIPE.
  int error_{0};        ///< errno of the last failed attempt.
  bool was_connected_{false};
  bool pseudo_terminal_{false};
  SerialStatus status_{SerialStatus::kNoSuchDevice};
  BackOff back_off_;
};

}  // namespace tautline
