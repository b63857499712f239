#pragma once

/// @file
/// The contact points at which the tether bends, C0 (reel outlet) to Ck, and what they make of a
/// target: dissertation section 5.3.3, eqs. (C8)-(C10) of docs/control.md.
///
/// The tether from the reel to the last contact is taken as static; every tether variable of
/// estimation and control is relative to that contact, the active anchor A.

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "common/estimate.h"
#include "common/mission_plan.h"
#include "common/tether_geometry.h"

namespace tautline {

/// A drone position as tether variables: relative to the active anchor, and what the reel must
/// show.
struct EffectiveControls {
  double L_static{0.0};  ///< Reel to A along the contacts [m].
  TetherCoordinates q;   ///< Straight line A to D: L_eff [m], theta, phi [rad].
  double L_total{0.0};   ///< L_static + L_eff [m]: the length to have out.
};

/// Real-time safe throughout: no allocation, no locks, no exceptions.
class ContactStack {
 public:
  enum class Change : std::uint8_t {
    kNone,       ///< Already the active anchor.
    kPushed,     ///< New contact on top.
    kPopped,     ///< One or more contacts relaxed.
    kUnknownId,  ///< Neither on the stack nor in the plan; nothing changed.
    kFull,       ///< No room; nothing changed.
    kBadPoint,   ///< The plan's point is not finite; nothing changed.
  };

  ContactStack() noexcept { clear(); }

  /// Back to the bare reel outlet: after landing, or when the tether is known to be free.
  void clear() noexcept;

  /// Makes contact `id` (0 = reel outlet) the active anchor: pops down to it if it is on the stack,
  /// else pushes it with its position in `plan`.
  [[nodiscard]] Change select(int id, const MissionPlan& plan) noexcept;

  /// Puts a contact at p_WC [m] on top: kPushed, kFull or kBadPoint.
  [[nodiscard]] Change push(int id, const Eigen::Vector3d& p_WC) noexcept;

  [[nodiscard]] Anchor anchor() const noexcept;
  [[nodiscard]] int activeId() const noexcept { return top().id; }

  /// Number of contacts besides the reel outlet.
  [[nodiscard]] int contactCount() const noexcept { return size_ - 1; }

  /// Id of C_i, 0 <= i <= contactCount(); C0 is the reel outlet.
  [[nodiscard]] int id(int i) const noexcept { return entries_[static_cast<std::size_t>(i)].id; }

  /// C_i in W, 0 <= i <= contactCount(); C0 is W's origin.
  [[nodiscard]] const Eigen::Vector3d& point(int i) const noexcept {
    return entries_[static_cast<std::size_t>(i)].p_WC;
  }

  /// Eqs. (C8)-(C10) for a drone at p_WD.
  [[nodiscard]] EffectiveControls effective(const Eigen::Vector3d& p_WD) const noexcept;

 private:
  struct Entry {
    int id{kReelContact};
    Eigen::Vector3d p_WC{Eigen::Vector3d::Zero()};
    double L_static{0.0};
  };

  [[nodiscard]] const Entry& top() const noexcept {
    return entries_[static_cast<std::size_t>(size_ - 1)];
  }

  std::array<Entry, kMaxContacts + 1> entries_{};
  int size_{1};
};

}  // namespace tautline
