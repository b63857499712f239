#pragma once

/// @file
/// The operators' messages between the network's bytes and what the core works with, both ways.

#include <cmath>
#include <cstdint>
#include <optional>

#include <tautline/heartbeat_t.hpp>
#include <tautline/operator_command_t.hpp>
#include <tautline/teleop_t.hpp>

#include "app/station/input_message.h"
#include "supervision/command_screen.h"
#include "supervision/operator_command.h"

namespace tautline {

/// Real-time safe: no allocation, no locks, no exceptions. The same holds for all of this file.
template <class Message>
[[nodiscard]] MessageHead headOf(const Message& m) noexcept {
  return {m.utime, m.session, m.sequence};
}

/// Decodes exactly `size` bytes; none for another type's fingerprint, a wrong size or bytes left
/// over.
template <class Message>
[[nodiscard]] std::optional<Message> decodeExactly(const void* bytes, int size) noexcept {
  Message m;
  if (m.decode(bytes, 0, size) != size) return std::nullopt;
  return m;
}

[[nodiscard]] inline OperatorCommand commandOf(const tautline::operator_command_t& m) noexcept {
  return {.session = m.session,
          .sequence = m.sequence,
          .request = static_cast<Request>(m.verb),
          .mission_hash = static_cast<std::uint64_t>(m.mission_hash),
          .service = static_cast<Service>(m.service),
          .parameter = static_cast<std::uint64_t>(m.parameter),
          .value = m.value,
          .name = nameFromBytes(m.name)};
}

[[nodiscard]] inline tautline::operator_command_t messageOf(const OperatorCommand& c) noexcept {
  tautline::operator_command_t m{};
  m.session = c.session;
  m.sequence = c.sequence;
  put(m.name, c.name);
  m.verb = static_cast<std::int8_t>(c.request);
  m.service = static_cast<std::int8_t>(c.service);
  m.mission_hash = static_cast<std::int64_t>(c.mission_hash);
  m.parameter = static_cast<std::int64_t>(c.parameter);
  m.value = c.value;
  return m;
}

/// None for rates that are not finite: a stick that is not a number is no stick.
[[nodiscard]] inline std::optional<Sticks> sticksOf(const tautline::teleop_t& m) noexcept {
  const double sum = m.length_rate_mps + m.elevation_rate_radps + m.azimuth_rate_radps +
                     m.yaw_rate_radps + m.gimbal_pitch_rate_radps;
  if (!std::isfinite(sum)) return std::nullopt;
  return Sticks{m.session,
                m.dead_man != 0,
                {m.length_rate_mps, m.elevation_rate_radps, m.azimuth_rate_radps, m.yaw_rate_radps,
                 m.gimbal_pitch_rate_radps}};
}

}  // namespace tautline
