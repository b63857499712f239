#pragma once

/// @file
/// The taut string in space: contacts are pinned where they formed, as friction would hold them,
/// until the string straightens over their edge. Not real-time safe: offline only.
///
/// All decisions are taken against the shrunk obstacles (shrunk_solid.h); contacts are reported on
/// the true edges. docs/taut_string.md has the algorithm and its limits.

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"
#include "planning_offline/tether/string_sweep.h"
#include "planning_offline/tether/tree_string.h"

namespace tautline::planning {

class PinnedString final : public TreeString {
 public:
  /// Keeps a copy of the map's cells. Throws InputError if the reel may not stand there
  /// (checkedReel()).
  PinnedString(const VoxelMap& map, const Eigen::Vector3d& reel);

  /// Points of a move must be finite and within kFarthest of the map's origin. If no string outside
  /// the obstacles is found, not by small detours either, the result is that of the straight move,
  /// and unresolvedMoves() counts it. Such is a move through an obstacle.
  [[nodiscard]] StackId move(StackId stack, const Eigen::Vector3d& from,
                             const Eigen::Vector3d& to) override;

  [[nodiscard]] std::int64_t unresolvedMoves() const noexcept override { return unresolved_; }

 private:
  /// A stack of the tree as the sweep moves it.
  class Held;

  // All points below are in cells.

  [[nodiscard]] Eigen::Vector3d cellsOf(const Eigen::Vector3d& p_M) const;

  /// The stack after the string's end went from x straight to q; nothing if that takes more events
  /// than any string needs.
  [[nodiscard]] std::optional<StackId> drag(StackId stack, const Eigen::Vector3d& x,
                                            const Eigen::Vector3d& q);
  [[nodiscard]] StackId push(StackId stack, const Bend& bend);

  /// True if no part of the string penetrates an obstacle, its end having been dragged to `end`.
  [[nodiscard]] bool free(StackId stack, const Eigen::Vector3d& end);

  Eigen::Vector3d origin_;
  double resolution_;
  StringSweep sweep_;
  std::vector<Eigen::Vector3d> anchors_;  ///< By stack: its last contact on the shrunk edge.
  std::vector<std::uint8_t> checked_;     ///< By stack: all of the string below its last contact is
                                          ///< known to be free.
  std::int64_t unresolved_{0};
};

}  // namespace tautline::planning
