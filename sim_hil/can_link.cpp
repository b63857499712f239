#include "sim_hil/can_link.h"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "common/error.h"

namespace tautline::sim {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& problem,
                         const std::string& remedy) {
  throw InputError({.key = "--can " + name, .problem = problem, .remedy = remedy},
                   ExitCode::kFailed);
}

}  // namespace

CanLink::CanLink(const std::string& interface) : name_(interface) {
  fd_ = ::socket(AF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (fd_ < 0) refuse(name_, "this kernel has no CAN", "as root: modprobe can-raw vcan");
  ifreq request{};
  sockaddr_can address{};
  address.can_family = AF_CAN;
  interface.copy(request.ifr_name, sizeof(request.ifr_name) - 1);
  const bool there = ::ioctl(fd_, SIOCGIFINDEX, &request) == 0;
  address.can_ifindex = request.ifr_ifindex;
  const bool bound =
      there && ::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  const bool up = bound && ::ioctl(fd_, SIOCGIFFLAGS, &request) == 0 &&
                  (static_cast<unsigned>(request.ifr_flags) & IFF_UP) != 0;
  if (up) return;
  const std::string reason = std::strerror(errno);
  ::close(fd_);
  if (!there)
    refuse(name_, "no such interface", "as root: ip link add dev " + name_ + " type vcan");
  if (!bound) refuse(name_, reason, "choose a CAN interface");
  refuse(name_, "is down", "as root: ip link set " + name_ + " up");
}

CanLink::~CanLink() { ::close(fd_); }

std::size_t CanLink::read(std::span<std::uint8_t> out) noexcept {
  std::size_t size = 0;
  while (out.size() - size >= sizeof(can_frame)) {
    const ssize_t n = ::recv(fd_, out.data() + size, sizeof(can_frame), MSG_DONTWAIT);
    if (n != static_cast<ssize_t>(sizeof(can_frame))) break;
    heard_ = true;
    size += sizeof(can_frame);
  }
  return size;
}

std::size_t CanLink::write(std::span<const std::uint8_t> bytes) noexcept {
  std::size_t size = 0;
  while (bytes.size() - size >= sizeof(can_frame)) {
    const ssize_t n =
        ::send(fd_, bytes.data() + size, sizeof(can_frame), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (n < 0 && (errno == ENOBUFS || errno == EAGAIN)) return size;
    size += sizeof(can_frame);
  }
  return bytes.size();
}

}  // namespace tautline::sim
