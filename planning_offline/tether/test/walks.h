#pragma once

/// @file
/// Maps and walks for the tests and the benchmark of the taut string. Deterministic for a seed.

#include <cstdint>
#include <random>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/lattice.h"
#include "planning_offline/map/voxel_map.h"

namespace tautline::planning::walks {

using Random = std::mt19937_64;

/// A map of free cells, of 0.5 m and away from the origin so that units and offsets matter.
[[nodiscard]] VoxelMap emptyMap(const GridShape& shape);

/// Marks one cell.
void occupy(VoxelMap& map, const Eigen::Vector3i& cell);

/// Occupied cells at random, about one in `one_in`.
[[nodiscard]] VoxelMap clutteredMap(const GridShape& shape, int one_in, Random& random);

/// `count` random boxes of up to `side` cells along each axis.
[[nodiscard]] VoxelMap boxesMap(const GridShape& shape, int count, int side, Random& random);

/// The lattice of all free cells.
[[nodiscard]] Lattice freeLattice(const VoxelMap& map, Connectivity connectivity);

/// A random walk between neighbouring free cells that seldom turns back, from a random free cell;
/// `steps` + 1 cells, or one cell if there is no way out of it.
[[nodiscard]] std::vector<CellIndex> randomWalk(const Lattice& lattice, int steps, Random& random);

/// Centres of cells.
[[nodiscard]] std::vector<Eigen::Vector3d> centres(const VoxelMap& map,
                                                   const std::vector<CellIndex>& cells);

/// 8³ cells of clutter or boxes, by turns.
[[nodiscard]] VoxelMap spaceMap(std::uint64_t seed, Random& random);

/// Centres of a random walk with all 26 directions.
[[nodiscard]] std::vector<Eigen::Vector3d> spaceWalk(const VoxelMap& map, int steps,
                                                     Random& random);

}  // namespace tautline::planning::walks
