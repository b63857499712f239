#pragma once

/// @file
/// A pseudo terminal whose slave stands in for the device's serial port, under a name of the user's
/// choice. Clients may open, close and reopen it; nobody needs to read.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "sim_hil/byte_link.h"

namespace tautline::sim {

class PtyLink final : public ByteLink {
 public:
  /// Opens a pty in raw mode and makes `link` a symbolic link to its slave, atomically; an old link
  /// is replaced. Throws InputError if `link` is something else than a link, or cannot be made. Not
  /// real-time safe: start-up only.
  explicit PtyLink(std::filesystem::path link);

  /// Removes the link if it still is ours.
  ~PtyLink() override;

  [[nodiscard]] std::size_t read(std::span<std::uint8_t> out) noexcept override;
  [[nodiscard]] std::size_t write(std::span<const std::uint8_t> bytes) noexcept override;
  [[nodiscard]] bool hasClient() const noexcept override { return has_client_; }
  void plug(bool in) noexcept override;
  [[nodiscard]] std::string name() const override { return slave_; }
  /// The slave's own name, e.g. "/dev/pts/3"; another one after a client that left it claimed.
  [[nodiscard]] const std::string& slave() const noexcept { return slave_; }

 private:
  /// A client has gone. If it had claimed the terminal for itself (TIOCEXCL) and was killed, the
  /// claim stays as long as the master is open, unlike on a cable; only root may pass it. So the
  /// claim is taken back, or where that is not allowed a new terminal takes the old one's place.
  void replug() noexcept;

  std::filesystem::path link_;
  std::string slave_;
  int master_{-1};
  bool has_client_{false};
};

}  // namespace tautline::sim
