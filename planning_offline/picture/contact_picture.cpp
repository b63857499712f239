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

void addEnds(Drawing& drawing, const Eigen::Vector3d& reel, const Points& path) {
  drawing.markers.push_back({.at = reel, .symbol = Symbol::kSquare, .size = 1.3, .name = "reel"});
  if (path.empty()) return;
  drawing.markers.push_back({.at = path.front(),
                             .symbol = Symbol::kCircle,
                             .colour = Colour::kGreen,
                             .size = 1.6,
                             .name = "start"});
  drawing.markers.push_back({.at = path.back(),
                             .symbol = Symbol::kCross,
                             .colour = Colour::kPurple,
                             .size = 1.6,
                             .name = "end"});
}

void addContacts(Drawing& drawing, const ContactPlan& plan) {
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
}

/// The last waypoint with the most contacts of both.
const ContactRow& mostBent(const ContactComparison& comparison) {
  const auto contacts = [](const ContactRow& row) {
    return row.published.contacts.size() + row.exact.contacts.size();
  };
  const ContactRow* most = &comparison.rows.front();
  for (const ContactRow& row : comparison.rows) {
    if (contacts(row) >= contacts(*most)) most = &row;
  }
  return *most;
}

void addTether(Drawing& drawing, const std::string& name, const Eigen::Vector3d& reel,
               const TetherState& state, Style style, Colour colour, Symbol symbol) {
  drawing.curves.push_back({.name = name,
                            .points = tether(reel, state.contacts, state.position),
                            .style = style,
                            .colour = colour});
  for (const Eigen::Vector3d& contact : state.contacts) {
    drawing.markers.push_back(
        {.at = contact,
         .symbol = symbol,
         .colour = colour,
         .size = 1.2,
         .name = contact == state.contacts.front() ? "contact, " + name : ""});
  }
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
                            .points = path,
                            .style = crowded ? Style::kLine : Style::kLinePoints,
                            .colour = Colour::kBlue,
                            .width = 2.0});
  addContacts(drawing, plan);
  addEnds(drawing, reel, path);
  return mapFigure(map, drawing);
}

plot::Figure comparisonFigure(const std::string& title, const VoxelMap& map,
                              const Eigen::Vector3d& reel, const ContactComparison& comparison) {
  Points path;
  Points refused;
  for (const ContactRow& row : comparison.rows) {
    path.push_back(row.exact.position);
    if (row.published.relaxation_refused) refused.push_back(row.exact.position);
  }
  Points seen = path;
  seen.push_back(reel);
  Drawing drawing = mapDrawing(title, map, seen);
  drawing.curves.push_back(
      {.name = "path", .points = path, .style = Style::kLine, .colour = Colour::kGrey});
  if (!comparison.rows.empty()) {
    const ContactRow& row = mostBent(comparison);
    addTether(drawing, "taut string", reel, row.exact, Style::kLine, Colour::kBlue,
              Symbol::kCircle);
    addTether(drawing, "as published", reel, row.published, Style::kDashed, Colour::kVermilion,
              Symbol::kDiamond);
  }
  if (!refused.empty()) {
    drawing.curves.push_back({.name = "relaxation refused",
                              .points = std::move(refused),
                              .style = Style::kPoints,
                              .colour = Colour::kOrange});
  }
  addEnds(drawing, reel, path);
  return mapFigure(map, drawing);
}

}  // namespace tautline::planning
