#include "planning_offline/map/raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

#include "common/error.h"

namespace tautline::planning {
namespace {

constexpr double kSame = 1e-6;  // [cells]
constexpr double kCellsMax = std::numeric_limits<CellIndex>::max();

/// A grid whose number of cells may still be absurd, so in doubles: first cell and number of cells
/// an axis.
struct GridPlan {
  Eigen::Array3d first{Eigen::Array3d::Zero()};
  Eigen::Array3d count{Eigen::Array3d::Ones()};

  [[nodiscard]] double cells() const { return count.prod(); }
};

/// First and last cell on an axis that meet (lo, hi), in cells from the grid's start.
std::pair<double, double> meeting(double lo, double hi) {
  return {std::floor(lo + kSame), std::ceil(hi - kSame) - 1.0};
}

Bounds boundsOf(const GridPlan& plan, const Eigen::Vector3d& origin, double resolution) {
  const Eigen::Array3d lo = origin.array() + resolution * plan.first;
  return {lo, lo + resolution * plan.count};
}

/// With at most so many significant digits: 2.8 rather than 2.8000000000000003.
std::string shortText(double value, int digits = 3) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.*g", digits, value);
  return text;
}

std::string textOf(const Eigen::Vector3d& p) {
  return "[" + shortText(p.x(), 9) + ", " + shortText(p.y(), 9) + ", " + shortText(p.z(), 9) + "]";
}

std::string textOf(const Bounds& bounds) {
  return textOf(bounds.min) + " to " + textOf(bounds.max);
}

/// The grid over the whole extent, then its part that meets the crop, then the layer of the slice.
GridPlan planGrid(const MapSource& source, double resolution, const LoadOptions& options) {
  const Eigen::Vector3d& origin = source.extent.min;
  GridPlan plan;
  plan.count = (((source.extent.max - origin) / resolution).array() - kSame).ceil().max(1.0);
  if (options.crop) {
    for (int i = 0; i < 3; ++i) {
      const auto [first, last] = meeting((options.crop->min[i] - origin[i]) / resolution,
                                         (options.crop->max[i] - origin[i]) / resolution);
      const double lo = std::max(first, 0.0);
      const double hi = std::min(last, plan.count[i] - 1.0);
      if (lo > hi) {
        throw InputError(
            {.file = source.file,
             .key = "crop",
             .problem = "is " + textOf(*options.crop) + " and meets no cell",
             .allowed = "part of the map, " +
                        textOf(boundsOf(GridPlan{{0, 0, 0}, plan.count}, origin, resolution))});
      }
      plan.first[i] = lo;
      plan.count[i] = hi - lo + 1.0;
    }
  }
  if (options.slice) {
    const double layer = std::floor((*options.slice - origin.y()) / resolution + kSame);
    plan.first.y() = std::clamp(layer, plan.first.y(), plan.first.y() + plan.count.y() - 1.0);
    plan.count.y() = 1.0;
  }
  return plan;
}

bool fits(const MapSource& source, const GridPlan& plan, std::int64_t limit) {
  return plan.cells() <= kCellsMax &&
         plan.cells() * static_cast<double>(source.bytes_per_cell) + source.other_bytes <=
             static_cast<double>(limit);
}

/// The smallest number with two significant digits that is not less.
double roundedUp(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return std::ceil(value / unit - kSame) * unit;
}

std::string memoryText(double bytes) {
  constexpr std::array kUnits{"B", "KiB", "MiB", "GiB", "TiB"};
  std::size_t unit = 0;
  for (; bytes >= 1024.0 && unit + 1 < kUnits.size(); ++unit) bytes /= 1024.0;
  return shortText(bytes, 4) + " " + kUnits[unit];
}

/// A cell size with which the same part of the map fits, if there is one.
std::optional<double> fittingResolution(const MapSource& source, const LoadOptions& options) {
  double r = roundedUp(source.resolution);
  while (r <= kResolutionRange.max) {
    if (fits(source, planGrid(source, r, options), options.memory_limit)) return r;
    r = roundedUp(1.02 * r);
  }
  return std::nullopt;
}

void checkSize(const MapSource& source, const GridPlan& plan, const LoadOptions& options) {
  if (fits(source, plan, options.memory_limit)) return;
  std::string remedy = "crop the map or allow more memory";
  if (const auto r = source.resampled ? fittingResolution(source, options) : std::nullopt) {
    remedy = "a resolution of " + shortText(*r) + " m fits; or " + remedy;
  }
  const std::string what = shortText(plan.count.x(), 10) + " x " + shortText(plan.count.y(), 10) +
                           " x " + shortText(plan.count.z(), 10) + " cells of " +
                           shortText(source.resolution) + " m";
  checkMemory(source.file, what,
              plan.cells() * static_cast<double>(source.bytes_per_cell) + source.other_bytes,
              options.memory_limit, remedy);
  throw InputError({.file = source.file,
                    .problem = what + " are " + shortText(plan.cells()) + " cells",
                    .allowed = "at most " + shortText(kCellsMax, 10) + " cells",
                    .remedy = remedy});
}

/// Crop and slice are sensible, and there is something of the map at the slice's height.
void checkOptions(const MapSource& source, const LoadOptions& options) {
  if (options.crop && !(options.crop->min.array() < options.crop->max.array()).all()) {
    throw InputError({.file = source.file,
                      .key = "crop",
                      .problem = "is " + textOf(*options.crop),
                      .allowed = "a box with min below max in every component"});
  }
  if (!options.slice) return;
  double lo = source.extent.min.y();
  double hi = source.extent.max.y();
  if (options.crop) {
    lo = std::max(lo, options.crop->min.y());
    hi = std::min(hi, options.crop->max.y());
  }
  if (*options.slice >= lo && *options.slice <= hi) return;
  throw InputError({.file = source.file,
                    .key = "slice",
                    .problem = "is at y = " + shortText(*options.slice, 9) + ", outside the map",
                    .allowed = "y from " + shortText(lo, 9) + " to " + shortText(hi, 9)});
}

CellRange clipped(const VoxelMap& map, const Eigen::Array3d& lo, const Eigen::Array3d& hi) {
  const Eigen::Array3d n(map.shape.nx, map.shape.ny, map.shape.nz);
  return {lo.max(0.0).min(n).cast<int>(), hi.min(n - 1.0).max(-1.0).cast<int>()};
}

}  // namespace

void checkMemory(const std::string& file, const std::string& what, double needed,
                 std::int64_t limit, const std::string& remedy) {
  if (needed <= static_cast<double>(limit)) return;
  throw InputError({.file = file,
                    .problem = what + " need " + memoryText(needed),
                    .allowed = "at most " + memoryText(static_cast<double>(limit)),
                    .remedy = remedy});
}

VoxelMap makeMap(const MapSource& source, const LoadOptions& options) {
  checkOptions(source, options);
  const GridPlan plan = planGrid(source, source.resolution, options);
  checkSize(source, plan, options);
  VoxelMap map;
  map.file = source.file;
  map.shape = {static_cast<int>(plan.count.x()), static_cast<int>(plan.count.y()),
               static_cast<int>(plan.count.z())};
  map.resolution = source.resolution;
  map.origin = boundsOf(plan, source.extent.min, source.resolution).min;
  map.cells.assign(map.shape.size(), CellState::kFree);
  return map;
}

CellRange cellsMeeting(const VoxelMap& map, const Bounds& box) {
  const Eigen::Array3d lo = ((box.min - map.origin) / map.resolution).array();
  const Eigen::Array3d hi = ((box.max - map.origin) / map.resolution).array();
  return clipped(map, (lo + kSame).floor(), (hi - kSame).ceil() - 1.0);
}

CellRange cellsCentredIn(const VoxelMap& map, const Bounds& box) {
  const Eigen::Array3d lo = ((box.min - map.origin) / map.resolution).array();
  const Eigen::Array3d hi = ((box.max - map.origin) / map.resolution).array();
  return clipped(map, (lo - 0.5 - kSame).ceil(), (hi - 0.5 + kSame).floor());
}

void mark(VoxelMap& map, const Bounds& box, CellState state) {
  if (state == CellState::kFree) return;
  forEachCell(map.shape, cellsMeeting(map, box), [&](CellIndex i) {
    CellState& cell = map.cells[static_cast<std::size_t>(i)];
    if (cell != CellState::kOccupied) cell = state;
  });
}

void markOutside(VoxelMap& map, const Bounds& box, CellState state) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    Bounds below{Eigen::Vector3d::Constant(-kFar), Eigen::Vector3d::Constant(kFar)};
    Bounds above = below;
    below.max[i] = box.min[i];
    above.min[i] = box.max[i];
    mark(map, below, state);
    mark(map, above, state);
  }
}

void forbidContact(VoxelMap& map, const CellRange& range) {
  forEachCell(map.shape, range, [&](CellIndex i) {
    if (map.cells[static_cast<std::size_t>(i)] != CellState::kOccupied) return;
    map.no_contact.resize(map.shape.size(), 0);
    map.no_contact[static_cast<std::size_t>(i)] = 1;
  });
}

Bounds boundsOf(const VoxelMap& map) {
  return {map.origin,
          map.origin + map.resolution * Eigen::Vector3d(map.shape.nx, map.shape.ny, map.shape.nz)};
}

}  // namespace tautline::planning
