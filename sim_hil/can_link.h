#pragma once

/// @file
/// The simulator's end of a CAN bus: a raw socket on an interface (vcan, slcan, a real adapter), or
/// one end of a SOCK_SEQPACKET pair. Its bytes are the kernel's can_frame records, 16 each.

#include <string>

#include "sim_hil/byte_link.h"

namespace tautline::sim {

class CanLink final : public ByteLink {
 public:
  /// Throws InputError, which says what to do, if the interface is not there, is down or cannot be
  /// used. Not real-time safe: start-up only.
  explicit CanLink(const std::string& interface);

  /// Takes over one end of a pair.
  explicit CanLink(int fd) noexcept : fd_(fd) {}
  ~CanLink() override;

  /// Whole records only.
  [[nodiscard]] std::size_t read(std::span<std::uint8_t> out) noexcept override;
  /// Whole records only; stops where the bus takes no more. What an interface that is down does not
  /// take goes nowhere.
  [[nodiscard]] std::size_t write(std::span<const std::uint8_t> bytes) noexcept override;
  /// A bus has no connection: there is one from the first frame heard.
  [[nodiscard]] bool hasClient() const noexcept override { return heard_; }
  [[nodiscard]] std::string name() const override { return name_; }

 private:
  std::string name_{"pair"};
  int fd_{-1};
  bool heard_{false};
};

}  // namespace tautline::sim
