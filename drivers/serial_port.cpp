#include "drivers/serial_port.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <system_error>
#include <utility>

#include "drivers/serial_holder.h"
#include "drivers/serial_settings.h"

namespace tautline {
namespace {

constexpr double kBaudTolerance =
    0.03;  // an adapter's divider may miss the rate by this much; 8N1 stands 4 to 5 %

bool isSocket(int fd) noexcept {
  int type = 0;
  socklen_t size = sizeof(type);
  return getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &size) == 0;
}

SerialStatus statusOf(int error) noexcept {
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return SerialStatus::kNoSuchDevice;
    case EACCES:
    case EPERM:
      return SerialStatus::kPermission;
    case EBUSY:
      return SerialStatus::kBusy;
    case ENOTTY:
      return SerialStatus::kNotATty;
    default:
      return SerialStatus::kFailed;
  }
}

// Makes `fd` ours: exclusive, raw, at `baud`, and verified.
SerialStatus configure(int fd, const SerialConfig& config, int& error) noexcept {
  const auto failed = [&error] {
    error = errno;
    return statusOf(error);
  };
  SerialSettings now;
  if (!getSerialSettings(fd, now)) return failed();
  // TIOCEXCL does not stop root; the lock keeps two stations apart even then.
  if (flock(fd, LOCK_EX | LOCK_NB) != 0) {
    error = EBUSY;
    return SerialStatus::kBusy;
  }
  if (ioctl(fd, TIOCEXCL) != 0 || !setSerialSettings(fd, config.baud) ||
      !getSerialSettings(fd, now))
    return failed();
  const double baud_error = std::abs(now.baud - config.baud) / static_cast<double>(config.baud);
  if (!now.raw_8n1 || !now.returns_at_once || baud_error > kBaudTolerance)
    return SerialStatus::kSettings;
  if (config.low_latency)
    static_cast<void>(setLowLatency(fd));  // an improvement where there is one to be had
  return SerialStatus::kOpen;
}

/// Unix98 pseudo terminals have the device majors 136 to 143.
bool isTerminalOfProgram(int fd) noexcept {
  struct stat status {};
  return fstat(fd, &status) == 0 && S_ISCHR(status.st_mode) && major(status.st_rdev) >= 136 &&
         major(status.st_rdev) <= 143;
}

std::string reasonText(SerialStatus status, int error, const SerialConfig& config) {
  const std::string& device = config.device;
  switch (status) {
    case SerialStatus::kOpen:
      return {};
    case SerialStatus::kNoSuchDevice:
      return device + ": no such device; plug it in or set the path (ls /dev/serial/by-id)";
    case SerialStatus::kPermission:
      return device +
             ": permission denied; add the user to group dialout, or tautline where its package is "
             "installed (usermod -aG dialout USER), and "
             "log in again";
    case SerialStatus::kBusy:
      return device + ": in use by " + describeHolder(device) + "; stop that program first";
    case SerialStatus::kNotATty:
      return device + ": not a serial device; set the path of one (ls /dev/serial/by-id)";
    case SerialStatus::kRealDevice:
      return device +
             ": is a real device, and only the bench's pseudo terminal is allowed; set run_mode = "
             "\"REAL\" to use it";
    case SerialStatus::kSettings:
      return device + ": did not take 8N1 at " + std::to_string(config.baud) +
             " baud; choose a rate the adapter offers";
    case SerialStatus::kUnplugged:
      return device + ": was unplugged; plug it in again";
    case SerialStatus::kFailed:
      break;
  }
  return device + ": cannot open: " + std::generic_category().message(error) +
         "; check the cable and the path";
}

}  // namespace

SerialPort::SerialPort(SerialConfig config) : config_(std::move(config)) {}

SerialPort::~SerialPort() { disconnect(); }

SerialOpenResult SerialPort::open() {
  disconnect();
  status_ = tryOpen();
  return {status_, reasonText(status_, error_, config_)};
}

SerialOpenResult SerialPort::adopt(int fd) {
  disconnect();
  const int flags = fcntl(fd, F_GETFL);
  if (flags < 0 || fcntl(fd, F_SETFL, flags | O_NONBLOCK) != 0 ||
      fcntl(fd, F_SETFD, FD_CLOEXEC) != 0) {
    error_ = errno;
    status_ = SerialStatus::kFailed;
  } else {
    status_ = configure(fd, config_, error_);
    socket_ = status_ == SerialStatus::kNotATty && isSocket(fd);
    if (socket_) status_ = SerialStatus::kOpen;  // needs no settings
  }
  if (status_ == SerialStatus::kOpen) {
    fd_ = fd;
    was_connected_ = true;
  }
  return {status_, reasonText(status_, error_, config_)};
}

SerialStatus SerialPort::tryOpen() noexcept {
  const int fd = ::open(config_.device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) {
    error_ = errno;
    // Opening something that is no device at all fails in its own ways.
    return error_ == EISDIR ? SerialStatus::kNotATty : statusOf(error_);
  }
  const SerialStatus status = config_.pseudo_terminal_only && !isTerminalOfProgram(fd)
                                  ? SerialStatus::kRealDevice
                                  : configure(fd, config_, error_);
  if (status != SerialStatus::kOpen) {
    ::close(fd);
    return status;
  }
  fd_ = fd;
  socket_ = false;
  pseudo_terminal_ = isTerminalOfProgram(fd);
  if (was_connected_) ++counters_.reconnects;
  was_connected_ = true;
  return status;
}

void SerialPort::poll(Time now) noexcept {
  if (connected()) {
    flush();
    back_off_.reset();
    return;
  }
  if (!config_.device.empty() && back_off_.due(now)) status_ = tryOpen();
}

ReadResult SerialPort::read(std::span<std::uint8_t> buffer) noexcept {
  if (!connected() || buffer.empty()) return {};
  const ssize_t count = ::read(fd_, buffer.data(), buffer.size());
  if (count > 0) {
    counters_.bytes_in += static_cast<std::uint64_t>(count);
    return {static_cast<std::size_t>(count)};
  }
  if (count < 0) {
    if (errno != EAGAIN && errno != EINTR) disconnect();
    return {};
  }
  // With VMIN = VTIME = 0 the kernel returns 0 both for "nothing there" and for "unplugged"; a
  // hang-up tells them apart.
  pollfd state{fd_, POLLIN, 0};
  if (::poll(&state, 1, 0) > 0 && (state.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0)
    disconnect();
  return {};
}

WriteResult SerialPort::write(std::span<const std::uint8_t> message) noexcept {
  const std::size_t dropped = connected() ? output_.push(message) : message.size();
  counters_.bytes_dropped += static_cast<std::uint32_t>(dropped);
  const bool accepted = connected() && message.size() <= OutputQueue::kMaxMessage;
  flush();
  return {accepted};
}

void SerialPort::flush() noexcept {
  while (connected() && !output_.pending().empty()) {
    const auto pending = output_.pending();
    const ssize_t count = socket_ ? ::send(fd_, pending.data(), pending.size(), MSG_NOSIGNAL)
                                  : ::write(fd_, pending.data(), pending.size());
    if (count <= 0) {
      if (count < 0 && errno != EAGAIN && errno != EINTR) disconnect();
      return;
    }
    counters_.bytes_out += static_cast<std::uint64_t>(count);
    output_.consume(static_cast<std::size_t>(count));
  }
}

void SerialPort::disconnect() noexcept {
  if (!connected()) return;
  ::close(fd_);
  fd_ = -1;
  status_ = SerialStatus::kUnplugged;
  counters_.bytes_dropped += static_cast<std::uint32_t>(output_.clear());
}

PortCounters SerialPort::counters() const noexcept { return counters_; }

LinkFault SerialPort::fault() const noexcept {
  switch (status_) {
    case SerialStatus::kOpen:
      return LinkFault::kNone;
    case SerialStatus::kNoSuchDevice:
    case SerialStatus::kUnplugged:
      return LinkFault::kPortMissing;
    case SerialStatus::kPermission:
      return LinkFault::kPortPermission;
    case SerialStatus::kBusy:
      return LinkFault::kPortBusy;
    case SerialStatus::kNotATty:
      return LinkFault::kNotSerial;
    case SerialStatus::kRealDevice:
      return LinkFault::kRealDevice;
    case SerialStatus::kSettings:
      return LinkFault::kPortSettings;
    case SerialStatus::kFailed:
      break;
  }
  return LinkFault::kPortFailed;
}

}  // namespace tautline
