#pragma once

/// @file
/// The taut string in space without friction: its contacts slide along their edges, and off their
/// ends, to where the string is shortest. It follows one flight, so that the string is the one that
/// the way of the vehicle leaves, not the shortest of all. With the pinned string (taut_string.h)
/// it brackets the true tether: friction decides between them. In the plane both are the same. Not
/// thread-safe. Not real-time safe: offline only.

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"
#include "planning_offline/tether/string_sweep.h"

namespace tautline::planning {

class SlidingString {
 public:
  /// The vehicle starts at the reel [M, m]. Keeps a copy of the map's cells. Throws InputError if
  /// the reel may not stand there (checkedReel()).
  SlidingString(const VoxelMap& map, const Eigen::Vector3d& reel);

  [[nodiscard]] Eigen::Vector3d reel() const { return origin_ + resolution_ * reel_; }

  /// The vehicle goes straight to p [M, m]; finite, within kFarthest of the map's origin. A move
  /// ends after at most 2000 sweeps of parts of the string, unresolved if they were not enough.
  void moveTo(const Eigen::Vector3d& p_M);

  /// From the reel along the contacts to the vehicle [m].
  [[nodiscard]] double length() const;

  /// On the obstacles' edges, from the reel to the vehicle, M [m].
  [[nodiscard]] std::vector<Eigen::Vector3d> contacts() const;

  /// Moves so far after which no string outside all obstacles was found, or none at rest.
  [[nodiscard]] std::int64_t unresolvedMoves() const noexcept { return unresolved_; }

 private:
  /// A bend and the stretch of its edge that it can slide along.
  struct Held {
    Bend bend;
    EdgeRun run;
  };
  using Bends = std::vector<Held>;
  class Side;

  // All points below are in cells.

  /// StringSweep::drag(), as often as a move may.
  [[nodiscard]] bool lead(Side& side, const Eigen::Vector3d& x, const Eigen::Vector3d& q);
  [[nodiscard]] bool follow(const Eigen::Vector3d& q);
  /// Until the string is at rest; false if it takes more rounds than any string needs.
  [[nodiscard]] bool relax();
  /// Takes out the bends that hold nothing. False if that does not end.
  [[nodiscard]] bool settle();
  enum class Slid : std::uint8_t {
    kNot,
    kAlong,       ///< The same bends, one of them elsewhere.
    kOverOthers,  ///< Bends came or went.
    kEndless,     ///< More events than any string needs.
  };
  /// All bends to where the whole string rests, one after the other, until the first that changes
  /// which there are. Quick, but a bend may be led too far, and others come and go.
  [[nodiscard]] Slid slideTogether();
  /// One bend towards where it rests between its neighbours, as far as that makes the string
  /// shorter: an end is sure.
  [[nodiscard]] Slid slideOne();
  /// One bend off the end of its edge, if one is pulled over it, or all those at one corner.
  [[nodiscard]] Slid slipOne();
  /// At which end of its edge that it can slip off bend i is: +1, −1; 0: at none.
  [[nodiscard]] int slipSign(std::size_t i) const;
  /// From a corner of an obstacle onto another edge that begins there, if that makes the string
  /// shorter.
  [[nodiscard]] Slid turnCorner();
  [[nodiscard]] bool turnCorner(std::size_t first, std::size_t end,
                                const ShrunkSolid::EdgeEnd& onto);
  /// First of the bends that are at one place with bend end − 1.
  [[nodiscard]] std::size_t cornerBefore(std::size_t end) const;
  /// Leads bend i along its edge, while both parts of the string sweep.
  [[nodiscard]] Slid slide(std::size_t i, double place);
  /// Takes bends first … end − 1, which are at one place, off to a place just beside it, and pulls
  /// the string straight there.
  [[nodiscard]] Slid slip(std::size_t first, std::size_t end, const Eigen::Vector3d& off);
  /// Leads the string's point at bends first … end − 1 to another place: what becomes of the bends
  /// on both sides of it. False if a sweep does not end.
  [[nodiscard]] bool sweepBoth(Side& reel_side, Side& end_side, std::size_t first, std::size_t end,
                               const Eigen::Vector3d& to);
  /// Takes bend i out and pulls the string straight there.
  [[nodiscard]] bool straighten(std::size_t i);
  [[nodiscard]] bool free() const;
  [[nodiscard]] double lengthInCells() const;

  [[nodiscard]] const Eigen::Vector3d& before(std::size_t i) const {
    return i > 0 ? bends_[i - 1].bend.at : reel_;
  }
  [[nodiscard]] const Eigen::Vector3d& after(std::size_t i) const {
    return i + 1 < bends_.size() ? bends_[i + 1].bend.at : end_;
  }

  Eigen::Vector3d origin_;
  double resolution_;
  StringSweep sweep_;
  Eigen::Vector3d reel_;
  Eigen::Vector3d end_;
  Bends bends_;  ///< From the reel to the vehicle.
  int sweeps_left_{0};
  std::int64_t unresolved_{0};
};

}  // namespace tautline::planning
