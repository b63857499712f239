#include "common/plot/views.h"

#include <algorithm>
#include <limits>

namespace tautline::plot {
namespace {

struct Bounds {
  Eigen::Vector3d min{Eigen::Vector3d::Constant(std::numeric_limits<double>::max())};
  Eigen::Vector3d max{-min};

  void include(const Eigen::Vector3d& p) {
    if (!p.allFinite()) return;
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
};

Polygon rectangle(View view, const Eigen::Vector3d& min, const Eigen::Vector3d& max) {
  const Point a = project(view, min);
  const Point b = project(view, max);
  return {.outline = {a, {b.x, a.y}, b, {a.x, b.y}}};
}

Polygon outline(View view, const Prism& prism) {
  Polygon out;
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
    if (curve.background) continue;
    for (const auto& p : curve.points) out.include(p);
  }
  for (const auto& marker : drawing.markers) out.include(marker.at);
  if (out.min.x() > out.max.x()) out.min = out.max = Eigen::Vector3d::Zero();
  return out;
}

// Of the plot itself, without its labels [px].
struct PlotSize {
  double width{};
  double height{};
};

// [m/px] at which all of `bounds` is seen, with a margin.
double scaleFor(View view, const Bounds& bounds, const PlotSize& size) {
  constexpr double kMargin = 1.25;
  constexpr double kSmallest =
      0.5;  // [m] A drone that stays where it is does not need a microscope.
  const Point a = project(view, bounds.min);
  const Point b = project(view, bounds.max);
  return kMargin * std::max(std::max(b.x - a.x, kSmallest) / size.width,
                            std::max(b.y - a.y, kSmallest) / size.height);
}

void setLimits(Panel& panel, View view, const Bounds& bounds, const PlotSize& size, double scale) {
  const Point middle = project(view, 0.5 * (bounds.min + bounds.max));
  panel.x.limits = {middle.x - 0.5 * scale * size.width, middle.x + 0.5 * scale * size.width};
  panel.y.limits = {middle.y - 0.5 * scale * size.height, middle.y + 0.5 * scale * size.height};
}

Axis axis(const char* label, bool reversed = false) {
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
                            .style = Style::kLine,
                            .colour = Colour::kLightGrey,
                            .width = 1.2,
                            .background = true});
}

Point project(View view, const Eigen::Vector3d& p) {
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

Panel viewPanel(const Drawing& drawing, View view) {
  Panel panel;
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
  panel.value_label = drawing.value_label;
  panel.value_limits = drawing.value_limits;
  if (const auto& image = drawing.images[static_cast<std::size_t>(view)])
    panel.rasters.push_back(*image);
  for (const auto& box : drawing.boxes) panel.polygons.push_back(rectangle(view, box.min, box.max));
  for (const auto& prism : drawing.prisms) panel.polygons.push_back(outline(view, prism));
  if (!panel.polygons.empty()) panel.polygons.front().name = "obstacle";
  for (const auto& curve : drawing.curves) {
    Series series{.name = curve.name,
                  .style = curve.style,
                  .colour = curve.colour,
                  .width = curve.width,
                  .symbol = curve.symbol,
                  .values = curve.values};
    series.points.reserve(curve.points.size());
    for (const auto& p : curve.points) series.points.push_back(project(view, p));
    panel.series.push_back(std::move(series));
  }
  for (const auto& m : drawing.markers) {
    panel.markers.push_back({project(view, m.at), m.label, m.symbol, m.colour, m.size, m.name});
  }
  return panel;
}

Figure viewFigure(const Drawing& drawing, View view) {
  Figure figure{
      .title = {}, .width_px = 800, .height_px = 700, .panels = {viewPanel(drawing, view)}};
  Panel& panel = figure.panels.front();
  if (!drawing.title.empty()) panel.title += " – " + drawing.title;
  const Bounds bounds = boundsOf(drawing);
  const PlotSize size{.width = 660.0, .height = 550.0};
  setLimits(panel, view, bounds, size, scaleFor(view, bounds, size));
  return figure;
}

Figure viewsFigure(const Drawing& drawing) {
  Figure figure{.title = drawing.title,
                .rows = 2,
                .columns = 2,
                .width_px = 1000,
                .height_px = 900,
                .panels = {}};
  // One scale for all three, so that a thing is as large in each, and above or beside itself.
  const Bounds bounds = boundsOf(drawing);
  const PlotSize size{.width = 400.0, .height = 330.0};
  double scale = 0.0;
  for (const auto& view : kViewNames) scale = std::max(scale, scaleFor(view.value, bounds, size));
  const auto panel = [&](View view) {
    Panel out = viewPanel(drawing, view);
    out.legend = false;
    setLimits(out, view, bounds, size, scale);
    return out;
  };
  Panel legend = viewPanel(drawing, View::kTop);
  legend.title = {};
  legend.legend_only = true;
  figure.panels = {panel(View::kTop), legend, panel(View::kFront), panel(View::kSide)};
  return figure;
}

}  // namespace tautline::plot
