#include "planning_offline/picture/plan_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "planning_offline/picture/map_drawing.h"

namespace tautline::planning {
namespace {

using plot::Colour;
using plot::Drawing;
using plot::Style;
using plot::Symbol;

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
  std::vector<Eigen::Vector3d> points;
  for (const DrawnPath& path : paths) {
    for (const StateRisk& state : path.report->states) points.push_back(state.position);
  }
  Drawing drawing = mapDrawing(title, map, points);
  drawing.value_label = "state risk";
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
  return mapFigure(map, drawing);
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
