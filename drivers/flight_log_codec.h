#pragma once

/// @file
/// One row of the text logs that the published flights of the Fotokite left: 22 columns separated
/// by blanks, or 19 in the earlier ones, which have no contact. Pure, no I/O. Axes are Tautline's
/// but for the azimuth (docs/devices.md).
///
/// Everything here: real-time safe: no allocation, no locks, no exceptions.

#include <array>
#include <cstdint>
#include <string_view>

#include <Eigen/Core>

#include "common/fields.h"

namespace tautline {

/// Order of the columns after the target's position. Rows of 19 columns have either.
enum class FlightLogLayout : std::uint8_t {
  kPositionFirst,  ///< Present position; target's, then present length, elevation, azimuth.
  kPositionLast,   ///< The earliest flights: the same with the present position at the end.
};

/// Columns in use; the others (rates, distance) must be numbers and are not looked at: rates stand
/// there uninitialized.
struct FlightLogRow {
  std::int64_t second{0};  ///< Column 1, date and time, as seconds since 1970 without time zone.
  /// @name What its program flew to. As logged: may be anything, NaN included
  /// @{
  Eigen::Vector3d p_WTarget{Eigen::Vector3d::Zero()};  ///< [m]
  double target_length{0.0};                           ///< All that is to be out [m].
  double target_elevation{0.0};                        ///< From the contact [rad].
  double target_azimuth{0.0};                          ///< phi - pi/2 [rad].
  double acceptance_radius{0.0};                       ///< [m]
  bool reached{false};                                 ///< The target is within it.
  /// @}
  Eigen::Vector3d p_WD{Eigen::Vector3d::Zero()};  ///< Where its program was [m].
  double length{0.0};     ///< All that is out, by the machine's nominal scale [m].
  double elevation{0.0};  ///< [rad], up positive.
  double azimuth{0.0};    ///< [rad], phi - pi/2.
  Eigen::Vector3d p_WA{
      Eigen::Vector3d::Zero()};  ///< Columns 14 to 16 of 22: contact, or the reel [m].
};

enum class FlightLogError : std::uint8_t {
  kNone,
  kFieldCount,
  kNotANumber,
  kOutOfRange,
  kUninitialized,  ///< A number in use that its program never set: subnormal, or beyond 1e100.
};
inline constexpr std::size_t kFlightLogErrorCount = 5;

struct ParsedFlightLogRow {
  FlightLogError error{FlightLogError::kNone};
  FlightLogRow row;  ///< Set if there is no error.
};

/// Accepted of the present state; anything outside makes the row kOutOfRange.
inline constexpr Range kLogLengthRange{0, 200};          ///< [m]
inline constexpr Range kLogElevationRange{-1.65, 1.65};  ///< [rad]
inline constexpr Range kLogAzimuthRange{-6.4, 6.4};      ///< [rad]
inline constexpr Range kLogPositionRange{-200, 200};     ///< [m]

/// Parses one row without its line end. Any bytes are allowed. Rows of 22 columns have but one
/// layout.
[[nodiscard]] ParsedFlightLogRow parseFlightLogRow(
    std::string_view line, FlightLogLayout layout = FlightLogLayout::kPositionFirst) noexcept;

}  // namespace tautline
