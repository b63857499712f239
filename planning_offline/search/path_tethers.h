#pragma once

/// @file
/// Tether of the least-risk paths to all cells at once: contacts and taut length of each, by moving
/// the string once for every component that the paths go through instead of once for every step of
/// every path. Not real-time safe: offline only.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "planning_offline/map/lattice.h"
#include "planning_offline/progress.h"
#include "planning_offline/risk/risk_model.h"
#include "planning_offline/search/least_risk_tree.h"

namespace tautline::planning {

/// One entry a cell of the map; of cells that the tree has no path to, the values named here.
struct PathTethers {
  std::vector<double> length;               ///< Taut, at the end of the path [m]; infinite.
  std::vector<std::int32_t> contacts;       ///< At the end of the path; −1.
  std::vector<std::int32_t> contacts_most;  ///< In any state of the path; −1.
  /// Whether all states of the path are within the model's tether limits on length and on elevation
  /// seen from the active anchor (RiskParams::tether_limits); 0.
  std::vector<std::uint8_t> length_allowed;
  std::vector<std::uint8_t> elevation_allowed;
  /// Whether the tether touches no forbidden surface in any state (VoxelMap::no_contact); 0.
  std::vector<std::uint8_t> contact_allowed;
  std::size_t moves{0};  ///< Of the string: components that the paths go through.
  std::size_t bytes{0};  ///< Held at most besides the tree, the string and this result.
  bool complete{false};  ///< False if cancelled: cells not come to are as without a path.
};

/// Length, contacts and limits are those that moving the same string along each path from its start
/// gives (RiskModel::evaluate()), to the last bit: a step always gets the stack of the step before.
/// (Another string in space may differ by its interning, some 1e-9 of a cell: docs/taut_string.md.)
/// `risk` has a string, and is the model that `lattice` and `tree` belong to. Stacks are interned
/// in that string and stay there. 4 bytes a cell and 12 a component, while it runs.
/// Throws InputError if the lattice has 2^27 free cells or more, before anything is walked, or the
/// paths go through so many components.
[[nodiscard]] PathTethers tethersOfPaths(const Lattice& lattice, const RiskModel& risk,
                                         const LeastRiskTree& tree, const Progress& progress);

}  // namespace tautline::planning
