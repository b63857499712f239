#include "drivers/can_socket.h"

#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/ethtool.h>
#include <linux/sockios.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <system_error>
#include <utility>

#include "common/error.h"

namespace tautline {
namespace {

constexpr Duration kOldestStamp = std::chrono::seconds(1);
constexpr Duration kBusErrorShown = std::chrono::seconds(1);
/// Everything but lost arbitration, which is how a healthy bus works.
constexpr can_err_mask_t kErrorClasses =
    CAN_ERR_MASK & ~static_cast<can_err_mask_t>(CAN_ERR_LOSTARB);

Duration durationOf(const timespec& t) noexcept {
  return std::chrono::seconds(t.tv_sec) + std::chrono::nanoseconds(t.tv_nsec);
}

template <class T>
bool setOption(int fd, int level, int name, const T& value) noexcept {
  return setsockopt(fd, level, name, &value, sizeof(value)) == 0;
}

bool isRawCan(int fd) noexcept {
  int domain = 0;
  socklen_t size = sizeof(domain);
  return getsockopt(fd, SOL_SOCKET, SO_DOMAIN, &domain, &size) == 0 && domain == AF_CAN;
}

/// Whether the driver behind the interface is one without a bus of its own.
bool isVirtual(int fd, ifreq request) noexcept {
  ethtool_drvinfo info{};
  info.cmd = ETHTOOL_GDRVINFO;
  request.ifr_data = reinterpret_cast<char*>(&info);
  if (ioctl(fd, SIOCETHTOOL, &request) != 0) return false;
  const std::string_view driver(info.driver, strnlen(info.driver, sizeof(info.driver)));
  return driver == "vcan" || driver == "vxcan" || driver == "slcan";
}

std::string reasonText(CanStatus status, int error, const std::string& name) {
  const std::string bring_up = "ip link set " + name + " up type can bitrate 500000 restart-ms 100";
  switch (status) {
    case CanStatus::kOpen:
      return {};
    case CanStatus::kNoCan:
      return name +
             ": this kernel has no CAN, or the program may not use it; as root: modprobe can-raw "
             "(in a systemd unit: RestrictAddressFamilies must have AF_CAN)";
    case CanStatus::kNoSuchInterface:
      return name +
             ": no such interface; plug the adapter in or set can.interface (ip -brief link show "
             "type can), then as root: " +
             bring_up;
    case CanStatus::kNotCan:
      return name + ": is no CAN interface; set can.interface (ip -brief link show type can)";
    case CanStatus::kDown:
      return name + ": is down; as root: " + bring_up + " (vcan: ip link set " + name + " up)";
    case CanStatus::kPermission:
      return name + ": permission denied; run it as a user who may open CAN sockets";
    case CanStatus::kRealDevice:
      return name +
             ": is a real bus, and only a virtual one is allowed; set run_mode = \"REAL\" to use "
             "it";
    case CanStatus::kSettings:
      return name + ": filters or time stamps did not take; update the kernel";
    case CanStatus::kClosed:
      return name + ": the other end is gone; start it again";
    case CanStatus::kFailed:
      break;
  }
  return name + ": cannot open: " + std::generic_category().message(error) + "; see `ip -details " +
         "link show " + name + "`";
}

}  // namespace

CanSocket::CanSocket(CanConfig config, std::span<const std::uint16_t> ids)
    : config_(std::move(config)), id_count_(ids.size()) {
  TAUTLINE_CHECK(ids.size() <= kMaxIds);
  std::copy(ids.begin(), ids.end(), ids_.begin());
}

CanSocket::~CanSocket() {
  if (fd_ >= 0) ::close(fd_);
}

CanOpenResult CanSocket::open() {
  if (fd_ >= 0) ::close(std::exchange(fd_, -1));
  status_ = tryOpen();
  return {status_, reasonText(status_, error_, config_.interface)};
}

CanOpenResult CanSocket::adopt(int fd) {
  if (fd_ >= 0) ::close(std::exchange(fd_, -1));
  const int flags = fcntl(fd, F_GETFL);
  raw_can_ = isRawCan(fd);
  const bool ok = flags >= 0 && fcntl(fd, F_SETFL, flags | O_NONBLOCK) == 0 &&
                  fcntl(fd, F_SETFD, FD_CLOEXEC) == 0 && setOptions(fd);
  status_ = ok ? CanStatus::kOpen : failed(CanStatus::kFailed);
  if (ok) {
    fd_ = fd;
    was_connected_ = true;
  }
  return {status_, reasonText(status_, error_, config_.interface)};
}

CanStatus CanSocket::failed(CanStatus fallback) noexcept {
  error_ = errno;
  switch (error_) {
    case EAFNOSUPPORT:
    case EPROTONOSUPPORT:
    case ESOCKTNOSUPPORT:
      return CanStatus::kNoCan;
    case EACCES:
    case EPERM:
      return CanStatus::kPermission;
    case ENODEV:
    case ENXIO:
      return CanStatus::kNoSuchInterface;
    case ENETDOWN:
      return CanStatus::kDown;
    default:
      return fallback;
  }
}

/// Exists, is CAN, is up, and may be used.
CanStatus CanSocket::checkInterface(int fd, int& index) noexcept {
  ifreq request{};
  if (config_.interface.empty() || config_.interface.size() >= sizeof(request.ifr_name))
    return CanStatus::kNoSuchInterface;
  config_.interface.copy(request.ifr_name, sizeof(request.ifr_name) - 1);
  if (ioctl(fd, SIOCGIFINDEX, &request) != 0) return failed(CanStatus::kFailed);
  index = request.ifr_ifindex;
  if (ioctl(fd, SIOCGIFHWADDR, &request) != 0) return failed(CanStatus::kFailed);
  if (request.ifr_hwaddr.sa_family != ARPHRD_CAN) return CanStatus::kNotCan;
  if (config_.virtual_only && !isVirtual(fd, request)) return CanStatus::kRealDevice;
  if (ioctl(fd, SIOCGIFFLAGS, &request) != 0) return failed(CanStatus::kFailed);
  return (request.ifr_flags & IFF_UP) != 0 ? CanStatus::kOpen : CanStatus::kDown;
}

bool CanSocket::setFilters(int fd, bool all) noexcept {
  std::array<can_filter, kMaxIds> filters{};
  for (std::size_t i = 0; i < id_count_; ++i)
    filters[i] = {ids_[i], CAN_SFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG};
  if (all) filters[0] = {0, 0};
  const auto size = static_cast<socklen_t>((all ? 1 : id_count_) * sizeof(can_filter));
  listens_to_all_ = all;
  return setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(), size) == 0;
}

/// Filters, error frames, time stamps and the count of lost frames; read back.
bool CanSocket::setOptions(int fd) noexcept {
  const int on = 1;
  kernel_drops_ = 0;
  bus_fault_ = LinkFault::kNone;
  bus_error_.reset();
  last_ours_ = now_;
  listens_to_all_ = false;
  if (!raw_can_) return setOption(fd, SOL_SOCKET, SO_TIMESTAMPNS, on);
  if (!setFilters(fd, false) || !setOption(fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, kErrorClasses) ||
      !setOption(fd, SOL_SOCKET, SO_TIMESTAMPNS, on) || !setOption(fd, SOL_SOCKET, SO_RXQ_OVFL, on))
    return false;
  int stamps = 0;
  socklen_t size = sizeof(stamps);
  if (getsockopt(fd, SOL_SOCKET, SO_TIMESTAMPNS, &stamps, &size) != 0 || stamps == 0) return false;
  std::array<can_filter, kMaxIds> filters{};
  size = sizeof(filters);
  return getsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(), &size) == 0 &&
         size == id_count_ * sizeof(can_filter);
}

CanStatus CanSocket::tryOpen() noexcept {
  const int fd = ::socket(AF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (fd < 0) return failed(CanStatus::kFailed);
  raw_can_ = true;
  sockaddr_can address{};
  address.can_family = AF_CAN;
  CanStatus status = checkInterface(fd, address.can_ifindex);
  if (status == CanStatus::kOpen && !setOptions(fd)) status = failed(CanStatus::kSettings);
  if (status == CanStatus::kOpen &&
      ::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0)
    status = failed(CanStatus::kFailed);
  if (status != CanStatus::kOpen) {
    ::close(fd);
    return status;
  }
  fd_ = fd;
  if (was_connected_) ++counters_.reconnects;
  was_connected_ = true;
  return status;
}

void CanSocket::poll(Time now) noexcept {
  now_ = now;
  budget_ = kFramesPerCycle;
  timespec realtime{};
  clock_gettime(CLOCK_REALTIME, &realtime);
  to_realtime_ = durationOf(realtime) - now.time_since_epoch();
  if (!connected()) {
    if (!config_.interface.empty() && back_off_.due(now)) status_ = tryOpen();
    return;
  }
  back_off_.reset();
  if (last_ours_ == Time{}) last_ours_ = now;
  const bool silent = now - last_ours_ > kListenAllAfter;
  if (raw_can_ && silent != listens_to_all_) static_cast<void>(setFilters(fd_, silent));
  const bool over = bus_error_ && now - *bus_error_ > kBusErrorShown;
  if (over && bus_fault_ != LinkFault::kBusOff) bus_fault_ = LinkFault::kNone;
}

bool CanSocket::read(BusFrame& out) noexcept {
  while (connected() && budget_ > 0) {
    can_frame frame{};
    if (!receive(frame, out.time)) return false;
    --budget_;
    if ((frame.can_id & CAN_ERR_FLAG) != 0) {
      takeErrorFrame(frame);
      continue;
    }
    counters_.bytes_in += sizeof(frame);
    bus_fault_ = LinkFault::kNone;  // a controller that receives is on the bus
    if (!isOurs(frame.can_id)) {
      ++frames_.frames_foreign;
      continue;
    }
    ++frames_.frames_in;
    last_ours_ = now_;
    out.id = static_cast<std::uint16_t>(frame.can_id);
    out.size = std::min<std::uint8_t>(frame.can_dlc, CAN_MAX_DLEN);
    out.data.fill(0);
    std::copy_n(std::begin(frame.data), out.size, out.data.begin());
    return true;
  }
  return false;
}

/// One packet; false if there is none, or none that is a frame.
bool CanSocket::receive(can_frame& frame, Time& stamp) noexcept {
  iovec part{&frame, sizeof(frame)};
  alignas(cmsghdr) std::array<char, 128> control{};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t size = ::recvmsg(fd_, &message, MSG_DONTWAIT);
  if (size != static_cast<ssize_t>(sizeof(frame))) {
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) return false;
    if (size > 0) {
      ++frames_.frames_bad;
      return false;
    }
    lose(size == 0 ? EPIPE : errno);
    return false;
  }
  stamp = now_;
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level != SOL_SOCKET) continue;
    if (c->cmsg_type == SCM_TIMESTAMPNS) {
      timespec t{};
      std::memcpy(&t, CMSG_DATA(c), sizeof(t));
      stamp = std::clamp(Time(durationOf(t) - to_realtime_), now_ - kOldestStamp, now_);
    } else if (c->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t drops = 0;
      std::memcpy(&drops, CMSG_DATA(c), sizeof(drops));
      frames_.frames_lost += drops - kernel_drops_;
      kernel_drops_ = drops;
    }
  }
  return true;
}

bool CanSocket::isOurs(std::uint32_t can_id) const noexcept {
  const auto end = ids_.begin() + static_cast<std::ptrdiff_t>(id_count_);
  return std::find(ids_.begin(), end, can_id) != end;  // other kinds of frames have flags set
}

void CanSocket::takeErrorFrame(const can_frame& frame) noexcept {
  constexpr std::uint32_t kTrouble = CAN_ERR_PROT | CAN_ERR_TRX | CAN_ERR_BUSERROR | CAN_ERR_CRTL;
  ++frames_.bus_errors;
  if ((frame.can_id & CAN_ERR_RESTARTED) != 0) {
    bus_fault_ = LinkFault::kNone;
    return;
  }
  if ((frame.can_id & CAN_ERR_BUSOFF) != 0) {
    ++frames_.bus_off;
    bus_fault_ = LinkFault::kBusOff;
  } else if (bus_fault_ == LinkFault::kBusOff) {
    return;
  } else if ((frame.can_id & CAN_ERR_ACK) != 0) {
    bus_fault_ = LinkFault::kNoAcknowledge;
  } else if ((frame.can_id & kTrouble) != 0) {
    const bool active_again =
        (frame.can_id & CAN_ERR_CRTL) != 0 && (frame.data[1] & CAN_ERR_CRTL_ACTIVE) != 0;
    bus_fault_ = active_again ? LinkFault::kNone : LinkFault::kBusErrors;
  }
  bus_error_ = now_;
}

bool CanSocket::write(const BusFrame& frame) noexcept {
  if (!connected()) return false;
  can_frame out{};
  out.can_id = frame.id;
  out.can_dlc = std::min<std::uint8_t>(frame.size, CAN_MAX_DLEN);
  std::copy_n(frame.data.begin(), out.can_dlc, std::begin(out.data));
  if (::send(fd_, &out, sizeof(out), MSG_NOSIGNAL | MSG_DONTWAIT) ==
      static_cast<ssize_t>(sizeof(out))) {
    counters_.bytes_out += sizeof(out);
    return true;
  }
  if (errno == ENOBUFS || errno == EAGAIN || errno == EINTR) {
    ++frames_.no_buffer;
    counters_.bytes_dropped += sizeof(out);
  } else {
    lose(errno);
  }
  return false;
}

void CanSocket::lose(int error) noexcept {
  ::close(fd_);
  fd_ = -1;
  errno = error;
  status_ = failed(CanStatus::kClosed);
}

LinkFault CanSocket::fault() const noexcept {
  if (connected()) return bus_fault_;
  return status_ == CanStatus::kDown ? LinkFault::kInterfaceDown : LinkFault::kInterfaceMissing;
}

}  // namespace tautline
