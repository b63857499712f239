#pragma once

/// @file
/// Waypoint paths from files, and whether they are free. Not real-time safe: offline only.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/mission/legacy_import.h"
#include "common/mission_plan.h"
#include "planning_offline/cli/workspace.h"

namespace tautline::planning {

/// A path to fly.
struct GivenPath {
  std::vector<Eigen::Vector3d> points;  ///< M [m], at least one; neighbours differ.
  /// One a point: what the file says about speed, hold, look-at (W [m]) and risk. Positions and
  /// contacts of these are worthless.
  std::vector<Waypoint> orders;
  std::optional<Eigen::Vector3d> reel;  ///< Where a mission file has its reel outlet, M [m].
};

struct PathFileOptions {
  std::optional<Eigen::Vector3d> reel;  ///< Of the map, M [m]: the origin of legacy files.
  LegacyOptions legacy;                 ///< Scale and axes of legacy files.
  /// Leave out what a mission has only for the tether: a waypoint in the straight line between its
  /// neighbours where the contact changes and nothing is waited for. A plan's states are the
  /// others.
  bool states_only{false};
};

/// Mission (`.toml`), text with x y z [m] a line in M (spaces or commas, # comments), or a legacy
/// file with 6 or 9 numbers a line in W (common/mission/legacy_import.h), told by its first row. A
/// waypoint where the last one is, as missions have where only the contact changes, is no point of
/// its own. Throws InputError with file and line; scale or axes for another kind of file, or a
/// legacy file without a reel, is an error of usage.
[[nodiscard]] GivenPath readPath(const std::string& file, const PathFileOptions& options);

/// Throws InputError for the first point or way between two that is not in free space
/// (outsideSolids()), and for maps that are too long to tell (needSightSize()).
void needFreeWay(const std::vector<Eigen::Vector3d>& path, const MapSpace& space,
                 const std::string& file);

/// Throws InputError if an obstacle is between the reel outlet and where a path begins: the tether
/// is a straight line when the vehicle takes off. `file` is the path's; empty for one that is
/// to be planned: then it is an error of usage about --start.
void needStraightStart(const VoxelMap& map, const Eigen::Vector3d& reel,
                       const Eigen::Vector3d& start, const std::string& file);

}  // namespace tautline::planning
