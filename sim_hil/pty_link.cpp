#include "sim_hil/pty_link.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "common/error.h"

namespace tautline::sim {
namespace {

InputError linkError(const std::filesystem::path& link, std::string problem, std::string remedy) {
  return InputError({.file = {},
                     .line = 0,
                     .key = link.string(),
                     .problem = std::move(problem),
                     .allowed = {},
                     .remedy = std::move(remedy)},
                    ExitCode::kFailed);
}

/// Raw mode, so that nothing is echoed back before a client sets up its end. Opening and closing
/// the slave once also makes the kernel report "no client" from the beginning.
bool makeRaw(const std::string& slave) {
  const int fd = ::open(slave.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (fd < 0) return false;
  termios settings{};
  const bool ok = ::tcgetattr(fd, &settings) == 0 &&
                  (::cfmakeraw(&settings), ::tcsetattr(fd, TCSANOW, &settings) == 0);
  ::close(fd);
  return ok;
}

/// Makes `link` a symbolic link to `slave`, atomically.
std::error_code pointLink(const std::filesystem::path& link, const std::string& slave) {
  std::error_code error;
  const std::filesystem::path temporary = link.string() + ".new";
  std::filesystem::remove(temporary, error);
  std::filesystem::create_symlink(slave, temporary, error);
  if (!error) std::filesystem::rename(temporary, link, error);
  return error;
}

/// A new pseudo terminal in raw mode: its master, and the slave's name; -1 and errno if there is
/// none.
int openPty(std::string& slave) {
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  std::array<char, 128> name{};
  if (master < 0) return -1;
  if (::grantpt(master) != 0 || ::unlockpt(master) != 0 ||
      ::ptsname_r(master, name.data(), name.size()) != 0 || !makeRaw(name.data())) {
    ::close(master);
    return -1;
  }
  slave = name.data();
  return master;
}

}  // namespace

PtyLink::PtyLink(std::filesystem::path link) : link_(std::move(link)) {
  std::error_code error;
  const auto status = std::filesystem::symlink_status(link_, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_symlink(status)) {
    throw linkError(link_, "is there already and is no symbolic link", "choose another name");
  }
  master_ = openPty(slave_);
  if (master_ < 0) {
    throw linkError(link_, "no pseudo terminal: " + std::string(std::strerror(errno)),
                    "is /dev/pts mounted?");
  }
  error = pointLink(link_, slave_);
  if (error) {
    ::close(master_);
    throw linkError(link_, "cannot make the link: " + error.message(),
                    "choose a place that can be written");
  }
}

PtyLink::~PtyLink() { plug(false); }

void PtyLink::plug(bool in) noexcept {
  if (in == (master_ >= 0)) return;
  std::error_code error;
  if (!in) {
    if (std::filesystem::read_symlink(link_, error) == slave_)
      std::filesystem::remove(link_, error);
    ::close(master_);
    master_ = -1;
    has_client_ = false;
    return;
  }
  std::string slave;
  const int master = openPty(slave);
  if (master < 0) return;
  if (pointLink(link_, slave)) {
    ::close(master);
    return;
  }
  master_ = master;
  slave_ = slave;
}

std::size_t PtyLink::read(std::span<std::uint8_t> out) noexcept {
  const ssize_t n = ::read(master_, out.data(), out.size());
  if (n > 0) {
    has_client_ = true;
    return static_cast<std::size_t>(n);
  }
  const bool had_client = has_client_;
  has_client_ = n < 0 && (errno == EAGAIN || errno == EINTR);  // EIO: the slave is closed
  if (had_client && !has_client_) replug();
  return 0;
}

void PtyLink::replug() noexcept {
  const int fd = ::open(slave_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd >= 0) {
    ::ioctl(fd, TIOCNXCL);
    ::close(fd);
    return;
  }
  const int old = std::exchange(master_, -1);
  plug(true);
  if (master_ < 0) {
    master_ = old;
  } else {
    ::close(old);
  }
}

std::size_t PtyLink::write(std::span<const std::uint8_t> bytes) noexcept {
  if (!has_client_) return bytes.size();
  const ssize_t n = ::write(master_, bytes.data(), bytes.size());
  return n > 0 ? static_cast<std::size_t>(n) : 0;
}

}  // namespace tautline::sim
