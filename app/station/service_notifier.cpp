#include "app/station/service_notifier.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace tautline {
namespace {

/// Value of a variable that holds a whole number; -1 if it is not set or holds something else.
std::int64_t numberFromEnvironment(const char* name) {
  const char* text = std::getenv(name);
  if (text == nullptr) return -1;
  const std::string_view digits(text);
  std::int64_t value = -1;
  const auto [end, error] = std::from_chars(digits.begin(), digits.end(), value);
  return error == std::errc() && end == digits.end() ? value : -1;
}

}  // namespace

ServiceManager serviceManagerFromEnvironment() {
  ServiceManager manager;
  if (const char* socket = std::getenv("NOTIFY_SOCKET")) manager.socket = socket;
  const std::int64_t pid = numberFromEnvironment("WATCHDOG_PID");
  const std::int64_t microseconds = numberFromEnvironment("WATCHDOG_USEC");
  if (microseconds > 0 && (pid == -1 || pid == getpid()))
    manager.watchdog = std::chrono::microseconds(microseconds);
  return manager;
}

ServiceNotifier::ServiceNotifier(const ServiceManager& manager) : interval_(manager.watchdog / 4) {
  if (manager.socket.empty()) return;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (manager.socket.size() >= sizeof(address.sun_path)) {
    error_ = "NOTIFY_SOCKET is longer than an address can be";
    return;
  }
  std::memcpy(address.sun_path, manager.socket.data(), manager.socket.size());
  if (address.sun_path[0] == '@') address.sun_path[0] = '\0';
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + manager.socket.size());
  fd_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd_ < 0 || connect(fd_, reinterpret_cast<const sockaddr*>(&address), size) != 0) {
    error_ = "NOTIFY_SOCKET " + manager.socket + ": " + std::strerror(errno);
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
  }
}

ServiceNotifier::~ServiceNotifier() {
  if (fd_ >= 0) close(fd_);
}

void ServiceNotifier::cycleDone(Time now, bool in_time) noexcept {
  if (fd_ < 0 || !in_time) return;
  if (!ready_) {
    ready_ = send("READY=1\nSTATUS=The loop is running\nWATCHDOG=1");
    next_ = now + interval_;
  } else if (interval_ > Duration::zero() && now >= next_ && send("WATCHDOG=1")) {
    next_ = now + interval_;
  }
}

void ServiceNotifier::stopping() noexcept {
  if (fd_ >= 0) send("STOPPING=1\nSTATUS=The loop has ended");
}

bool ServiceNotifier::send(std::string_view message) noexcept {
  return ::send(fd_, message.data(), message.size(), MSG_NOSIGNAL | MSG_DONTWAIT) ==
         static_cast<ssize_t>(message.size());
}

}  // namespace tautline
