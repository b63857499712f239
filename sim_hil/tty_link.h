#pragma once

/// @file
/// The simulator's end of a serial line that is there already: a UART, a USB adapter, the terminal
/// of an emulated machine.

#include <string>

#include "sim_hil/byte_link.h"

namespace tautline::sim {

class TtyLink final : public ByteLink {
 public:
  /// Opens `path`, raw, at the rate it has. Throws InputError if that cannot be done. Not real-time
  /// safe: start-up only.
  explicit TtyLink(const std::string& path);
  ~TtyLink() override;

  [[nodiscard]] std::size_t read(std::span<std::uint8_t> out) noexcept override;
  [[nodiscard]] std::size_t write(std::span<const std::uint8_t> bytes) noexcept override;
  /// Nobody can know: there is one from the first byte heard.
  [[nodiscard]] bool hasClient() const noexcept override { return heard_; }
  [[nodiscard]] std::string name() const override { return path_; }

 private:
  std::string path_;
  int fd_{-1};
  bool heard_{false};
};

}  // namespace tautline::sim
