#include "sim_hil/pty_link.h"

#include <fcntl.h>
#include <stdlib.h>
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

}  // namespace

PtyLink::PtyLink(std::filesystem::path link) : link_(std::move(link)) {
  std::error_code error;
  const auto status = std::filesystem::symlink_status(link_, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_symlink(status)) {
    throw linkError(link_, "is there already and is no symbolic link", "choose another name");
  }
  master_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  std::array<char, 128> name{};
  if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0 ||
      ::ptsname_r(master_, name.data(), name.size()) != 0 || !makeRaw(name.data())) {
    const std::string reason = std::strerror(errno);
    if (master_ >= 0) ::close(master_);
    throw linkError(link_, "no pseudo terminal: " + reason, "is /dev/pts mounted?");
  }
  slave_ = name.data();
  const std::filesystem::path temporary = link_.string() + ".new";
  std::filesystem::remove(temporary, error);
  std::filesystem::create_symlink(slave_, temporary, error);
  if (!error) std::filesystem::rename(temporary, link_, error);
  if (error) {
    ::close(master_);
    throw linkError(link_, "cannot make the link: " + error.message(),
                    "choose a place that can be written");
  }
}

PtyLink::~PtyLink() {
  std::error_code error;
  if (std::filesystem::read_symlink(link_, error) == slave_) std::filesystem::remove(link_, error);
  ::close(master_);
}

std::size_t PtyLink::read(std::span<std::uint8_t> out) noexcept {
  const ssize_t n = ::read(master_, out.data(), out.size());
  if (n > 0) {
    has_client_ = true;
    return static_cast<std::size_t>(n);
  }
  has_client_ = n < 0 && (errno == EAGAIN || errno == EINTR);  // EIO: the slave is closed
  return 0;
}

std::size_t PtyLink::write(std::span<const std::uint8_t> bytes) noexcept {
  if (!has_client_) return bytes.size();
  const ssize_t n = ::write(master_, bytes.data(), bytes.size());
  return n > 0 ? static_cast<std::size_t>(n) : 0;
}

}  // namespace tautline::sim
