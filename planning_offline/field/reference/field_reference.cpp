#include "planning_offline/field/reference/field_reference.h"

#include <algorithm>
#include <cmath>

#include "planning_offline/map/lattice.h"

namespace tautline::planning {
namespace {

bool isObstacle(const GridShape& shape, std::span<const std::uint8_t> obstacles,
                const Eigen::Vector3i& cell) {
  return obstacles[static_cast<std::size_t>(shape.index(cell))] != 0;
}

std::int64_t gap(int a, int b) { return a == b ? 0 : 2 * std::abs(a - b) - 1; }

/// A point on a segment: numerator / denominator, denominator > 0.
struct Fraction {
  std::int64_t n;
  std::int64_t d;
  friend bool operator<(const Fraction& a, const Fraction& b) { return a.n * b.d < b.n * a.d; }
};

bool meetsInterior(const Eigen::Vector3i& cell, const Eigen::Vector3<std::int64_t>& a,
                   const Eigen::Vector3<std::int64_t>& b, std::int64_t units) {
  Fraction enters{0, 1};
  Fraction leaves{1, 1};
  bool is_point = true;
  for (int k = 0; k < 3; ++k) {
    const std::int64_t low = cell[k] * units;
    const std::int64_t high = low + units;
    const std::int64_t way = b[k] - a[k];
    if (way == 0) {
      if (a[k] <= low || a[k] >= high) return false;
      continue;
    }
    is_point = false;
    const Fraction first = way > 0 ? Fraction{low - a[k], way} : Fraction{a[k] - high, -way};
    const Fraction last = way > 0 ? Fraction{high - a[k], way} : Fraction{a[k] - low, -way};
    enters = std::max(enters, first);
    leaves = std::min(leaves, last);
  }
  return is_point || enters < leaves;
}

}  // namespace

std::vector<std::int64_t> squaredDistanceReference(const GridShape& shape,
                                                   std::span<const std::uint8_t> obstacles,
                                                   bool solid_border) {
  const int sizes[] = {shape.nx, shape.ny, shape.nz};
  std::vector<std::int64_t> squared(shape.size(), kNothingNear);
  for (std::size_t i = 0; i < squared.size(); ++i) {
    const Eigen::Vector3i cell = shape.cell(static_cast<CellIndex>(i));
    const auto consider = [&](std::int64_t value) {
      if (squared[i] == kNothingNear || value < squared[i]) squared[i] = value;
    };
    for (std::size_t j = 0; j < squared.size(); ++j) {
      if (obstacles[j] == 0) continue;
      const Eigen::Vector3i other = shape.cell(static_cast<CellIndex>(j));
      std::int64_t sum = 0;
      for (int k = 0; k < 3; ++k) sum += gap(cell[k], other[k]) * gap(cell[k], other[k]);
      consider(sum);
    }
    for (int k = 0; k < 3 && solid_border; ++k) {
      if (k == 1 && shape.planar()) continue;
      const std::int64_t to_border = 2 * std::min(cell[k], sizes[k] - 1 - cell[k]) + 1;
      if (obstacles[i] == 0) consider(to_border * to_border);
    }
  }
  return squared;
}

std::vector<float> isovistReference(const GridShape& shape, std::span<const std::uint8_t> obstacles,
                                    const IsovistOptions& options, int every) {
  const int count = options.directions > 0 ? options.directions
                    : shape.planar()       ? kIsovistDirectionsPlanar
                                           : kIsovistDirections;
  const std::vector<Eigen::Vector3d> directions = isovistDirections(count, shape.planar());
  const double cap = options.cap / options.resolution;
  const double unit =
      options.cap / (static_cast<double>(kIsovistUnits) * static_cast<double>(directions.size()));
  std::vector<float> visibility(shape.size(), 0.0F);
  int free = 0;
  for (std::size_t i = 0; i < visibility.size(); ++i) {
    if (obstacles[i] != 0 || ++free % every != 0) continue;
    const Eigen::Vector3i start = shape.cell(static_cast<CellIndex>(i));
    std::uint32_t sum = 0;
    for (const Eigen::Vector3d& direction : directions) {
      const double plane[] = {1.0 / std::abs(direction.x()), 1.0 / std::abs(direction.y()),
                              1.0 / std::abs(direction.z())};
      const int sign[] = {direction.x() < 0.0 ? -1 : 1, direction.y() < 0.0 ? -1 : 1,
                          direction.z() < 0.0 ? -1 : 1};
      double next[] = {0.5 * plane[0], 0.5 * plane[1], 0.5 * plane[2]};
      int crossed[] = {0, 0, 0};
      Eigen::Vector3i cell = start;
      double length = 0.0;
      do {
        length = std::min({next[0], next[1], next[2]});
        for (int k = 0; k < 3; ++k) {
          if (next[k] != length) continue;
          cell[k] += sign[k];
          next[k] = (++crossed[k] + 0.5) * plane[k];
        }
      } while (length < cap && shape.contains(cell) && !isObstacle(shape, obstacles, cell));
      sum += isovistUnits(length, cap);
    }
    visibility[i] = static_cast<float>(unit * sum);
  }
  return visibility;
}

std::vector<float> widthReference(const GridShape& shape, std::span<const std::uint8_t> obstacles,
                                  const WidthOptions& options) {
  std::vector<float> width(shape.size(), 0.0F);
  for (std::size_t i = 0; i < width.size(); ++i) {
    if (obstacles[i] != 0) continue;
    double narrowest = options.cap;
    for (const Direction d : directionsOf(Connectivity::kVertices, shape.planar())) {
      int cells = 1;
      bool open = false;
      for (const Direction way : {d, opposite(d)}) {
        Eigen::Vector3i cell = shape.cell(static_cast<CellIndex>(i)) + stepOf(way);
        for (; shape.contains(cell) && !isObstacle(shape, obstacles, cell); cell += stepOf(way)) {
          ++cells;
        }
        open = open || (!shape.contains(cell) && !options.solid_border);
      }
      if (!open) narrowest = std::min(narrowest, cells * (options.resolution * stepLength(d)));
    }
    width[i] = static_cast<float>(narrowest);
  }
  return width;
}

bool lineOfSightReference(const GridShape& shape, std::span<const std::uint8_t> blocked,
                          const Eigen::Vector3<std::int64_t>& a,
                          const Eigen::Vector3<std::int64_t>& b, std::int64_t units) {
  for (std::size_t i = 0; i < blocked.size(); ++i) {
    if (blocked[i] == 0) continue;
    if (meetsInterior(shape.cell(static_cast<CellIndex>(i)), a, b, units)) return false;
  }
  return true;
}

}  // namespace tautline::planning
