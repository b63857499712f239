#pragma once

/// @file
/// STATION_INPUT and what stands behind it, both ways: what the core saw in a cycle as a message,
/// and such a message as input for a core that steps the flight again. One field more here is one
/// field more in both.

#include <algorithm>
#include <cstdint>

#include <Eigen/Geometry>
#include <tautline/station_input_t.hpp>

#include "app/station/station.h"
#include "common/vehicle.h"

namespace tautline {

/// Real-time safe: no allocation, no locks, no exceptions. `utime` is left to the sender.
[[nodiscard]] tautline::station_input_t messageOf(const StepInput& in) noexcept;

/// The inverse, but for the piece of a mission that may belong to the cycle (`chunk` stays null).
/// Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] StepInput inputOf(const tautline::station_input_t& message) noexcept;

/// Quaternion as w, x, y, z.
inline void put(double (&wxyz)[4], const Eigen::Quaterniond& q) noexcept {
  wxyz[0] = q.w();
  wxyz[1] = q.x();
  wxyz[2] = q.y();
  wxyz[3] = q.z();
}

inline void put(std::uint8_t (&bytes)[32], const OperatorName& name) noexcept {
  std::copy(name.begin(), name.end(), bytes);
}

/// The link's counters, which several messages carry under the same names.
template <class Message>
void putLink(Message& m, const LinkStatus& link) noexcept {
  m.link_connected = link.connected;
  m.link_bytes_in = static_cast<std::int64_t>(link.bytes_in);
  m.link_bytes_out = static_cast<std::int64_t>(link.bytes_out);
  m.link_lines_ok = static_cast<std::int32_t>(link.lines_ok);
  m.link_lines_bad = static_cast<std::int32_t>(link.lines_bad);
  m.link_bytes_dropped = static_cast<std::int32_t>(link.bytes_dropped);
  m.link_reconnects = static_cast<std::int32_t>(link.reconnects);
  m.link_fault = static_cast<std::int8_t>(link.fault);
  m.link_repeated = static_cast<std::int32_t>(link.repeated);
  m.link_wrong_sequence = static_cast<std::int32_t>(link.wrong_sequence);
  m.link_check_errors = static_cast<std::int32_t>(link.check_errors);
  m.link_timeouts = static_cast<std::int32_t>(link.timeouts);
  m.link_bus_errors = static_cast<std::int32_t>(link.bus_errors);
  m.link_bus_off = static_cast<std::int32_t>(link.bus_off);
  m.link_frames_lost = static_cast<std::int32_t>(link.frames_lost);
  m.link_frames_foreign = static_cast<std::int32_t>(link.frames_foreign);
  m.link_no_buffer = static_cast<std::int32_t>(link.no_buffer);
}

}  // namespace tautline
