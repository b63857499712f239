#include "app/report/report_figures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace tautline::report {
namespace {

using plot::Colour;
using plot::Panel;
using plot::Point;
using plot::Series;
using plot::Style;
using plot::Symbol;

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kBreakAfter = 2.0;  // [s] Lines are not drawn across longer holes.
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// A time series of `value(sample)`, broken at holes.
template <class Sample, class Value>
std::vector<Point> overTime(const std::vector<Sample>& samples, Value value) {
  std::vector<Point> points;
  points.reserve(samples.size());
  for (const auto& s : samples) {
    if (!points.empty() && s.t - points.back().x > kBreakAfter) points.push_back({kNaN, kNaN});
    points.push_back({s.t, value(s)});
  }
  return points;
}

std::vector<Point> overTime(const std::vector<TimedValue>& samples) {
  return overTime(samples, [](const TimedValue& s) { return s.value; });
}

void addSeries(Panel& panel, const std::string& name, std::vector<Point> points, Colour colour,
               Style style = Style::kLine, double width = 1.6) {
  if (!points.empty())
    panel.series.push_back({.name = name,
                            .points = std::move(points),
                            .style = style,
                            .colour = colour,
                            .width = width});
}

// Angles jump where they wrap; a line across the plot would be wrong.
std::vector<Point> brokenAtWraps(std::vector<Point> points) {
  std::vector<Point> out;
  for (const Point& p : points) {
    if (!out.empty() && std::abs(p.y - out.back().y) > 180.0) out.push_back({kNaN, kNaN});
    out.push_back(p);
  }
  return out;
}

void addMarks(Panel& panel, const FlightAnalysis& flight, bool labels) {
  for (const auto& change : flight.tether.contact_changes) {
    std::string label;
    if (labels) {
      label = change.formed    ? "contact " + std::to_string(change.id)
              : change.id == 0 ? "to reel"
                               : "back to " + std::to_string(change.id);
    }
    panel.marks.push_back({change.t, label, Colour::kVermilion});
  }
}

Panel timePanel(const FlightLog& log, const std::string& y_label, bool last) {
  Panel panel;
  panel.x = {.label = last ? "time [s]" : "",
             .limits = plot::Limits{0.0, std::max(log.duration, 1e-3)}};
  panel.y.label = y_label;
  return panel;
}

plot::Figure stacked(const std::string& title, std::vector<Panel> panels, int panel_height) {
  const int rows = static_cast<int>(panels.size());
  return {.title = title,
          .rows = rows,
          .columns = 1,
          .width_px = 900,
          .height_px = rows * panel_height + 40,
          .panels = std::move(panels)};
}

const char* positionName(const FlightAnalysis& flight) {
  return flight.has_truth ? "flown (truth)" : "flown (estimate)";
}

plot::Figure timeSeries(const FlightLog& log, const FlightAnalysis& flight) {
  std::vector<Panel> panels;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr std::array<const char*, 3> kLabels{"x [m]", "height y [m]", "z [m]"};
    Panel panel = timePanel(log, kLabels[static_cast<std::size_t>(axis)], false);
    std::vector<MissionSample> aimed;
    for (const auto& m : log.mission) {
      if (m.state == MissionState::kRunning || m.state == MissionState::kHolding)
        aimed.push_back(m);
    }
    addSeries(panel, "target", overTime(aimed, [axis](const auto& m) { return m.target[axis]; }),
              Colour::kGrey, Style::kSteps, 1.2);
    if (flight.has_truth) {
      addSeries(panel, "truth", overTime(log.truth, [axis](const auto& s) { return s.p_WD[axis]; }),
                Colour::kBlue, Style::kLine, 2.2);
    }
    addSeries(panel, "estimate",
              overTime(flight.estimate, [axis](const auto& s) { return s.p[axis]; }),
              Colour::kOrange, Style::kLine, 1.2);
    panel.legend = axis == 0;
    panels.push_back(panel);
  }

  Panel length = timePanel(log, "tether out [m]", false);
  Panel angles = timePanel(log, "angle [deg]", false);
  Panel tension = timePanel(log, "tension [N]", true);
  addSeries(length, "true length", overTime(log.truth, [](const auto& s) { return s.L_total; }),
            Colour::kBlue, Style::kLine, 2.2);
  addSeries(length, "estimated (static + free)",
            overTime(log.tether, [](const auto& s) { return s.L_static + s.L_free; }),
            Colour::kOrange, Style::kLine, 1.2);
  addSeries(length, "reel, nominal", overTime(log.tether, [](const auto& s) { return s.L_meas; }),
            Colour::kGrey, Style::kDashed, 1.2);
  addSeries(angles, "elevation",
            overTime(log.tether, [](const auto& s) { return s.theta * kDegrees; }), Colour::kGreen);
  addSeries(angles, "azimuth",
            brokenAtWraps(overTime(log.tether, [](const auto& s) { return s.phi * kDegrees; })),
            Colour::kPurple);
  addSeries(tension, "truth", overTime(log.truth, [](const auto& s) { return s.T; }), Colour::kBlue,
            Style::kLine, 1.4);
  addSeries(tension, "estimate", overTime(log.tether, [](const auto& s) { return s.T; }),
            Colour::kOrange, Style::kLine, 1.2);
  for (Panel* panel : {&length, &angles, &tension}) panels.push_back(*panel);
  for (std::size_t i = 0; i < panels.size(); ++i) addMarks(panels[i], flight, i == 0);
  return stacked("Position, tether and tension over time", std::move(panels), 190);
}

plot::Figure errors(const FlightLog& log, const FlightAnalysis& flight) {
  std::vector<Panel> panels;
  const auto meanLine = [&log](const std::optional<Summary>& summary) -> std::vector<Point> {
    if (!summary) return {};
    return {{0.0, summary->mean}, {log.duration, summary->mean}};
  };
  if (!flight.cross_track.series.empty()) {
    Panel panel = timePanel(log, "cross-track [m]", flight.localization.series.empty());
    panel.y.include_zero = true;
    addSeries(panel, "cross-track error", overTime(flight.cross_track.series), Colour::kBlue);
    addSeries(panel, "mean", meanLine(flight.cross_track.all), Colour::kGrey, Style::kDashed, 1.2);
    panels.push_back(panel);
  }
  if (!flight.localization.series.empty()) {
    Panel panel = timePanel(log, "localization [m]", true);
    panel.y.include_zero = true;
    addSeries(panel, "localization error", overTime(flight.localization.series), Colour::kOrange);
    addSeries(panel, "mean", meanLine(flight.localization.all), Colour::kGrey, Style::kDashed, 1.2);
    panels.push_back(panel);
  }
  for (auto& panel : panels) addMarks(panel, flight, true);
  return stacked("Errors over time", std::move(panels), 270);
}

plot::Figure loopTiming(const FlightLog& log) {
  Panel lateness = timePanel(log, "lateness [µs]", false);
  Panel work = timePanel(log, "work [µs]", true);
  const auto micro = [&log](double LoopSample::*member) {
    return overTime(log.loop, [member](const auto& s) { return s.*member * 1e6; });
  };
  addSeries(lateness, "largest in a second", micro(&LoopSample::lateness_max), Colour::kVermilion,
            Style::kLine, 1.2);
  addSeries(lateness, "mean", micro(&LoopSample::lateness_mean), Colour::kBlue);
  addSeries(work, "largest in a second", micro(&LoopSample::work_max), Colour::kVermilion,
            Style::kLine, 1.2);
  addSeries(work, "mean", micro(&LoopSample::work_mean), Colour::kBlue);
  addSeries(work, "period", overTime(log.loop, [](const auto& s) { return s.period * 1e6; }),
            Colour::kGrey, Style::kDashed, 1.2);
  lateness.y.logarithmic = true;
  work.y.logarithmic = true;
  return stacked("Loop timing", {lateness, work}, 250);
}

std::vector<Eigen::Vector3d> pathOf(const std::vector<PositionSample>& samples) {
  std::vector<Eigen::Vector3d> path;
  double last = 0.0;
  for (const auto& s : samples) {
    if (!path.empty() && s.t - last > kBreakAfter) path.push_back(Eigen::Vector3d::Constant(kNaN));
    path.push_back(s.p);
    last = s.t;
  }
  return path;
}

std::vector<PositionSample> during(const std::vector<PositionSample>& samples,
                                   const std::optional<TimeSpan>& span) {
  std::vector<PositionSample> out;
  for (const auto& s : samples) {
    if (!span || (s.t >= span->begin && s.t <= span->end)) out.push_back(s);
  }
  return out;
}

// From the mission's chunks where the log has them, else from the segments as they were flown.
std::vector<Eigen::Vector3d> plannedPath(const FlightAnalysis& flight) {
  std::vector<Eigen::Vector3d> path;
  if (!flight.cross_track.segments.empty())
    path.push_back(flight.cross_track.segments.front().start);
  if (flight.plan && flight.plan->complete()) {
    for (const auto& w : flight.plan->waypoints) path.push_back(w->p_WD);
  } else {
    for (const auto& segment : flight.cross_track.segments) path.push_back(segment.target);
  }
  return path;
}

}  // namespace

plot::Drawing flightDrawing(const FlightAnalysis& flight) {
  plot::Drawing drawing;
  const auto planned = plannedPath(flight);
  if (!planned.empty()) {
    drawing.curves.push_back({.name = "planned",
                              .points = planned,
                              .style = Style::kDashed,
                              .colour = Colour::kBlack,
                              .width = 1.4});
    const std::vector<Eigen::Vector3d> waypoints(planned.begin() + (planned.size() > 1 ? 1 : 0),
                                                 planned.end());
    drawing.curves.push_back({.name = "waypoint",
                              .points = waypoints,
                              .style = Style::kPoints,
                              .colour = Colour::kBlack,
                              .width = 1.2});
  }
  const auto flown = during(flight.position, flight.airborne);
  if (!flown.empty()) {
    drawing.curves.push_back({.name = positionName(flight),
                              .points = pathOf(flown),
                              .colour = Colour::kBlue,
                              .width = 2.4});
  }
  if (flight.has_truth && !flight.estimate.empty()) {
    drawing.curves.push_back({.name = "estimate",
                              .points = pathOf(during(flight.estimate, flight.airborne)),
                              .colour = Colour::kOrange,
                              .width = 1.2});
  }
  drawing.markers.push_back(
      {.at = Eigen::Vector3d::Zero(), .label = "reel", .symbol = Symbol::kSquare, .size = 1.3});
  if (flight.plan) {
    for (const auto& contact : flight.plan->contacts) {
      if (!contact) continue;
      drawing.markers.push_back({.at = contact->p_WC,
                                 .label = "contact " + std::to_string(contact->id),
                                 .symbol = Symbol::kDiamond,
                                 .colour = Colour::kVermilion,
                                 .size = 1.2});
    }
  }
  if (!flight.plan || flight.plan->contacts.empty()) {
    for (const auto& change : flight.tether.contact_changes) {
      if (!change.formed) continue;
      drawing.markers.push_back({.at = change.p_WA,
                                 .label = "contact " + std::to_string(change.id),
                                 .symbol = Symbol::kDiamond,
                                 .colour = Colour::kVermilion,
                                 .size = 1.2});
    }
  }
  if (!flown.empty()) {
    drawing.markers.push_back({.at = flown.front().p,
                               .label = {},
                               .symbol = Symbol::kTriangle,
                               .colour = Colour::kGreen,
                               .size = 1.5,
                               .name = "take-off"});
    drawing.markers.push_back({.at = flown.back().p,
                               .label = {},
                               .symbol = Symbol::kCross,
                               .colour = Colour::kPurple,
                               .size = 1.3,
                               .name = flight.outcome.landed ? "landing" : "end"});
  }
  return drawing;
}

std::vector<NamedFigure> reportFigures(const FlightLog& log, const FlightAnalysis& flight,
                                       const Scene* scene) {
  std::vector<NamedFigure> out;
  if (!flight.position.empty() || !flight.cross_track.segments.empty()) {
    plot::Drawing drawing;
    if (scene != nullptr) addScene(drawing, *scene);
    const plot::Drawing paths = flightDrawing(flight);
    drawing.curves.insert(drawing.curves.end(), paths.curves.begin(), paths.curves.end());
    drawing.markers = paths.markers;
    out.push_back({"views", "Planned and flown path from above, from the front and from the side.",
                   true, viewsFigure(drawing)});
    for (const auto& view : plot::kViewNames) {
      out.push_back({view.name, std::string("Planned and flown path, ") + view.name + " view.",
                     false, viewFigure(drawing, view.value)});
    }
  }
  out.push_back({"time_series",
                 "Position, tether length, tether angles and tension over time; red lines: contact "
                 "formed or relaxed.",
                 true, timeSeries(log, flight)});
  if (!flight.cross_track.series.empty() || !flight.localization.series.empty()) {
    out.push_back({"errors",
                   "Distance from the planned segment, and of the estimate from the truth.", true,
                   errors(log, flight)});
  }
  // In lock-step the clock stands still during a cycle: there is nothing to see.
  const auto took_time = [](const LoopSample& s) {
    return s.lateness_max > 0.0 || s.work_max > 0.0;
  };
  if (std::any_of(log.loop.begin(), log.loop.end(), took_time)) {
    out.push_back({"loop", "How late the loop woke up and how long it worked, each second.", true,
                   loopTiming(log)});
  }
  return out;
}

}  // namespace tautline::report
