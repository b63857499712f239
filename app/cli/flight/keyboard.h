#pragma once

/// @file
/// A keyboard as sticks: keys move them in steps, the held space bar is the dead man's switch. A
/// terminal knows no key releases: a held key is one that repeats. Not real-time safe.

#include <termios.h>

#include <array>
#include <optional>
#include <string>

#include "common/time.h"
#include "common/vehicle.h"

namespace tautline::cli::flight {

/// A terminal that hands on every key at once, without echo; as it was when this ends.
class RawTerminal {
 public:
  /// @throws InputError if standard input is no terminal.
  RawTerminal();
  ~RawTerminal();
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;

  /// Keys pressed since the last call; nullopt: the terminal is gone.
  [[nodiscard]] std::optional<std::string> read() const;

 private:
  termios before_{};
};

/// One stick: the two keys that move it, by how much, and how far.
struct StickKeys {
  const char* name;
  char up;
  char down;
  double TeleopRates::*rate;
  double step;
  double most;
  const char* unit;
};
inline constexpr std::array<StickKeys, 5> kSticks{
    {{"length", 'r', 'f', &TeleopRates::length, 0.05, 0.4, "m/s"},
     {"elevation", 'w', 's', &TeleopRates::elevation, 0.05, 0.4, "rad/s"},
     {"azimuth", 'd', 'a', &TeleopRates::azimuth, 0.05, 0.4, "rad/s"},
     {"yaw", 'q', 'e', &TeleopRates::yaw, 0.1, 1.0, "rad/s"},
     {"gimbal", 't', 'g', &TeleopRates::gimbal_pitch, 0.1, 1.0, "rad/s"}}};

/// What the keys pressed so far say. Pure.
class KeyboardSticks {
 public:
  /// A key at `now`.
  void press(char key, Time now) noexcept;

  /// The space bar counts as held until it has not repeated for a while: 700 ms after its first
  /// stroke, which is how long terminals wait before they repeat, then 150 ms. Once released, all
  /// sticks go back to the middle.
  void update(Time now) noexcept;

  [[nodiscard]] bool deadManHeld() const noexcept { return held_until_.has_value(); }
  /// Ctrl-C, Ctrl-D or Escape.
  [[nodiscard]] bool wantsToEnd() const noexcept { return end_; }
  [[nodiscard]] const TeleopRates& rates() const noexcept { return rates_; }

 private:
  TeleopRates rates_;
  std::optional<Time> held_until_;
  Time last_stroke_{};
  bool end_{false};
};

}  // namespace tautline::cli::flight
