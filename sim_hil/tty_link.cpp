#include "sim_hil/tty_link.h"

#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "common/error.h"

namespace tautline::sim {

TtyLink::TtyLink(const std::string& path)
    : path_(path), fd_(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
  termios settings{};
  if (fd_ >= 0 && ::tcgetattr(fd_, &settings) == 0) {
    ::cfmakeraw(&settings);
    if (::tcsetattr(fd_, TCSANOW, &settings) == 0) return;
  }
  const std::string reason = std::strerror(errno);
  if (fd_ >= 0) ::close(fd_);
  throw InputError({.key = path, .problem = reason, .remedy = "name a serial line of yours"},
                   ExitCode::kFailed);
}

TtyLink::~TtyLink() { ::close(fd_); }

std::size_t TtyLink::read(std::span<std::uint8_t> out) noexcept {
  const ssize_t n = ::read(fd_, out.data(), out.size());
  heard_ = heard_ || n > 0;
  return n > 0 ? static_cast<std::size_t>(n) : 0;
}

std::size_t TtyLink::write(std::span<const std::uint8_t> bytes) noexcept {
  if (!heard_) return bytes.size();
  const ssize_t n = ::write(fd_, bytes.data(), bytes.size());
  return n > 0 ? static_cast<std::size_t>(n) : 0;
}

}  // namespace tautline::sim
