#pragma once

/// @file
/// A CAN interface of the machine through SocketCAN: raw frames, only the identifiers that are
/// ours, error frames on, kernel time stamps, never blocking. An interface that is switched off,
/// deleted or off the bus is noticed, reported and taken up again when it comes back under its
/// name.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "common/fields.h"
#include "drivers/back_off.h"
#include "drivers/bus_frame.h"
#include "drivers/can_status.h"

struct can_frame;

namespace tautline {

struct CanConfig {
  std::string interface { "can0" };

  bool virtual_only{false};  ///< Set by a bench's program, so that it can never move a real
                             ///< machine; no key in files.

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("interface", interface, "network interface of the bus (ip -brief link show type can)");
  }
};

/// What open() found. Not real-time safe: start-up only.
struct CanOpenResult {
  CanStatus status{CanStatus::kOpen};
  std::string reason;  ///< One line: what is wrong and the command that mends it; empty if open.

  explicit operator bool() const noexcept { return status == CanStatus::kOpen; }
};

/// When a frame arrived that was `age` old by the clock of its stamp at the time `now`, and cannot
/// have come before `earliest`. That clock may be stepped in between; an age that is impossible
/// then is not believed, and the frame is as new as the cycle that reads it. Real-time safe: no
/// allocation, no locks, no exceptions.
[[nodiscard]] Time arrivalOf(Duration age, Time now, Time earliest) noexcept;

/// Invariant: fd_ is a non-blocking descriptor exactly while connected().
/// All but the constructor, open() and adopt(): real-time safe: no allocation, no locks, no
/// exceptions.
class CanSocket final : public FramePort {
 public:
  static constexpr std::size_t kMaxIds = 8;
  /// Frames taken from the kernel in one cycle at most, of whatever kind; what is left waits for
  /// the next cycle. A full bus at 500 kbit/s has fewer than 50 in 10 ms.
  static constexpr int kFramesPerCycle = 64;
  /// Frames of others that are looked at in one cycle; beyond them the kernel counts.
  static constexpr int kForeignPerCycle = 8;

  /// `ids`: what is to be received, at most kMaxIds.
  CanSocket(CanConfig config, std::span<const std::uint16_t> ids);
  ~CanSocket() override;

  /// Opens the configured interface. After a failure, poll() keeps trying, so that a caller may
  /// choose to go on. Not real-time safe: start-up only.
  [[nodiscard]] CanOpenResult open();

  /// Takes over `fd`, opened by someone else: one end of a SOCK_SEQPACKET pair that carries one
  /// can_frame a packet. When it goes away, poll() opens the configured interface;
  /// an empty name means never. Not real-time safe: start-up only.
  [[nodiscard]] CanOpenResult adopt(int fd);

  void poll(Time now) noexcept override;

  /// `out.time` is the kernel's time stamp on the clock of `now` in poll(), never later than `now`;
  /// see arrivalOf().
  [[nodiscard]] bool read(BusFrame& out) noexcept override;

  /// False, and counted in FrameCounters::no_buffer, while the kernel has no room: an unplugged or
  /// unterminated bus, or one that is overloaded.
  bool write(const BusFrame& frame) noexcept override;

  [[nodiscard]] bool connected() const noexcept override { return fd_ >= 0; }
  [[nodiscard]] PortCounters counters() const noexcept override { return counters_; }
  [[nodiscard]] FrameCounters frameCounters() const noexcept override { return frames_; }
  [[nodiscard]] LinkFault fault() const noexcept override;

  /// Why the last attempt to open failed, or why the interface was lost, or kOpen.
  [[nodiscard]] CanStatus status() const noexcept { return status_; }

 private:
  [[nodiscard]] CanStatus tryOpen() noexcept;
  [[nodiscard]] CanStatus checkInterface(int fd, int& index) noexcept;
  [[nodiscard]] bool setOptions(int fd) const noexcept;
  [[nodiscard]] bool setForeignOptions(int fd) const noexcept;
  void taken(int fd, int foreign) noexcept;
  void close() noexcept;
  void countForeign() noexcept;
  [[nodiscard]] CanStatus failed(CanStatus fallback) noexcept;
  [[nodiscard]] bool receive(can_frame& frame, Time& stamp) noexcept;
  [[nodiscard]] bool isOurs(std::uint32_t can_id) const noexcept;
  void takeErrorFrame(const can_frame& frame) noexcept;
  void lose(int error) noexcept;

  CanConfig config_;
  std::array<std::uint16_t, kMaxIds> ids_{};
  std::size_t id_count_{0};
  PortCounters counters_;
  FrameCounters frames_;
  int fd_{-1};
  int foreign_{-1};  ///< A second socket that hears all but our identifiers; -1 on an adopted pair.
  int error_{0};     ///< errno of the last failed attempt.
  bool was_connected_{false};
  CanStatus status_{CanStatus::kNoSuchInterface};
  BackOff back_off_;

  Time now_{};
  Duration to_realtime_{};  ///< From the loop's clock to CLOCK_REALTIME, that of the time stamps.
  int budget_{0};
  Time empty_since_{};              ///< When read() last found nothing, or the socket was made.
  std::uint32_t kernel_drops_{0};   ///< Of this socket.
  std::uint32_t foreign_drops_{0};  ///< Of the second one.
  std::optional<Time> bus_error_;   ///< Last error frame that says the bus is in trouble.
  LinkFault bus_fault_{LinkFault::kNone};
};

}  // namespace tautline
