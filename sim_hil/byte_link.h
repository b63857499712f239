#pragma once

/// @file
/// Where the simulator's bytes go to and come from: a pseudo terminal, a serial line, a CAN
/// interface.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace tautline::sim {

class ByteLink {
 public:
  ByteLink() = default;
  ByteLink(const ByteLink&) = delete;
  ByteLink& operator=(const ByteLink&) = delete;
  virtual ~ByteLink() = default;

  /// Bytes from the client, 0 if there are none. Never blocks.
  [[nodiscard]] virtual std::size_t read(std::span<std::uint8_t> out) noexcept = 0;

  /// Returns how many bytes were taken: less than all if the client does not read, all of them,
  /// into nowhere, if there is no client. Never blocks.
  [[nodiscard]] virtual std::size_t write(std::span<const std::uint8_t> bytes) noexcept = 0;

  /// There is a client, as of the last read().
  [[nodiscard]] virtual bool hasClient() const noexcept = 0;

  /// Pulls the cable out of the client's port, or puts it back; the same again does nothing. Not
  /// where the cable is not the simulator's.
  virtual void plug(bool /*in*/) noexcept {}

  /// For people, e.g. "/dev/pts/3".
  [[nodiscard]] virtual std::string name() const = 0;
};

}  // namespace tautline::sim
