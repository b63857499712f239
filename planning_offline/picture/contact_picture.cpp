#include "planning_offline/picture/contact_picture.h"

#include <utility>
#include <vector>

#include "planning_offline/picture/map_drawing.h"

namespace tautline::planning {
namespace {

using plot::Colour;
using plot::Drawing;
using plot::Style;
using plot::Symbol;

constexpr std::size_t kPointsDrawn = 150;  // more of them would hide the line

using Points = std::vector<Eigen::Vector3d>;

/// One tether, reel to vehicle.
Points tether(const Eigen::Vector3d& reel, const Points& contacts, const Eigen::Vector3d& vehicle) {
  Points points{reel};
  points.insert(points.end(), contacts.begin(), contacts.end());
  points.push_back(vehicle);
  return points;
}

/// The tether after the last of several events at one place, and at the end of the path.
std::vector<Points> drawnTethers(const Eigen::Vector3d& reel, const ContactPlan& plan) {
  std::vector<Points> tethers;
  Points stack;
  for (const TetherState& state : plan.states) {
    for (std::size_t i = 0; i < state.events.size(); ++i) {
      const ContactEvent& event = state.events[i];
      if (event.kind == ContactChange::kPush) {
        stack.push_back(event.position);
      } else {
        stack.pop_back();
      }
      const bool last =
          i + 1 == state.events.size() || state.events[i + 1].vehicle != event.vehicle;
      if (last) tethers.push_back(tether(reel, stack, event.vehicle));
    }
  }
  if (!plan.states.empty()) tethers.push_back(tether(reel, stack, plan.states.back().position));
  return tethers;
}

void addMarkers(Drawing& drawing, const Eigen::Vector3d& reel, const ContactPlan& plan) {
  drawing.markers.push_back({.at = reel, .symbol = Symbol::kSquare, .size = 1.3, .name = "reel"});
  const char* name = "contact";
  for (const TetherState& state : plan.states) {
    for (const ContactEvent& event : state.events) {
      if (event.kind != ContactChange::kPush) continue;
      drawing.markers.push_back({.at = event.position,
                                 .symbol = Symbol::kDiamond,
                                 .colour = Colour::kVermilion,
                                 .size = 1.2,
                                 .name = std::exchange(name, "")});
    }
  }
  if (plan.states.empty()) return;
  drawing.markers.push_back({.at = plan.states.front().position,
                             .symbol = Symbol::kCircle,
                             .colour = Colour::kGreen,
                             .size = 1.6,
                             .name = "start"});
  drawing.markers.push_back({.at = plan.states.back().position,
                             .symbol = Symbol::kCross,
                             .colour = Colour::kPurple,
                             .size = 1.6,
                             .name = "end"});
}

}  // namespace

plot::Figure contactFigure(const std::string& title, const VoxelMap& map,
                           const Eigen::Vector3d& reel, const ContactPlan& plan) {
  const std::vector<Points> tethers = drawnTethers(reel, plan);
  Points seen;
  Points path;
  for (const TetherState& state : plan.states) path.push_back(state.position);
  for (const Points& points : tethers) seen.insert(seen.end(), points.begin(), points.end());
  seen.insert(seen.end(), path.begin(), path.end());
  Drawing drawing = mapDrawing(title, map, seen);
  for (std::size_t i = 0; i < tethers.size(); ++i) {
    const bool end = i + 1 == tethers.size();
    drawing.curves.push_back({.name = end      ? "tether at the end"
                                      : i == 0 ? "tether where contacts change"
                                               : "",
                              .points = tethers[i],
                              .style = Style::kLine,
                              .colour = end ? Colour::kBlack : Colour::kGrey,
                              .width = 1.0});
  }
  const bool crowded = path.size() > kPointsDrawn;
  drawing.curves.push_back({.name = "path",
                            .points = std::move(path),
                            .style = crowded ? Style::kLine : Style::kLinePoints,
                            .colour = Colour::kBlue,
                            .width = 2.0});
  addMarkers(drawing, reel, plan);
  return mapFigure(map, drawing);
}

}  // namespace tautline::planning
