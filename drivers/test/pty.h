#pragma once

/// @file
/// The far end of a serial line for tests: a pseudo terminal whose master side plays the device,
/// behind a path that stays the same when the device is unplugged and plugged in again.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace tautline::testing {

/// A folder of its own that goes away with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

class Pty {
 public:
  Pty();
  ~Pty();
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;

  void plug();    ///< A fresh pseudo terminal behind path().
  void unplug();  ///< Closes the master side, as pulling the cable does; path() leads nowhere then.

  [[nodiscard]] std::string path() const { return link_.string(); }
  [[nodiscard]] int master() const { return master_; }

  void send(std::string_view bytes) const;
  /// Everything that has arrived; never waits.
  [[nodiscard]] std::string receive() const;
  /// receive(), cut at each "\n"; an unfinished line is kept for the next call.
  [[nodiscard]] std::vector<std::string> receiveLines();

 private:
  TemporaryFolder folder_;
  std::filesystem::path link_;
  std::string unfinished_;
  int master_{-1};
};

}  // namespace tautline::testing
