#pragma once

/// @file
/// The map that everything in planning_offline works on: a dense grid of cubic cells in the map
/// frame M (metres, y up, zx horizontal; docs/maps.md says how each file format's axes become x, y,
/// z). A map with one cell along y is planar: planners then move in the zx plane, and 4 / 8
/// neighbours take the place of 6 / 26. Not real-time safe: offline only.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/mission/scene.h"

namespace tautline::planning {

/// Index of a cell in the arrays of a map, x fastest, then y, then z.
using CellIndex = std::int32_t;
inline constexpr CellIndex kNoCell = -1;

/// Number of cells along x, y, z, and the way from coordinates to array index and back. At most
/// 2^31 - 1 cells.
struct GridShape {
  int nx{0};
  int ny{0};
  int nz{0};

  [[nodiscard]] std::size_t size() const noexcept {
    return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) *
           static_cast<std::size_t>(nz);
  }
  [[nodiscard]] bool contains(const Eigen::Vector3i& c) const noexcept {
    return c.x() >= 0 && c.x() < nx && c.y() >= 0 && c.y() < ny && c.z() >= 0 && c.z() < nz;
  }
  /// The cell must be contained.
  [[nodiscard]] CellIndex index(const Eigen::Vector3i& c) const noexcept {
    return (c.z() * ny + c.y()) * nx + c.x();
  }
  [[nodiscard]] Eigen::Vector3i cell(CellIndex i) const noexcept {
    return {i % nx, (i / nx) % ny, i / (nx * ny)};
  }
  [[nodiscard]] bool planar() const noexcept { return ny == 1; }
  friend bool operator==(const GridShape&, const GridShape&) = default;
};

enum class CellState : std::uint8_t { kFree, kOccupied, kUnknown };

/// Risk elements that read a layer of the map; the only names a MapLayer has.
inline constexpr std::array<const char*, 6> kMapLayerNames{
    "dynamic_threat",    "verticality", "lateral_inclination",
    "terrain_stability", "surface",     "slippage"};

/// Risk of an element that a map brings along (terrain, surface, threat …): one value a cell, zero
/// where nothing was said. Which elements read a layer: docs/risk.md.
struct MapLayer {
  std::string name;            ///< Name of the risk element, e.g. "terrain_stability".
  std::vector<double> values;  ///< One a cell; meaning and unit are the element's.
};

/// Occupied and unknown cells, and what a scene says about the mission. Positions in M [m].
struct VoxelMap {
  std::string name;       ///< As shown to people.
  std::string file;       ///< Where it came from; empty if made in memory.
  std::uint64_t hash{0};  ///< FNV-1a of the file's bytes (common/mission/mission_file.h).
  GridShape shape;
  double resolution{1.0};                           ///< Edge of a cell [m].
  Eigen::Vector3d origin{Eigen::Vector3d::Zero()};  ///< Lower corner of cell (0, 0, 0).
  std::vector<CellState> cells;
  /// One a cell, 1 where the cell is occupied and the tether must not touch it (sharp edges); empty
  /// if there is no such cell.
  std::vector<std::uint8_t> no_contact;
  bool solid_border{false};  ///< What lies outside is wall (a scene's room), not just unmapped.
  std::optional<Eigen::Vector3d> reel;
  std::optional<Eigen::Vector3d> start;
  std::vector<Reward> rewards;
  std::vector<MapLayer> layers;

  [[nodiscard]] Eigen::Vector3d centre(CellIndex i) const noexcept {
    return origin + resolution * (shape.cell(i).cast<double>().array() + 0.5).matrix();
  }
  /// Cell that holds p; on a face the upper one. May be outside: ask shape.contains().
  [[nodiscard]] Eigen::Vector3i cellAt(const Eigen::Vector3d& p) const noexcept {
    return ((p - origin) / resolution).array().floor().cast<int>();
  }
  /// Index of the cell that holds p, kNoCell outside.
  [[nodiscard]] CellIndex indexAt(const Eigen::Vector3d& p) const noexcept {
    const Eigen::Vector3i c = cellAt(p);
    return shape.contains(c) ? shape.index(c) : kNoCell;
  }
};

}  // namespace tautline::planning
