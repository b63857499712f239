#pragma once

/// @file
/// A mission in memory: contacts and waypoints, fixed capacity, no heap, so that it may be stored
/// and replaced inside the real-time loop. Files are read by common/mission; missions reach the
/// station over LCM in chunks (lcmtypes).

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

namespace tautline {

inline constexpr int kMaxWaypoints = 2048;
inline constexpr int kMaxContacts = 64;
inline constexpr int kReelContact = 0;  ///< Contact id 0 is the reel outlet.

/// A planned tether contact point.
struct MissionContact {
  int id{0};                                      ///< > 0, unique in the mission.
  Eigen::Vector3d p_WC{Eigen::Vector3d::Zero()};  ///< [m] in W (origin at the reel outlet).
};

struct Waypoint {
  Eigen::Vector3d p_WD{
      Eigen::Vector3d::Zero()};  ///< Where the drone's tether attachment goes [m], in W.
  int contact{kReelContact};     ///< Id of the contact that is active on the way to this waypoint.
  std::optional<Eigen::Vector3d>
      p_WL;           ///< Point to look at [m], in W; absent: keep yaw and gimbal.
  double speed{0.0};  ///< [m/s] towards this waypoint; 0 = the executor's default.
  double hold{0.0};   ///< Stay after arrival [s].
  double risk{0.0};   ///< Planned state risk in [0, 1], for displays.
};

struct MissionPlan {
  std::uint64_t hash{
      0};  ///< Of the mission file's canonical text; identifies the plan in telemetry.
  int waypoint_count{0};
  int contact_count{0};
  std::array<Waypoint, kMaxWaypoints> waypoints{};
  std::array<MissionContact, kMaxContacts> contacts{};

  /// Contact with this id, or nullptr. Real-time safe: no allocation, no locks, no exceptions.
  [[nodiscard]] const MissionContact* findContact(int id) const noexcept {
    for (int i = 0; i < contact_count; ++i) {
      if (contacts[static_cast<std::size_t>(i)].id == id)
        return &contacts[static_cast<std::size_t>(i)];
    }
    return nullptr;
  }
};

}  // namespace tautline
