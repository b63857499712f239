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

/// Columns in use; the others (targets, rates, distances) must be numbers and are not looked at:
/// rates stand there uninitialized.
struct FlightLogRow {
  std::int64_t second{0};  ///< Column 1, date and time, as seconds since 1970 without time zone.
  Eigen::Vector3d p_WD{Eigen::Vector3d::Zero()};  ///< Columns 5 to 7: where its program was [m].
  double length{0.0};     ///< Column 11, all that is out, by the machine's nominal scale [m].
  double elevation{0.0};  ///< Column 12 [rad], up positive.
  double azimuth{0.0};    ///< Column 13 [rad], phi - pi/2.
  Eigen::Vector3d p_WA{
      Eigen::Vector3d::Zero()};  ///< Columns 14 to 16 of 22: contact, or the reel [m].
};

enum class FlightLogError : std::uint8_t { kNone, kFieldCount, kNotANumber, kOutOfRange };
inline constexpr std::size_t kFlightLogErrorCount = 4;

struct ParsedFlightLogRow {
  FlightLogError error{FlightLogError::kNone};
  FlightLogRow row;  ///< Set if there is no error.
};

/// Accepted; anything outside makes the row kOutOfRange.
inline constexpr Range kLogLengthRange{0, 200};          ///< [m]
inline constexpr Range kLogElevationRange{-1.65, 1.65};  ///< [rad]
inline constexpr Range kLogAzimuthRange{-6.4, 6.4};      ///< [rad]
inline constexpr Range kLogPositionRange{-200, 200};     ///< [m]

/// Parses one row without its line end. Any bytes are allowed.
[[nodiscard]] ParsedFlightLogRow parseFlightLogRow(std::string_view line) noexcept;

}  // namespace tautline
