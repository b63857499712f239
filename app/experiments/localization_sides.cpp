#include "app/experiments/localization_sides.h"

#include <cmath>
#include <numbers>

#include "common/catenary.h"
#include "common/tether_geometry.h"

namespace tautline::experiments {
namespace {

constexpr std::array kReaches{0.5, 1.0, 1.5, 2.0, 2.5, 3.0};  // [m]
constexpr std::array kHeights{0.5, 1.0, 1.5, 2.0};            // [m]
constexpr double kAzimuth = -45.0 * std::numbers::pi / 180.0;

plot::Series crosses(const char* name, const std::vector<plot::Point>& points, plot::Colour colour,
                     plot::Symbol symbol) {
  return {.name = name,
          .points = points,
          .style = plot::Style::kPoints,
          .colour = colour,
          .width = 1.2,
          .symbol = symbol};
}

/// The plane of the flights, seen from the side: outwards and up.
plot::Panel planePanel(const char* title, const HoverSeries& series, plot::Colour colour) {
  plot::Panel panel{.title = title,
                    .x = {.label = "out [m]", .limits = plot::Limits{0.0, 3.5}},
                    .y = {.label = "height y [m]", .limits = plot::Limits{-0.5, 2.5}},
                    .equal_aspect = true};
  const Eigen::Vector3d out(std::sin(kAzimuth), 0.0, std::cos(kAzimuth));
  std::vector<plot::Point> targets, means, links;
  for (std::size_t i = 0; i < series.means.size(); ++i) {
    targets.push_back({series.flown[i].reach, series.flown[i].height});
    const Eigen::Vector3d& p = series.means[i];
    means.push_back({p.dot(out), p.y()});
    links.insert(links.end(), {targets.back(), means.back(), {std::nan(""), std::nan("")}});
  }
  panel.series.push_back({.points = links, .colour = colour, .width = 1.0});
  panel.series.push_back(crosses("target", targets, plot::Colour::kBlue, plot::Symbol::kCircle));
  panel.series.push_back(crosses("mean of 5 s", means, colour, plot::Symbol::kDot));
  return panel;
}

struct Look {
  plot::Colour colour;
  plot::Symbol symbol;
};
constexpr std::array kLooks{Look{plot::Colour::kVermilion, plot::Symbol::kDot},
                            Look{plot::Colour::kGreen, plot::Symbol::kSquare},
                            Look{plot::Colour::kBlue, plot::Symbol::kDiamond},
                            Look{plot::Colour::kBlack, plot::Symbol::kCircle}};

}  // namespace

Eigen::Vector3d Hover::target() const {
  return {reach * std::sin(kAzimuth), height, reach * std::cos(kAzimuth)};
}

std::vector<Hover> hovers() {
  std::vector<Hover> all;
  for (const double reach : kReaches)
    for (const double height : kHeights) all.push_back({reach, height, all.size()});
  return all;
}

double sagError(double tension, double weight) {
  double sum = 0.0;
  for (const Hover& hover : hovers()) {
    const TetherCoordinates q = toTether(hover.target());
    const CatenarySolution s = solveCatenary({q.L, q.theta, tension, weight});
    const Eigen::Vector3d real = toCartesian({s.chord, s.chord_elevation, q.phi});
    sum += (real - hover.target()).norm();
  }
  return sum / static_cast<double>(hovers().size());
}

plot::Figure planeFigure(const AllHoverSeries& all) {
  plot::Figure figure{.rows = 1, .columns = 3, .width_px = 1500, .height_px = 480};
  for (const std::size_t s : {kStraight, kCorrected, kOurs})
    figure.panels.push_back(planePanel(kLocalizationSides[s].name, all[s], kLooks[s].colour));
  return figure;
}

plot::Figure lengthFigure(const AllHoverSeries& all) {
  plot::Panel panel{
      .title = "Error against tether length",
      .x = {.label = "tether length, straight to the target [m]"},
      .y = {.label = "distance of mean position to target [m]", .include_zero = true}};
  for (std::size_t s = 0; s < kLooks.size(); ++s) {
    std::vector<plot::Point> points;
    double x_mean = 0.0;
    for (std::size_t i = 0; i < all[s].errors.size(); ++i) {
      points.push_back({all[s].lengths[i], all[s].errors[i]});
      x_mean += all[s].lengths[i] / static_cast<double>(all[s].errors.size());
    }
    panel.series.push_back(
        crosses(kLocalizationSides[s].name, points, kLooks[s].colour, kLooks[s].symbol));
    const auto line = [&](double x) {
      return plot::Point{x, all[s].mean + all[s].slope * (x - x_mean)};
    };
    panel.series.push_back(
        {.points = {line(0.6), line(3.7)}, .colour = kLooks[s].colour, .width = 1.4});
  }
  return {.width_px = 900, .height_px = 560, .panels = {panel}};
}

/// Mean error of the straight line at each tension: flown, and by sag alone.
plot::Figure tensionFigure(const std::vector<plot::Point>& flown, double published, double weight) {
  std::vector<plot::Point> sag;
  for (double tension = 0.18; tension < 3.2; tension *= 1.05)
    sag.push_back({tension, sagError(tension, weight)});
  plot::Panel panel{.title = "Mean error of a straight tether",
                    .x = {.label = "tension at the vehicle [N]", .logarithmic = true},
                    .y = {.label = "mean error [m]", .include_zero = true}};
  panel.series.push_back({.name = "sag alone",
                          .points = sag,
                          .style = plot::Style::kDashed,
                          .colour = plot::Colour::kGrey});
  panel.series.push_back(
      crosses("flown, 24 points each", flown, plot::Colour::kVermilion, plot::Symbol::kDot));
  panel.series.push_back({.name = "published",
                          .points = {{0.18, published}, {3.2, published}},
                          .style = plot::Style::kDotted,
                          .colour = plot::Colour::kBlack});
  return {.width_px = 800, .height_px = 500, .panels = {panel}};
}

}  // namespace tautline::experiments
