#pragma once

/// @file
/// One message of the Tautline bus as the emulated devices have it. The simulator's own type, as
/// its encoder and parser are its own.

#include <array>
#include <cstdint>

namespace tautline::sim {

struct TautlineFrame {
  std::uint16_t id{0};
  std::uint8_t size{0};  ///< [byte]
  std::array<std::uint8_t, 8> data{};
};

}  // namespace tautline::sim
