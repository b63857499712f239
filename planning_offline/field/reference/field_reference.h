#pragma once

/// @file
/// The fields of this folder computed in the plainest way, one cell after the other. Tests hold the
/// fast ones equal to them; benchmarks measure the fast ones against them.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/field/distance_field.h"
#include "planning_offline/field/isovist.h"
#include "planning_offline/field/passage_width.h"

namespace tautline::planning {

inline constexpr std::int64_t kNothingNear = -1;

/// Squared distance from a cell's centre to the surface of the nearest obstacle, in half cells:
/// every obstacle cell and every face of the border is looked at. kNothingNear without any.
[[nodiscard]] std::vector<std::int64_t> squaredDistanceReference(
    const GridShape& shape, std::span<const std::uint8_t> obstacles, bool solid_border);

/// isovistField() by a scalar voxel walk (Amanatides and Woo) for every direction and every n-th
/// free cell, 0 in the others.
[[nodiscard]] std::vector<float> isovistReference(const GridShape& shape,
                                                  std::span<const std::uint8_t> obstacles,
                                                  const IsovistOptions& options, int every = 1);

/// widthField() by walking both ways from every cell on every line.
[[nodiscard]] std::vector<float> widthReference(const GridShape& shape,
                                                std::span<const std::uint8_t> obstacles,
                                                const WidthOptions& options);

/// lineOfSight() by clipping the segment against every blocked cell, in exact fractions. Points in
/// units of 1 / `units` of a cell.
[[nodiscard]] bool lineOfSightReference(const GridShape& shape,
                                        std::span<const std::uint8_t> blocked,
                                        const Eigen::Vector3<std::int64_t>& a,
                                        const Eigen::Vector3<std::int64_t>& b, std::int64_t units);

}  // namespace tautline::planning
