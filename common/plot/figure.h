#pragma once

/// @file
/// Figures as data, drawn as SVG by the gnuplot program (Debian package gnuplot-nox). A Figure says
/// what is to be seen; gnuplot runs as a child process without a shell, all text is quoted, and the
/// same figure always gives the same bytes.
///
/// Non-finite points break a line, and are left out everywhere else. Not real-time safe: start-up
/// only.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/plot/raster.h"

namespace tautline::plot {

/// The palette of Okabe and Ito, told apart by people with every kind of colour vision.
enum class Colour { kBlack, kBlue, kOrange, kGreen, kVermilion, kSky, kPurple, kGrey, kLightGrey };

enum class Style { kLine, kDashed, kDotted, kSteps, kPoints, kLinePoints };

enum class Symbol { kNone, kCross, kPlus, kSquare, kCircle, kDot, kTriangle, kDiamond };

struct Point {
  double x{0.0};
  double y{0.0};
};

/// One line or cloud of points.
struct Series {
  std::string name{};  ///< In the legend; empty = not listed.
  std::vector<Point> points{};
  Style style{Style::kLine};
  Colour colour{Colour::kBlue};
  double width{1.6};            ///< Line width, or size of a point.
  Symbol symbol{Symbol::kDot};  ///< Of the point styles.
  std::vector<double>
      values{};  ///< One a point: colours the line by value (Panel::value_label); empty = `colour`.
};

/// Filled outline, e.g. an obstacle. Closed by itself; at least three points.
struct Polygon {
  std::vector<Point> outline{};
  Colour colour{Colour::kGrey};
  double opacity{0.35};  ///< In [0, 1].
  std::string name{};    ///< In the legend; empty = not listed.
};

/// One labelled spot.
struct Marker {
  Point at{};
  std::string label{};
  Symbol symbol{Symbol::kCircle};
  Colour colour{Colour::kBlack};
  double size{1.0};
  std::string name{};  ///< In the legend; empty = not listed.
};

/// Full-height line at one x, e.g. an event on a time axis.
struct VerticalMark {
  double x{0.0};
  std::string label{};
  Colour colour{Colour::kGrey};
};

struct Limits {
  double min{0.0};
  double max{1.0};
};

struct Axis {
  std::string label{};             ///< With its unit: "height y [m]".
  std::optional<Limits> limits{};  ///< Absent: from the data, with a margin.
  bool reversed{false};            ///< Grows to the left, or downwards.
  bool include_zero{false};        ///< Automatic limits reach to zero.
  bool logarithmic{false};         ///< Points that are not positive are left out.
};

/// One coordinate system. Drawn in this order: rasters, polygons, series, markers.
struct Panel {
  std::string title{};
  Axis x{};
  Axis y{};
  bool equal_aspect{
      false};  ///< One metre is as long on both axes; the limits grow to fill the panel.
  bool legend{true};
  bool legend_only{
      false};  ///< Shows nothing but the legend, large: one for all panels of a figure.
  std::string value_label{};             ///< Of the colour bar of series with values.
  std::optional<Limits> value_limits{};  ///< Of that colour bar; absent: from the values.
  std::vector<Raster> rasters{};
  std::vector<Polygon> polygons{};
  std::vector<Series> series{};
  std::vector<Marker> markers{};
  std::vector<VerticalMark> marks{};
};

/// Panels in reading order, row by row. A panel without any content leaves its place empty.
struct Figure {
  std::string title{};
  int rows{1};
  int columns{1};
  int width_px{800};
  int height_px{600};
  std::vector<Panel> panels{};
};

/// The figure as a program for gnuplot that prints SVG to its standard output.
[[nodiscard]] std::string gnuplotScript(const Figure& figure);

/// Draws the figure. Throws InputError when gnuplot is missing or fails, or when the file cannot be
/// written; `file` is then as it was before: the picture is written beside it and renamed into
/// place.
void writeSvg(const Figure& figure, const std::filesystem::path& file);

}  // namespace tautline::plot
