#pragma once

/// @file
/// Missions on their way into the station: chunks arrive over LCM in any order, possibly twice; a
/// mission becomes loaded when every item is there and every waypoint's contact exists.

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>

#include <tautline/mission_chunk_t.hpp>

#include "common/mission_plan.h"

namespace tautline {

/// Two plans: the one being received or waiting, and the one being flown, which stays as it is
/// while the other changes. Real-time safe: no allocation, no locks, no exceptions.
class MissionStore {
 public:
  /// Takes one chunk; false if it is malformed. A chunk of another mission than the one in memory
  /// starts that one anew.
  bool add(const tautline::mission_chunk_t& chunk) noexcept;

  /// The complete plan that waits to be flown, or nullptr.
  [[nodiscard]] const MissionPlan* loaded() const noexcept {
    return complete_ ? &incoming() : nullptr;
  }

  /// The plan that is being flown or was flown last, or nullptr.
  [[nodiscard]] const MissionPlan* active() const noexcept {
    return has_active_ ? &plans_[1 - incoming_] : nullptr;
  }

  /// Makes the loaded plan the active one. Pre-condition: loaded() is not null.
  void activate() noexcept;

  /// Waypoints received so far of the present mission.
  [[nodiscard]] int receivedWaypoints() const noexcept {
    return static_cast<int>(has_waypoint_.count());
  }

 private:
  void begin(const tautline::mission_chunk_t& chunk) noexcept;
  [[nodiscard]] bool isComplete() const noexcept;

  [[nodiscard]] const MissionPlan& incoming() const noexcept { return plans_[incoming_]; }

  std::array<MissionPlan, 2> plans_{};
  std::size_t incoming_{0};  ///< Index of the plan being received; the other one is flown.
  bool has_active_{false};
  std::bitset<kMaxWaypoints> has_waypoint_;
  std::bitset<kMaxContacts> has_contact_;
  bool complete_{false};
};

}  // namespace tautline
