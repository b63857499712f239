#pragma once

/// @file
/// The tether as a taut string from the reel round the obstacles to the vehicle. It is a function
/// of the path flown: contacts form on convex edges of occupied cells where the string sweeps onto
/// them and are released where it can straighten again (docs/taut_string.md).
///
/// A contact stack is a number: equal stacks have equal numbers, whatever way led there, so a
/// search can carry and compare them. All points are in M [m]; straight moves, any length. Not
/// thread-safe (stacks are interned). Not real-time safe: offline only.

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

/// Contacts from the reel to the vehicle, interned.
using StackId = std::uint32_t;
inline constexpr StackId kStraight = 0;  ///< No contact: a straight line from the reel.

class TautString {
 public:
  virtual ~TautString() = default;

  [[nodiscard]] virtual const Eigen::Vector3d& reel() const noexcept = 0;

  /// The stack after the vehicle went in a straight line from `from` to `to`. `stack` must belong
  /// to `from`. The string does not judge whether the vehicle may go there.
  [[nodiscard]] virtual StackId move(StackId stack, const Eigen::Vector3d& from,
                                     const Eigen::Vector3d& to) = 0;

  /// The active anchor: the last contact, or the reel.
  [[nodiscard]] virtual Eigen::Vector3d anchor(StackId stack) const = 0;

  /// Tether along the contacts, reel to active anchor [m].
  [[nodiscard]] virtual double staticLength(StackId stack) const = 0;

  [[nodiscard]] virtual int contactCount(StackId stack) const = 0;

  /// Contact points from the reel to the vehicle.
  [[nodiscard]] virtual std::vector<Eigen::Vector3d> contacts(StackId stack) const = 0;

  /// True if a contact of the stack touches a cell that the tether must not touch
  /// (VoxelMap::no_contact): such a stack is beyond a hard limit.
  [[nodiscard]] virtual bool touchesForbidden(StackId stack) const = 0;

  /// Moves so far after which no string outside all obstacles was found (docs/taut_string.md): zero
  /// in the plane, and in space as long as no move goes through an obstacle.
  [[nodiscard]] virtual std::int64_t unresolvedMoves() const noexcept { return 0; }

  /// Taut length to a vehicle at `position` [m].
  [[nodiscard]] double length(StackId stack, const Eigen::Vector3d& position) const {
    return staticLength(stack) + (position - anchor(stack)).norm();
  }
};

/// The string for a map: exact in the plane (integer arithmetic; frictionless) if the map is
/// planar, then the reel is taken into the plane; else with contacts pinned to the edges where they
/// formed. Only kOccupied cells touch the tether; what is outside the map does not. Throws
/// InputError if the reel is inside an obstacle.
[[nodiscard]] std::unique_ptr<TautString> makeTautString(const VoxelMap& map,
                                                         const Eigen::Vector3d& reel);

}  // namespace tautline::planning
