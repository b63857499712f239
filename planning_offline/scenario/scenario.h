#pragma once

/// @file
/// Scenario files of the MovingAI benchmarks: shortest paths whose lengths are published, and the
/// check that our maps and moves give the same (docs/maps.md). Lengths are in cells: steps over
/// faces count 1, over edges √2, over vertices √3, and no step cuts a corner. Not real-time safe:
/// offline only.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"
#include "planning_offline/progress.h"

namespace tautline::planning {

struct Scenario {
  int line{0};  ///< Of the file.
  Eigen::Vector3i start{Eigen::Vector3i::Zero()};
  Eigen::Vector3i goal{Eigen::Vector3i::Zero()};
  double length{0.0};     ///< Published optimum [cells].
  double tolerance{0.0};  ///< How exactly it was published [cells].
};

struct ScenarioFile {
  std::string file;
  std::string map{};  ///< Name of the map as the file gives it.
  /// 2-D `.scen`: start and goal are (column, 0, row), moves 8-connected. Else 3-D: 26-connected.
  bool planar{false};
  GridShape shape{};  ///< Of the map, 2-D only; the 3-D format does not say.
  std::vector<Scenario> rows{};
};

/// `.3dscen`: `version 1`, the map's name, then `sx sy sz gx gy gz length ratio` a line. `.scen`:
/// `version 1`, then `bucket map width height sx sy gx gy length` a line. Which one it is is told
/// by the content. Throws InputError with file and line.
[[nodiscard]] ScenarioFile readScenarios(const std::filesystem::path& path);

/// `name` stands for the file in errors.
[[nodiscard]] ScenarioFile parseScenarios(std::string_view text, const std::string& name);

struct ScenarioResult {
  Scenario scenario;
  std::optional<double>
      found{};        ///< Length of the shortest path [cells]; nothing if there is none.
  bool equal{false};  ///< Within the scenario's tolerance.
};

struct ScenarioReport {
  std::vector<ScenarioResult> rows;  ///< In the order of the file; fewer if cancelled.
  std::size_t mismatches{0};
  bool cancelled{false};

  /// Everything was checked and is equal.
  explicit operator bool() const noexcept { return mismatches == 0 && !cancelled; }
};

/// Finds the shortest path of each row; unknown cells are blocked. Deterministic. Throws InputError
/// if the scenarios are of another map: plane against space, another size, a place outside it.
[[nodiscard]] ScenarioReport checkScenarios(const VoxelMap& map, const ScenarioFile& scenarios,
                                            const Progress& progress);

}  // namespace tautline::planning
