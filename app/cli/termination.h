#pragma once

/// @file
/// Programs that run until they are told to end: SIGINT, SIGTERM and SIGHUP ask them to.

#include <atomic>
#include <csignal>

namespace tautline::cli {

/// Whether one of the signals came. Lock-free, so that the handler may set it.
inline std::atomic<bool> termination_requested{false};

/// From now on the signals no longer end the program at once.
inline void endOnSignals() {
  const auto handler = [](int) { termination_requested = true; };
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) std::signal(number, handler);
}

}  // namespace tautline::cli
