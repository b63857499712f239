#include "planning_offline/cli/terminal_progress.h"

#include <signal.h>
#include <unistd.h>

#include <atomic>

#include <fmt/core.h>

namespace tautline::planning {
namespace {

std::atomic<Progress*> interrupted{nullptr};

void onInterrupt(int) {
  if (Progress* progress = interrupted.load()) progress->cancel();
  ::signal(SIGINT, SIG_DFL);  // the second Ctrl-C is not to be ignored
}

}  // namespace

TerminalProgress::TerminalProgress()
    : progress_([this](std::string_view what, double fraction) { show(what, fraction); }),
      begin_(Clock::now()),
      last_(begin_),
      terminal_(::isatty(STDERR_FILENO) == 1) {
  interrupted = &progress_;
  ::signal(SIGINT, onInterrupt);
}

TerminalProgress::~TerminalProgress() {
  interrupted = nullptr;
  ::signal(SIGINT, SIG_DFL);
  clear();
}

void TerminalProgress::show(std::string_view what, double fraction) {
  constexpr std::chrono::milliseconds kQuiet{1000};
  const std::chrono::milliseconds between{terminal_ ? 200 : 5000};
  const auto now = Clock::now();
  if (now - begin_ < kQuiet || (now - last_ < between && last_ != begin_)) return;
  last_ = now;
  const double seconds = std::chrono::duration<double>(now - begin_).count();
  const std::string share =
      fraction >= 0.0 ? fmt::format(" {:3.0f} %", 100.0 * fraction) : std::string();
  if (terminal_) {
    fmt::print(stderr, "\r{}{}, {:.0f} s (Ctrl-C: stop with the best so far)\033[K", what, share,
               seconds);
  } else {
    fmt::print(stderr, "{}{}, {:.0f} s\n", what, share, seconds);
  }
  std::fflush(stderr);
  shown_ = terminal_;
}

void TerminalProgress::clear() {
  if (!shown_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  shown_ = false;
}

}  // namespace tautline::planning
