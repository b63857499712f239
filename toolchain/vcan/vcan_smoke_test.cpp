/// @file
/// One frame over a virtual CAN bus, through the kernel: proves the machine of `./run vcan`, not
/// our drivers. Needs nothing of the project, so that a failure here is the machine's.

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

#include <gtest/gtest.h>

namespace {

std::string interfaceName() {
  const char* name = std::getenv("TAUTLINE_VCAN");
  return name == nullptr ? "vcan0" : name;
}

class CanSocket {
 public:
  explicit CanSocket(const std::string& interface)
      : fd_(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW)) {
    if (fd_ < 0) return;
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(::if_nametoindex(interface.c_str()));
    bound_ = address.can_ifindex != 0 &&
             ::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  ~CanSocket() {
    if (fd_ >= 0) ::close(fd_);
  }
  CanSocket(const CanSocket&) = delete;
  CanSocket& operator=(const CanSocket&) = delete;

  [[nodiscard]] bool open() const { return fd_ >= 0; }
  [[nodiscard]] bool bound() const { return bound_; }
  [[nodiscard]] bool send(const can_frame& frame) const {
    return ::write(fd_, &frame, sizeof frame) == static_cast<ssize_t>(sizeof frame);
  }
  /// False if no whole frame comes within a second.
  [[nodiscard]] bool receive(can_frame& frame) const {
    pollfd readable{.fd = fd_, .events = POLLIN, .revents = 0};
    return ::poll(&readable, 1, 1000) == 1 &&
           ::read(fd_, &frame, sizeof frame) == static_cast<ssize_t>(sizeof frame);
  }

 private:
  int fd_;
  bool bound_{false};
};

TEST(VcanSmokeTest, AFrameArrivesAsItWasSent) {
  const std::string interface = interfaceName();
  const CanSocket sender(interface);
  if (!sender.open()) {
    GTEST_SKIP() << "this kernel has no SocketCAN (" << std::strerror(errno)
                 << "); ./run vcan runs this test in one that has it";
  }
  if (::if_nametoindex(interface.c_str()) == 0) {
    GTEST_SKIP() << "no interface " << interface << "; as root: ip link add "
                 << interface << " type vcan && ip link set " << interface << " up; or ./run vcan";
  }
  const CanSocket receiver(interface);
  ASSERT_TRUE(sender.bound());
  ASSERT_TRUE(receiver.bound());

  can_frame sent{};
  sent.can_id = 0x123;
  sent.can_dlc = 5;
  constexpr std::array<unsigned char, 5> kBytes{0x00, 0x7f, 0x80, 0xff, 0x2a};
  std::memcpy(sent.data, kBytes.data(), kBytes.size());
  ASSERT_TRUE(sender.send(sent)) << std::strerror(errno);

  can_frame received{};
  ASSERT_TRUE(receiver.receive(received));
  EXPECT_EQ(received.can_id, sent.can_id);
  ASSERT_EQ(received.can_dlc, sent.can_dlc);
  EXPECT_EQ(std::memcmp(received.data, kBytes.data(), kBytes.size()), 0);
}

}  // namespace
