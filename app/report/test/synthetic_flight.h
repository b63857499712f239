#pragma once

/// @file
/// An invented flight whose figures are known beforehand, written as an LCM log: take-off, four
/// straight legs with one tether contact, landing. No simulator and no station: the report must not
/// need them.

#include <cstdint>
#include <filesystem>
#include <vector>

#include <Eigen/Core>

namespace tautline::report {

struct SyntheticFlight {
  std::int64_t start_utime{0};     ///< [us] 0 = the bench's virtual clock.
  double offset_y{0.05};           ///< Truth above the planned legs, which are all level [m].
  double wobble{0.0};              ///< Amplitude of a slow sideways swing on top [m].
  double estimate_offset_z{0.08};  ///< Estimate minus truth [m].
  bool completes{true};  ///< The last waypoint is reached; else the mission fails on the way to it.
  bool lands{true};      ///< Else the log ends in the air.
  double touchdown_speed{0.2};  ///< [m/s]
  bool with_truth{true};
  bool with_plan{true};
};

/// Corners of the flown mission: start of the first leg and the waypoints, in W [m].
[[nodiscard]] const std::vector<Eigen::Vector3d>& syntheticCorners();

/// Where the contact forms [m] in W: active from the third leg on.
[[nodiscard]] Eigen::Vector3d syntheticContact();

inline constexpr double kSyntheticSpeed = 0.25;        ///< Along the legs [m/s].
inline constexpr double kSyntheticMissionStart = 8.0;  ///< [s]
inline constexpr std::int64_t kSyntheticHash = 0x1234567890abcdef;

void writeSyntheticLog(const SyntheticFlight& flight, const std::filesystem::path& file);

}  // namespace tautline::report
