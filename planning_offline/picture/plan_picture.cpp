#include "planning_offline/picture/plan_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tautline::planning {
namespace {

using plot::Colour;
using plot::Drawing;
using plot::Style;
using plot::Symbol;
using plot::View;

/// Cells lo … hi on each axis, both included.
struct CellBox {
  Eigen::Vector3i lo;
  Eigen::Vector3i hi;
};

/// Map axes along the picture's x and y, and into it.
struct ViewAxes {
  int right;
  int up;
  int depth;
};
constexpr std::array<ViewAxes, 3> kViewAxes{{{0, 2, 1}, {0, 1, 2}, {2, 1, 0}}};  // top, front, side

CellBox boxOf(const VoxelMap& map, const std::vector<DrawnPath>& paths) {
  constexpr int kMargin = 2;
  const Eigen::Vector3i last(map.shape.nx - 1, map.shape.ny - 1, map.shape.nz - 1);
  CellBox box{last, Eigen::Vector3i::Zero()};
  for (const DrawnPath& path : paths) {
    for (const StateRisk& state : path.report->states) {
      const Eigen::Vector3i cell = map.cellAt(state.position);
      box.lo = box.lo.cwiseMin(cell);
      box.hi = box.hi.cwiseMax(cell);
    }
  }
  if ((box.lo.array() > box.hi.array()).any()) return {Eigen::Vector3i::Zero(), last};
  box.lo = (box.lo.array() - kMargin).max(0);
  box.hi = (box.hi.array() + kMargin).min(last.array());
  return box;
}

/// The whole map seen along one axis, of its depth only the slab of the box.
plot::Raster obstacleImage(const VoxelMap& map, const ViewAxes& axes, const CellBox& box) {
  const std::array<int, 3> sizes{map.shape.nx, map.shape.ny, map.shape.nz};
  plot::Raster image{.x_min = map.origin[axes.right],
                     .y_min = map.origin[axes.up],
                     .pixel_width = map.resolution,
                     .pixel_height = map.resolution,
                     .columns = sizes[static_cast<std::size_t>(axes.right)],
                     .rows = sizes[static_cast<std::size_t>(axes.up)]};
  image.pixels.reserve(static_cast<std::size_t>(image.columns) *
                       static_cast<std::size_t>(image.rows));
  const double depth = box.hi[axes.depth] - box.lo[axes.depth] + 1;
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      Eigen::Vector3i cell;
      cell[axes.right] = column;
      cell[axes.up] = row;
      int occupied = 0;
      int unknown = 0;
      for (int d = box.lo[axes.depth]; d <= box.hi[axes.depth]; ++d) {
        cell[axes.depth] = d;
        const CellState state = map.cells[static_cast<std::size_t>(map.shape.index(cell))];
        occupied += state == CellState::kOccupied ? 1 : 0;
        unknown += state == CellState::kUnknown ? 1 : 0;
      }
      if (occupied > 0) {
        image.pixels.push_back(plot::grey(0.85 - 0.5 * occupied / depth));
      } else {
        image.pixels.push_back(unknown == static_cast<int>(depth) ? plot::Rgb{238, 233, 245}
                                                                  : plot::grey(1.0));
      }
    }
  }
  return image;
}

constexpr std::array<Colour, 7> kPathColours{Colour::kBlue,   Colour::kVermilion, Colour::kGreen,
                                             Colour::kPurple, Colour::kOrange,    Colour::kSky,
                                             Colour::kBlack};

void addPath(Drawing& drawing, const DrawnPath& path, Colour colour, bool by_risk) {
  plot::SpaceCurve curve{
      .name = path.name, .style = Style::kLinePoints, .colour = colour, .width = 2.4};
  for (const StateRisk& state : path.report->states) {
    curve.points.push_back(state.position);
    if (by_risk) curve.values.push_back(state.risk);
  }
  drawing.curves.push_back(std::move(curve));
}

void addTether(Drawing& drawing, const VoxelMap& map, const StateRisk& end) {
  if (!map.reel) return;
  plot::SpaceCurve tether{
      .name = "tether at the end", .style = Style::kLine, .colour = Colour::kGrey, .width = 1.0};
  tether.points.push_back(*map.reel);
  for (const Eigen::Vector3d& contact : end.contacts) {
    tether.points.push_back(contact);
    drawing.markers.push_back(
        {.at = contact, .symbol = Symbol::kDiamond, .colour = Colour::kVermilion, .size = 1.2});
  }
  tether.points.push_back(end.position);
  drawing.curves.push_back(std::move(tether));
}

void addPlaces(Drawing& drawing, const VoxelMap& map, const std::vector<DrawnPath>& paths,
               const std::vector<Reward>& rewards) {
  if (map.reel)
    drawing.markers.push_back(
        {.at = *map.reel, .symbol = Symbol::kSquare, .size = 1.3, .name = "reel"});
  for (const Reward& reward : rewards) {
    drawing.markers.push_back(
        {.at = reward.position,
         .symbol = Symbol::kTriangle,
         .colour = Colour::kOrange,
         .size = 1.3,
         .name =
             drawing.markers.empty() || drawing.markers.back().name != "reward" ? "reward" : ""});
  }
  if (paths.empty() || paths.front().report->states.empty()) return;
  const auto& states = paths.front().report->states;
  drawing.markers.push_back({.at = states.front().position,
                             .symbol = Symbol::kCircle,
                             .colour = Colour::kGreen,
                             .size = 1.6,
                             .name = "start"});
  drawing.markers.push_back({.at = states.back().position,
                             .symbol = Symbol::kCross,
                             .colour = Colour::kPurple,
                             .size = 1.6,
                             .name = "end"});
}

}  // namespace

plot::Figure planFigure(const std::string& title, const VoxelMap& map,
                        const std::vector<DrawnPath>& paths, const std::vector<Reward>& rewards) {
  Drawing drawing;
  drawing.title = title;
  drawing.value_label = "state risk";
  const CellBox box = boxOf(map, paths);
  for (std::size_t view = 0; view < kViewAxes.size(); ++view)
    drawing.images[view] = obstacleImage(map, kViewAxes[view], box);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    addPath(drawing, paths[i], kPathColours[i % kPathColours.size()], paths.size() == 1);
  }
  if (paths.size() == 1 && !paths.front().report->states.empty()) {
    double highest = 0.0;
    for (const StateRisk& state : paths.front().report->states)
      highest = std::max(highest, state.risk);
    drawing.value_limits = plot::Limits{0.0, highest > 0.0 ? highest : 1.0};
    addTether(drawing, map, paths.front().report->states.back());
  }
  addPlaces(drawing, map, paths, rewards);
  return map.shape.planar() ? viewFigure(drawing, View::kTop) : viewsFigure(drawing);
}

plot::Figure fieldFigure(const std::string& title, const std::string& label, const VoxelMap& map,
                         const std::vector<double>& field, int y) {
  const auto cellOf = [&](int x, int z) {
    return static_cast<std::size_t>(map.shape.index({x, y, z}));
  };
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (int z = 0; z < map.shape.nz; ++z) {
    for (int x = 0; x < map.shape.nx; ++x) {
      const double value = field[cellOf(x, z)];
      if (map.cells[cellOf(x, z)] != CellState::kFree || !std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  if (low > high) low = high = 0.0;
  if (high <= low) high = low + 1.0;
  plot::Raster image{.x_min = map.origin.x(),
                     .y_min = map.origin.z(),
                     .pixel_width = map.resolution,
                     .pixel_height = map.resolution,
                     .columns = map.shape.nx,
                     .rows = map.shape.nz};
  for (int z = 0; z < map.shape.nz; ++z) {
    for (int x = 0; x < map.shape.nx; ++x) {
      const double value = field[cellOf(x, z)];
      switch (map.cells[cellOf(x, z)]) {
        case CellState::kFree:
          image.pixels.push_back(std::isfinite(value) ? plot::viridis((value - low) / (high - low))
                                                      : plot::Rgb{213, 94, 0});
          break;
        case CellState::kOccupied:
          image.pixels.push_back(plot::grey(0.6));
          break;
        case CellState::kUnknown:
          image.pixels.push_back(plot::grey(1.0));
          break;
      }
    }
  }
  plot::Panel panel{.title = title,
                    .x = {.label = "x [m]"},
                    .y = {.label = "z [m]", .reversed = true},
                    .equal_aspect = true,
                    .legend = false,
                    .value_label = label,
                    .value_limits = plot::Limits{low, high},
                    .rasters = {std::move(image)}};
  return {.width_px = 900, .height_px = 700, .panels = {std::move(panel)}};
}

}  // namespace tautline::planning
