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
#include <utility>

#include "common/error.h"

namespace tautline {
namespace {

/// Two clocks are read one after the other, and the loop may be interrupted in between.
constexpr Duration kClockSlack = std::chrono::milliseconds(1);
constexpr Duration kBusErrorShown = std::chrono::seconds(1);
/// Everything but lost arbitration, which is how a healthy bus works.
constexpr can_err_mask_t kErrorClasses =
    CAN_ERR_MASK & ~static_cast<can_err_mask_t>(CAN_ERR_LOSTARB);
constexpr int kForeignBuffer = 4096;  // about ten frames, with what the kernel keeps of each
/// An identifier of 11 bits in a frame that is neither extended nor a request.
constexpr canid_t kWholeId = CAN_SFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG;

Duration durationOf(const timespec& t) noexcept {
  return std::chrono::seconds(t.tv_sec) + std::chrono::nanoseconds(t.tv_nsec);
}

template <class T>
bool setOption(int fd, int level, int name, const T& value) noexcept {
  return setsockopt(fd, level, name, &value, sizeof(value)) == 0;
}

/// What comes with a frame.
struct Packet {
  std::optional<timespec> stamp;       ///< Of CLOCK_REALTIME.
  std::optional<std::uint32_t> drops;  ///< That the socket has given up so far.

  /// As recvmsg(), without waiting.
  ssize_t receive(int fd, can_frame& frame) noexcept {
    iovec part{&frame, sizeof(frame)};
    alignas(cmsghdr) std::array<char, 128> control{};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t size = ::recvmsg(fd, &message, MSG_DONTWAIT);
    if (size < 0) return size;
    for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
      if (c->cmsg_level != SOL_SOCKET) continue;
      if (c->cmsg_type == SCM_TIMESTAMPNS)
        std::memcpy(&stamp.emplace(), CMSG_DATA(c), sizeof(timespec));
      else if (c->cmsg_type == SO_RXQ_OVFL)
        std::memcpy(&drops.emplace(), CMSG_DATA(c), sizeof(std::uint32_t));
    }
    return size;
  }
};

/// Whether the driver behind the interface is one without a bus of its own.
bool isVirtual(int fd, ifreq request) noexcept {
  ethtool_drvinfo info{};
  info.cmd = ETHTOOL_GDRVINFO;
  request.ifr_data = reinterpret_cast<char*>(&info);
  if (ioctl(fd, SIOCETHTOOL, &request) != 0) return false;
  const std::string_view driver(info.driver, strnlen(info.driver, sizeof(info.driver)));
  return driver == "vcan" || driver == "vxcan" || driver == "slcan";
}

}  // namespace

Time arrivalOf(Duration age, Time now, Time earliest) noexcept {
  const Time arrived = now - age;
  return arrived < earliest || arrived > now ? now : arrived;
}

CanSocket::CanSocket(CanConfig config, std::span<const std::uint16_t> ids)
    : config_(std::move(config)), id_count_(ids.size()) {
  TAUTLINE_CHECK(ids.size() <= kMaxIds);
  std::copy(ids.begin(), ids.end(), ids_.begin());
}

CanSocket::~CanSocket() { close(); }

void CanSocket::close() noexcept {
  for (int* fd : {&fd_, &foreign_})
    if (*fd >= 0) ::close(std::exchange(*fd, -1));
}

CanOpenResult CanSocket::open() {
  close();
  status_ = tryOpen();
  return {status_, describe(status_, error_, config_.interface)};
}

CanOpenResult CanSocket::adopt(int fd) {
  close();
  const int flags = fcntl(fd, F_GETFL);
  const bool ok = flags >= 0 && fcntl(fd, F_SETFL, flags | O_NONBLOCK) == 0 &&
                  fcntl(fd, F_SETFD, FD_CLOEXEC) == 0 &&
                  setOption(fd, SOL_SOCKET, SO_TIMESTAMPNS, 1);
  status_ = ok ? CanStatus::kOpen : failed(CanStatus::kFailed);
  if (ok) taken(fd, -1);
  return {status_, describe(status_, error_, config_.interface)};
}

/// From here on `fd` is the link.
void CanSocket::taken(int fd, int foreign) noexcept {
  fd_ = fd;
  foreign_ = foreign;
  was_connected_ = true;
  kernel_drops_ = foreign_drops_ = 0;
  bus_fault_ = LinkFault::kNone;
  bus_error_.reset();
  empty_since_ = now_;
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

/// Filters, error frames, time stamps and the count of lost frames; read back.
bool CanSocket::setOptions(int fd) const noexcept {
  std::array<can_filter, kMaxIds> filters{};
  for (std::size_t i = 0; i < id_count_; ++i) filters[i] = {ids_[i], kWholeId};
  auto size = static_cast<socklen_t>(id_count_ * sizeof(can_filter));
  if (setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(), size) != 0 ||
      !setOption(fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, kErrorClasses) ||
      !setOption(fd, SOL_SOCKET, SO_TIMESTAMPNS, 1) || !setOption(fd, SOL_SOCKET, SO_RXQ_OVFL, 1))
    return false;
  int stamps = 0;
  size = sizeof(stamps);
  if (getsockopt(fd, SOL_SOCKET, SO_TIMESTAMPNS, &stamps, &size) != 0 || stamps == 0) return false;
  size = sizeof(filters);
  return getsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(), &size) == 0 &&
         size == id_count_ * sizeof(can_filter);
}

/// Hears what is none of ours, and keeps a handful: the rest the kernel only counts. Set once:
/// filters that change while the loop runs would wait for the lock of the kernel's network
/// settings.
bool CanSocket::setForeignOptions(int fd) const noexcept {
  std::array<can_filter, kMaxIds> filters{};
  for (std::size_t i = 0; i < id_count_; ++i) filters[i] = {ids_[i] | CAN_INV_FILTER, kWholeId};
  const auto size = static_cast<socklen_t>(id_count_ * sizeof(can_filter));
  return setOption(fd, SOL_CAN_RAW, CAN_RAW_JOIN_FILTERS, 1) &&
         setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(), size) == 0 &&
         setOption(fd, SOL_SOCKET, SO_RXQ_OVFL, 1) &&
         setOption(fd, SOL_SOCKET, SO_RCVBUF, kForeignBuffer);
}

CanStatus CanSocket::tryOpen() noexcept {
  constexpr int kKind = SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC;
  const int fd = ::socket(AF_CAN, kKind, CAN_RAW);
  if (fd < 0) return failed(CanStatus::kFailed);
  const int foreign = ::socket(AF_CAN, kKind, CAN_RAW);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  const auto isBound = [&address](int socket) {
    return ::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  };
  CanStatus status =
      foreign < 0 ? failed(CanStatus::kFailed) : checkInterface(fd, address.can_ifindex);
  if (status == CanStatus::kOpen && !(setOptions(fd) && setForeignOptions(foreign)))
    status = failed(CanStatus::kSettings);
  if (status == CanStatus::kOpen && !(isBound(fd) && isBound(foreign)))
    status = failed(CanStatus::kFailed);
  if (status != CanStatus::kOpen) {
    ::close(fd);
    if (foreign >= 0) ::close(foreign);
    return status;
  }
  if (was_connected_) ++counters_.reconnects;
  taken(fd, foreign);
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
  countForeign();
  const bool over = bus_error_ && now - *bus_error_ > kBusErrorShown;
  if (over && bus_fault_ != LinkFault::kBusOff) bus_fault_ = LinkFault::kNone;
}

bool CanSocket::read(BusFrame& out) noexcept {
  while (connected() && budget_ > 0) {
    can_frame frame{};
    if (!receive(frame, out.time)) {
      empty_since_ = now_;
      return false;
    }
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
  Packet packet;
  const ssize_t size = packet.receive(fd_, frame);
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
  if (packet.stamp) {
    const Duration age = now_ + to_realtime_ - Time(durationOf(*packet.stamp));
    stamp = arrivalOf(age, now_, empty_since_ - kClockSlack);
  }
  if (packet.drops)
    frames_.frames_lost += *packet.drops - std::exchange(kernel_drops_, *packet.drops);
  return true;
}

void CanSocket::countForeign() noexcept {
  can_frame frame{};
  for (int i = 0; i < kForeignPerCycle && foreign_ >= 0; ++i) {
    Packet packet;
    if (packet.receive(foreign_, frame) <= 0) return;  // the link's own socket tells what is lost
    ++frames_.frames_foreign;
    if (packet.drops)
      frames_.frames_foreign += *packet.drops - std::exchange(foreign_drops_, *packet.drops);
  }
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
  close();
  errno = error;
  status_ = failed(CanStatus::kClosed);
}

LinkFault CanSocket::fault() const noexcept { return connected() ? bus_fault_ : faultOf(status_); }

}  // namespace tautline
