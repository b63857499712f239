#pragma once

/// @file
/// Real virtual CAN interfaces for tests, through the kernel's own interfaces: no tool is needed.

#include <linux/can.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

namespace tautline::testing {

/// The interface that the environment names.
inline std::string vcanName() {
  const char* const name = std::getenv("TAUTLINE_VCAN");
  return name != nullptr && *name != '\0' ? name : "vcan0";
}

/// Why tests on `name` cannot run here; empty if they can.
inline std::string vcanMissing(const std::string& name) {
  const int fd = ::socket(AF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
  if (fd < 0)
    return std::string("SKIPPED: no SocketCAN in this kernel (") + std::strerror(errno) +
           "); ./run vcan runs these tests in one that has it";
  ifreq request{};
  name.copy(request.ifr_name, sizeof(request.ifr_name) - 1);
  const bool up = ::ioctl(fd, SIOCGIFFLAGS, &request) == 0 &&
                  (static_cast<unsigned>(request.ifr_flags) & IFF_UP) != 0;
  ::close(fd);
  return up ? ""
            : "SKIPPED: no interface " + name + " that is up; as root: ip link add dev " + name +
                  " type vcan && ip link set " + name + " up";
}

/// An interface of the test's own.
class Vcan {
 public:
  explicit Vcan(std::string name) : name_(std::move(name)) {}
  ~Vcan() { static_cast<void>(remove()); }
  Vcan(const Vcan&) = delete;
  Vcan& operator=(const Vcan&) = delete;

  /// These return 0, or the kernel's errno.
  [[nodiscard]] int create() const { return ask(RTM_NEWLINK, NLM_F_CREATE | NLM_F_EXCL); }
  [[nodiscard]] int remove() const { return ask(RTM_DELLINK, 0); }
  [[nodiscard]] int setUp(bool up) const {
    const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    ifreq request{};
    name_.copy(request.ifr_name, sizeof(request.ifr_name) - 1);
    int error = ::ioctl(fd, SIOCGIFFLAGS, &request) == 0 ? 0 : errno;
    const auto flags = static_cast<unsigned>(request.ifr_flags);
    request.ifr_flags = static_cast<short>(up ? flags | IFF_UP : flags & ~unsigned{IFF_UP});
    if (error == 0 && ::ioctl(fd, SIOCSIFFLAGS, &request) != 0) error = errno;
    ::close(fd);
    return error;
  }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  struct Request {
    nlmsghdr header{};
    ifinfomsg info{};
    char attributes[128]{};
  };
  static rtattr* append(Request& r, unsigned short type, const void* data, std::size_t size) {
    auto* const a =
        reinterpret_cast<rtattr*>(reinterpret_cast<char*>(&r) + NLMSG_ALIGN(r.header.nlmsg_len));
    a->rta_type = type;
    a->rta_len = static_cast<unsigned short>(RTA_LENGTH(size));
    if (size > 0) std::memcpy(RTA_DATA(a), data, size);
    r.header.nlmsg_len =
        static_cast<unsigned>(NLMSG_ALIGN(r.header.nlmsg_len) + RTA_ALIGN(a->rta_len));
    return a;
  }
  [[nodiscard]] int ask(unsigned short type, unsigned flags) const {
    Request r;
    r.header.nlmsg_len = NLMSG_LENGTH(sizeof(r.info));
    r.header.nlmsg_type = type;
    r.header.nlmsg_flags = static_cast<unsigned short>(NLM_F_REQUEST | NLM_F_ACK | flags);
    append(r, IFLA_IFNAME, name_.c_str(), name_.size() + 1);
    if (type == RTM_NEWLINK) {
      rtattr* const nest = append(r, IFLA_LINKINFO, nullptr, 0);
      append(r, IFLA_INFO_KIND, "vcan", 5);
      nest->rta_len = static_cast<unsigned short>(reinterpret_cast<char*>(&r) + r.header.nlmsg_len -
                                                  reinterpret_cast<char*>(nest));
    }
    const int fd = ::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE);
    if (fd < 0) return errno;
    struct {
      nlmsghdr header;
      nlmsgerr error;
      char rest[512];
    } answer{};
    int error = EIO;
    if (::send(fd, &r, r.header.nlmsg_len, 0) > 0 && ::recv(fd, &answer, sizeof(answer), 0) > 0 &&
        answer.header.nlmsg_type == NLMSG_ERROR)
      error = -answer.error.error;
    ::close(fd);
    return error;
  }

  std::string name_;
};

/// The other node of the bus: a raw socket without any care.
class RawCan {
 public:
  explicit RawCan(const std::string& interface)
      : fd_(::socket(AF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW)) {
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
    if (fd_ < 0 || ::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0)
      throw std::runtime_error("cannot open " + interface + ": " + std::strerror(errno));
  }
  ~RawCan() { ::close(fd_); }
  RawCan(const RawCan&) = delete;
  RawCan& operator=(const RawCan&) = delete;

  bool send(const can_frame& frame) const {
    return ::send(fd_, &frame, sizeof(frame), 0) == static_cast<ssize_t>(sizeof(frame));
  }
  bool receive(can_frame& frame) const {
    return ::recv(fd_, &frame, sizeof(frame), 0) == static_cast<ssize_t>(sizeof(frame));
  }

 private:
  int fd_;
};

}  // namespace tautline::testing
