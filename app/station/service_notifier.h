#pragma once

/// @file
/// The service manager's side of the loop (sd_notify(3), without libsystemd): ready after the first
/// whole cycle, then a sign of life for its watchdog. A sign is sent only for a cycle that met its
/// deadline and handed its command to the device, so a loop that hangs, starves or is late for good
/// is ended and started anew, disarmed.

#include <cstdint>
#include <string>
#include <string_view>

#include "common/time.h"

namespace tautline {

/// Where the service manager listens and how often it wants to hear of us.
struct ServiceManager {
  std::string socket;                   ///< NOTIFY_SOCKET: a path, or '@' and an abstract name;
                                        ///< empty: started by hand, nobody listens.
  Duration watchdog{Duration::zero()};  ///< WATCHDOG_USEC; zero: no watchdog.
};

/// What the environment of this process says; a WATCHDOG_PID of another process means no watchdog.
/// Not real-time safe: start-up only.
[[nodiscard]] ServiceManager serviceManagerFromEnvironment();

/// Invariant: fd_ is a connected, non-blocking datagram socket, or -1.
class ServiceNotifier {
 public:
  /// A socket that cannot be reached is an error() and nothing else: the station flies without.
  /// Not real-time safe: start-up only.
  explicit ServiceNotifier(const ServiceManager& manager);
  ~ServiceNotifier();
  ServiceNotifier(const ServiceNotifier&) = delete;
  ServiceNotifier& operator=(const ServiceNotifier&) = delete;

  /// The end of a cycle at `now` whose command was written. `in_time`: it ended before the next
  /// tick. Sends READY=1 once, then WATCHDOG=1 four times per watchdog interval; never waits: what
  /// the socket does not take at once is tried again in the next cycle. Real-time safe: no
  /// allocation, no locks, no exceptions.
  void cycleDone(Time now, bool in_time) noexcept;

  /// The loop has ended and the device has had its last words. Real-time safe: no allocation, no
  /// locks, no exceptions.
  void stopping() noexcept;

  /// Why nobody is told although somebody asked to be; empty if all is well.
  [[nodiscard]] const std::string& error() const noexcept { return error_; }

 private:
  bool send(std::string_view message) noexcept;

  int fd_{-1};
  Duration interval_;
  Time next_{};
  bool ready_{false};
  std::string error_;
};

}  // namespace tautline
