#pragma once

/// @file
/// A whole terminal for a program with a screen: ANSI sequences and termios, no library. Not
/// real-time safe.

#include <termios.h>

#include <cstddef>
#include <string>
#include <vector>

namespace tautline::cli {

/// A key: a printable character as itself, or one of these.
namespace key {
inline constexpr int kNone = -1;
inline constexpr int kHangUp = -2;  ///< The terminal is gone.
inline constexpr int kUp = 1000;
inline constexpr int kDown = 1001;
inline constexpr int kLeft = 1002;
inline constexpr int kRight = 1003;
inline constexpr int kPageUp = 1004;
inline constexpr int kPageDown = 1005;
inline constexpr int kEnter = 1006;
inline constexpr int kEscape = 1007;
inline constexpr int kBackspace = 1008;
}  // namespace key

struct ScreenLine {
  std::string text;  ///< Cut at the right edge; anything but printable ASCII is shown as '?'.
  bool highlighted{false};
};

/// While it lives the terminal shows another screen and hands over each key at once; afterwards all
/// is as before. Ctrl-C stays a signal.
class Terminal {
 public:
  /// @throws InputError (exit code kUsage) if stdin or stdout is no terminal.
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  struct Size {
    std::size_t rows{24};
    std::size_t columns{80};
  };
  [[nodiscard]] Size size() const;

  /// Next key that was typed; kNone if none was. Waits 25 ms at most, for the rest of a key.
  [[nodiscard]] int readKey();

  /// Shows these lines from the top and nothing else; what does not fit is left out.
  void show(const std::vector<ScreenLine>& lines);

 private:
  /// False if the terminal is gone.
  bool takeTyped(int wait_ms);

  termios before_{};
  std::string typed_;  // Not yet taken keys.
};

}  // namespace tautline::cli
