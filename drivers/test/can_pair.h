#pragma once

/// @file
/// The far end of a CAN interface for tests: one end of a SOCK_SEQPACKET pair, which keeps the
/// boundaries of frames as a CAN socket does.

#include <linux/can.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>
#include <vector>

#include "drivers/bus_frame.h"

namespace tautline::testing {

inline can_frame canFrame(const BusFrame& frame) {
  can_frame out{};
  out.can_id = frame.id;
  out.can_dlc = frame.size;
  std::copy_n(frame.data.begin(), frame.size, std::begin(out.data));
  return out;
}

class CanPair {
 public:
  CanPair() {
    std::array<int, 2> fds{};
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, fds.data()) != 0)
      throw std::runtime_error("no socket pair");
    ours_ = fds[0];
    theirs_ = fds[1];
  }
  ~CanPair() {
    hangUp();
    if (ours_ >= 0) ::close(ours_);
  }
  CanPair(const CanPair&) = delete;
  CanPair& operator=(const CanPair&) = delete;

  /// For CanSocket::adopt().
  [[nodiscard]] int release() { return std::exchange(ours_, -1); }
  [[nodiscard]] int farEnd() const { return theirs_; }
  void hangUp() {
    if (theirs_ >= 0) ::close(std::exchange(theirs_, -1));
  }

  /// False: the pair takes no more.
  bool send(const can_frame& frame) const {
    return ::send(theirs_, &frame, sizeof(frame), MSG_NOSIGNAL) == sizeof(frame);
  }
  bool send(const BusFrame& frame) const { return send(canFrame(frame)); }

  [[nodiscard]] std::vector<can_frame> receive() const {
    std::vector<can_frame> out;
    can_frame frame{};
    while (::recv(theirs_, &frame, sizeof(frame), 0) == sizeof(frame)) out.push_back(frame);
    return out;
  }

 private:
  int ours_{-1};
  int theirs_{-1};
};

}  // namespace tautline::testing
