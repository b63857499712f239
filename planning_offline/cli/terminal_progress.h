#pragma once

/// @file
/// Progress of long work on the terminal, and Ctrl-C. Not real-time safe: offline only.

#include <chrono>
#include <string>
#include <string_view>

#include "planning_offline/progress.h"

namespace tautline::planning {

/// Shows nothing in the first second; then one line on stderr that is rewritten on a terminal, or a
/// new line every few seconds in a log. While an object lives, the first Ctrl-C (SIGINT) cancels
/// the work, which then returns the best it has; the second one ends the program. One object at a
/// time.
class TerminalProgress {
 public:
  TerminalProgress();
  ~TerminalProgress();
  TerminalProgress(const TerminalProgress&) = delete;
  TerminalProgress& operator=(const TerminalProgress&) = delete;

  [[nodiscard]] const Progress& progress() const noexcept { return progress_; }
  [[nodiscard]] bool cancelled() const noexcept { return progress_.cancelled(); }

  /// Takes the line off the terminal, before anything else is printed.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  void show(std::string_view what, double fraction);

  Progress progress_;
  Clock::time_point begin_;
  Clock::time_point last_;
  bool terminal_;
  bool shown_{false};
};

}  // namespace tautline::planning
