#include "app/report/views.h"

#include <algorithm>
#include <limits>

namespace tautline::report {
namespace {

using plot::Colour;

struct Bounds {
  Eigen::Vector3d min{Eigen::Vector3d::Constant(std::numeric_limits<double>::max())};
  Eigen::Vector3d max{-min};

  void include(const Eigen::Vector3d& p) {
    if (!p.allFinite()) return;
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
};

plot::Polygon rectangle(View view, const Eigen::Vector3d& min, const Eigen::Vector3d& max) {
  const plot::Point a = project(view, min);
  const plot::Point b = project(view, max);
  return {.outline = {a, {b.x, a.y}, b, {a.x, b.y}}};
}

plot::Polygon outline(View view, const Prism& prism) {
  plot::Polygon out;
  Bounds bounds;
  for (const auto& zx : prism.footprint) {
    const Eigen::Vector3d corner(zx.y(), prism.y_min, zx.x());
    out.outline.push_back(project(view, corner));
    bounds.include(corner);
  }
  if (view == View::kTop) return out;
  bounds.max.y() = prism.y_max;
  return rectangle(view, bounds.min, bounds.max);
}

Bounds boundsOf(const Drawing& drawing) {
  Bounds out;
  for (const auto& curve : drawing.curves) {
    for (const auto& p : curve.points) out.include(p);
  }
  for (const auto& marker : drawing.markers) out.include(marker.at);
  for (const auto& box : drawing.boxes) {
    out.include(box.min);
    out.include(box.max);
  }
  for (const auto& prism : drawing.prisms) {
    for (const auto& zx : prism.footprint) {
      out.include({zx.y(), prism.y_min, zx.x()});
      out.include({zx.y(), prism.y_max, zx.x()});
    }
  }
  if (out.min.x() > out.max.x()) out.min = out.max = Eigen::Vector3d::Zero();
  return out;
}

plot::Axis axis(const char* label, bool reversed = false) {
  return {.label = label, .reversed = reversed};
}

}  // namespace

void addScene(Drawing& drawing, const Scene& scene) {
  drawing.boxes.insert(drawing.boxes.end(), scene.boxes.begin(), scene.boxes.end());
  drawing.prisms.insert(drawing.prisms.end(), scene.prisms.begin(), scene.prisms.end());
  const Eigen::Vector3d& a = scene.min;
  const Eigen::Vector3d& b = scene.max;
  const double y = scene.floor;
  // A walk along edges of the room that is its outline in every view.
  drawing.curves.push_back({.name = "room",
                            .points = {{a.x(), y, a.z()},
                                       {b.x(), y, a.z()},
                                       {b.x(), y, b.z()},
                                       {a.x(), y, b.z()},
                                       {a.x(), y, a.z()},
                                       {a.x(), b.y(), a.z()},
                                       {b.x(), b.y(), a.z()},
                                       {b.x(), y, a.z()},
                                       {b.x(), y, b.z()},
                                       {b.x(), b.y(), b.z()},
                                       {b.x(), b.y(), a.z()}},
                            .style = plot::Style::kLine,
                            .colour = Colour::kLightGrey,
                            .width = 1.2});
}

plot::Point project(View view, const Eigen::Vector3d& p) {
  switch (view) {
    case View::kTop:
      return {p.x(), p.z()};
    case View::kFront:
      return {p.x(), p.y()};
    case View::kSide:
      return {p.z(), p.y()};
  }
  return {};
}

plot::Panel viewPanel(const Drawing& drawing, View view) {
  plot::Panel panel;
  panel.equal_aspect = true;
  switch (view) {
    case View::kTop:
      panel.title = "Top view";
      panel.x = axis("x [m]");
      panel.y = axis("z [m]", true);
      break;
    case View::kFront:
      panel.title = "Front view";
      panel.x = axis("x [m]");
      panel.y = axis("height y [m]");
      break;
    case View::kSide:
      panel.title = "Side view";
      panel.x = axis("z [m]");
      panel.y = axis("height y [m]");
      break;
  }
  for (const auto& box : drawing.boxes) panel.polygons.push_back(rectangle(view, box.min, box.max));
  for (const auto& prism : drawing.prisms) panel.polygons.push_back(outline(view, prism));
  if (!panel.polygons.empty()) panel.polygons.front().name = "obstacle";
  for (const auto& curve : drawing.curves) {
    plot::Series series{.name = curve.name,
                        .style = curve.style,
                        .colour = curve.colour,
                        .width = curve.width,
                        .symbol = curve.symbol};
    series.points.reserve(curve.points.size());
    for (const auto& p : curve.points) series.points.push_back(project(view, p));
    panel.series.push_back(std::move(series));
  }
  for (const auto& m : drawing.markers) {
    panel.markers.push_back({project(view, m.at), m.label, m.symbol, m.colour, m.size, m.name});
  }
  return panel;
}

plot::Figure viewFigure(const Drawing& drawing, View view) {
  plot::Figure figure{
      .title = {}, .width_px = 800, .height_px = 700, .panels = {viewPanel(drawing, view)}};
  if (!drawing.title.empty()) figure.panels.front().title += " – " + drawing.title;
  return figure;
}

plot::Figure viewsFigure(const Drawing& drawing) {
  plot::Figure figure{.title = drawing.title,
                      .rows = 2,
                      .columns = 2,
                      .width_px = 1000,
                      .height_px = 900,
                      .panels = {}};
  const auto panel = [&drawing](View view) {
    plot::Panel out = viewPanel(drawing, view);
    out.legend = false;
    return out;
  };
  plot::Panel top = panel(View::kTop);
  plot::Panel front = panel(View::kFront);
  plot::Panel side = panel(View::kSide);

  // One scale for all three, so that a thing is as large in each, and above or beside itself.
  constexpr double kPlotWidth = 400.0;  // [px] Of one panel, without its labels.
  constexpr double kPlotHeight = 330.0;
  const Bounds bounds = boundsOf(drawing);
  const Eigen::Vector3d middle = 0.5 * (bounds.min + bounds.max);
  const Eigen::Vector3d extent = bounds.max - bounds.min;
  constexpr double kMargin = 1.12;
  const double scale = kMargin * std::max({extent.x() / kPlotWidth, extent.z() / kPlotHeight,
                                           extent.y() / kPlotHeight, 1e-3});
  const auto around = [scale](double at, double pixels) {
    return plot::Limits{at - 0.5 * scale * pixels, at + 0.5 * scale * pixels};
  };
  top.x.limits = front.x.limits = around(middle.x(), kPlotWidth);
  top.y.limits = around(middle.z(), kPlotHeight);
  side.x.limits = around(middle.z(), kPlotWidth);
  front.y.limits = side.y.limits = around(middle.y(), kPlotHeight);

  plot::Panel legend = viewPanel(drawing, View::kTop);
  legend.title = {};
  legend.legend_only = true;
  figure.panels = {top, legend, front, side};
  return figure;
}

}  // namespace tautline::report
