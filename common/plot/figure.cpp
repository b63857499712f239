#include "common/plot/figure.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

#include "common/plot/thin.h"

namespace tautline::plot {
namespace {

bool isFinite(const Point& p) { return std::isfinite(p.x) && std::isfinite(p.y); }

// Shortest text with 7 significant digits, in every locale the same.
std::string number(double value) {
  std::array<char, 32> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 7)
          .ptr;
  return {text.data(), end};
}

// A gnuplot string that nothing expands: all that could end it, start an escape or run a shell
// command (backquotes) is written as an octal escape, which gnuplot resolves after it has looked
// for those. Control characters become spaces.
std::string inQuotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) {
      out += ' ';
    } else if (c == '"' || c == '\'' || c == '\\' || c == '`' || c == '@' || c == '$') {
      out += '\\';
      for (const unsigned shift : {6U, 3U, 0U})
        out += static_cast<char>('0' + ((byte >> shift) & 7U));
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string rgb(Colour colour) {
  switch (colour) {
    case Colour::kBlack:
      return "'#222222'";
    case Colour::kBlue:
      return "'#0072b2'";
    case Colour::kOrange:
      return "'#e69f00'";
    case Colour::kGreen:
      return "'#009e73'";
    case Colour::kVermilion:
      return "'#d55e00'";
    case Colour::kSky:
      return "'#56b4e9'";
    case Colour::kPurple:
      return "'#cc79a7'";
    case Colour::kGrey:
      return "'#808080'";
    case Colour::kLightGrey:
      return "'#c8c8c8'";
  }
  return "'#222222'";
}

const char* pointType(Symbol symbol) {
  switch (symbol) {
    case Symbol::kNone:
      return "0";
    case Symbol::kPlus:
      return "1";
    case Symbol::kCross:
      return "2";
    case Symbol::kSquare:
      return "4";
    case Symbol::kCircle:
      return "6";
    case Symbol::kDot:
      return "7";
    case Symbol::kTriangle:
      return "9";
    case Symbol::kDiamond:
      return "13";
  }
  return "0";
}

// "with …" of one series, without its title.
std::string lineStyle(const Series& series, bool in_legend = false) {
  const std::string by_value = in_legend ? " lc palette frac 0.6" : " lc palette";
  const std::string colour = series.values.empty() ? " lc rgb " + rgb(series.colour) : by_value;
  const std::string line = " lw " + number(series.width) + colour;
  const std::string point = " pt " + std::string(pointType(series.symbol));
  switch (series.style) {
    case Style::kLine:
      return "with lines" + line;
    case Style::kDashed:
      return "with lines dt (8,5)" + line;
    case Style::kDotted:
      return "with lines dt (2,4)" + line;
    case Style::kSteps:
      return "with steps" + line;
    case Style::kPoints:
      return "with points" + point + " ps " + number(0.4 * series.width) + colour;
    case Style::kLinePoints:
      return "with linespoints" + point + " ps 0.6" + line;
  }
  return "with lines" + line;
}

std::string pointStyle(const Marker& marker) {
  return std::string("pt ") + pointType(marker.symbol) + " ps " + number(marker.size) +
         " lw 2 lc rgb " + rgb(marker.colour);
}

struct Extent {
  double min{std::numeric_limits<double>::infinity()};
  double max{-std::numeric_limits<double>::infinity()};

  void include(double value) {
    min = std::min(min, value);
    max = std::max(max, value);
  }
  [[nodiscard]] bool empty() const { return min > max; }
};

bool isDrawn(const Point& p, const Panel& panel) {
  return isFinite(p) && (!panel.x.logarithmic || p.x > 0.0) && (!panel.y.logarithmic || p.y > 0.0);
}

void include(const Point& p, const Panel& panel, Extent& x, Extent& y) {
  if (!isDrawn(p, panel)) return;
  x.include(p.x);
  y.include(p.y);
}

Limits automaticLimits(const Axis& axis, Extent extent, double margin) {
  if (extent.empty()) return axis.logarithmic ? Limits{1.0, 10.0} : Limits{0.0, 1.0};
  if (axis.logarithmic) return {0.7 * extent.min, 1.4 * extent.max};
  if (axis.include_zero) extent.include(0.0);
  const double span = extent.max - extent.min;
  if (span <= 0.0) margin = 0.5;
  const double pad = margin * (span > 0.0 ? span : std::max(0.2, 0.1 * std::abs(extent.max)));
  const bool floor_at_zero = axis.include_zero && extent.min == 0.0 && span > 0.0;
  return {floor_at_zero ? 0.0 : extent.min - pad, extent.max + pad};
}

// Smallest of 1, 2 or 5 times a power of ten that is not below `step` (> 0).
double roundStep(double step) {
  const double power = std::pow(10.0, std::floor(std::log10(step)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= step) return factor * power;
  }
  return 10.0 * power;
}

struct PanelLimits {
  Limits x;
  Limits y;
};

PanelLimits limitsOf(const Figure& figure, const Panel& panel) {
  Extent x;
  Extent y;
  for (const auto& r : panel.rasters) {
    include({r.x_min, r.y_min}, panel, x, y);
    include({r.x_min + r.columns * r.pixel_width, r.y_min + r.rows * r.pixel_height}, panel, x, y);
  }
  for (const auto& polygon : panel.polygons) {
    for (const auto& p : polygon.outline) include(p, panel, x, y);
  }
  for (const auto& series : panel.series) {
    for (const auto& p : series.points) include(p, panel, x, y);
  }
  for (const auto& marker : panel.markers) include(marker.at, panel, x, y);

  PanelLimits limits{
      panel.x.limits.value_or(automaticLimits(panel.x, x, panel.equal_aspect ? 0.08 : 0.0)),
      panel.y.limits.value_or(automaticLimits(panel.y, y, panel.equal_aspect ? 0.08 : 0.06))};
  if (panel.equal_aspect) {
    constexpr double kRoomForLabelsX = 90.0;  // [px]
    constexpr double kRoomForLabelsY = 110.0;
    const double width =
        std::max(50.0, figure.width_px / static_cast<double>(figure.columns) - kRoomForLabelsX);
    const double height =
        std::max(50.0, figure.height_px / static_cast<double>(figure.rows) - kRoomForLabelsY);
    const double span_x = limits.x.max - limits.x.min;
    const double span_y = limits.y.max - limits.y.min;
    const double grow_x =
        panel.x.limits ? 0.0 : 0.5 * std::max(0.0, span_y * width / height - span_x);
    const double grow_y =
        panel.y.limits ? 0.0 : 0.5 * std::max(0.0, span_x * height / width - span_y);
    limits.x = {limits.x.min - grow_x, limits.x.max + grow_x};
    limits.y = {limits.y.min - grow_y, limits.y.max + grow_y};
  }
  return limits;
}

std::string rangeText(const Axis& axis, const Limits& limits) {
  const std::string low = number(limits.min);
  const std::string high = number(limits.max);
  return axis.reversed ? "[" + high + ":" + low + "]" : "[" + low + ":" + high + "]";
}

// Builds the text of one panel: data blocks first, then the settings, then the one plot command.
class PanelScript {
 public:
  PanelScript(const Figure& figure, const Panel& panel, std::size_t index)
      : figure_(figure),
        panel_(panel),
        prefix_("$panel" + std::to_string(index)),
        limits_(limitsOf(figure, panel)) {
    if (!panel.legend_only) {
      for (const auto& raster : panel.rasters) addRaster(raster);
    }
    for (const auto& polygon : panel.polygons) addPolygon(polygon);
    for (const auto& series : panel.series) addSeries(series);
    // gnuplot shows the colour bar only of something drawn by value: a line that is out of sight.
    if (panel.value_limits && !has_values_ && !panel.legend_only) {
      addCurve("-1e30 -1e30 0\n", "1:2:3", "with lines lc palette", {});
    }
    for (const auto& marker : panel.markers) addMarker(marker);
    for (const auto& mark : panel.marks) addMark(mark);
  }

  [[nodiscard]] std::string text() const {
    std::string out = blocks_ + settings() + decorations_ + "plot -1e30 notitle with lines";
    for (const auto& curve : curves_) out += ", \\\n  " + curve;
    return out + "\n";
  }

 private:
  std::string block(const std::string& rows) {
    std::string name = prefix_ + "_" + std::to_string(block_count_++);
    blocks_ += name + " << END_OF_DATA\n" + rows + "END_OF_DATA\n";
    return name;
  }

  void addCurve(const std::string& rows, const std::string& columns, const std::string& style,
                const std::string& name) {
    if (panel_.legend_only || rows.empty()) {
      if (!name.empty()) curves_.push_back("keyentry " + style + " title " + inQuotes(name));
      return;
    }
    const bool listed = panel_.legend && !name.empty();
    curves_.push_back(block(rows) + " using " + columns + " " + style +
                      (listed ? " title " + inQuotes(name) : " notitle"));
  }

  void addRaster(const Raster& raster) {
    std::string rows;
    std::size_t at = 0;
    for (int row = 0; row < raster.rows; ++row) {
      const std::string y = " " + number(raster.y_min + (row + 0.5) * raster.pixel_height);
      for (int column = 0; column < raster.columns; ++column) {
        rows += number(raster.x_min + (column + 0.5) * raster.pixel_width) + y;
        for (const std::uint8_t part : raster.pixels[at]) rows += " " + std::to_string(part);
        rows += "\n";
        ++at;
      }
    }
    // Few pixels are drawn as rectangles, for viewers smooth images; many as one embedded image.
    constexpr std::size_t kMostRectangles = 6000;
    addCurve(rows, "1:2:3:4:5", at <= kMostRectangles ? "with rgbimage pixels" : "with rgbimage",
             {});
  }

  void addPolygon(const Polygon& polygon) {
    std::string rows;
    for (const auto& p : polygon.outline) {
      if (isDrawn(p, panel_)) rows += number(p.x) + " " + number(p.y) + "\n";
    }
    const std::string style = "fillcolor rgb " + rgb(polygon.colour) +
                              " fillstyle transparent solid " + number(polygon.opacity);
    addCurve(
        rows, "1:2",
        (panel_.legend_only ? "with boxes " : "with filledcurves closed ") + style + " noborder",
        polygon.name);
  }

  void addSeries(const Series& series) {
    const double pixels_x = figure_.width_px / static_cast<double>(figure_.columns);
    const double pixels_y = figure_.height_px / static_cast<double>(figure_.rows);
    constexpr double kVisible = 0.8;  // [px]
    const double step_x = std::max(1e-12, kVisible * (limits_.x.max - limits_.x.min) / pixels_x);
    const double step_y = std::max(1e-12, kVisible * (limits_.y.max - limits_.y.min) / pixels_y);
    std::string rows;
    for (const std::size_t i : visiblePoints(series.points, step_x, step_y)) {
      const Point& p = series.points[i];
      if (!isDrawn(p, panel_)) {
        rows += "\n";
        continue;
      }
      rows += number(p.x) + " " + number(p.y);
      if (i < series.values.size()) rows += " " + number(series.values[i]);
      rows += "\n";
    }
    if (rows.find_first_not_of('\n') == std::string::npos) rows.clear();
    has_values_ = has_values_ || !series.values.empty();
    addCurve(rows, series.values.empty() ? "1:2" : "1:2:3",
             lineStyle(series, panel_.legend_only || rows.empty()), series.name);
  }

  void addMarker(const Marker& marker) {
    if (isDrawn(marker.at, panel_) && !panel_.legend_only) {
      decorations_ += "set label " + inQuotes(marker.label) + " at " + number(marker.at.x) + "," +
                      number(marker.at.y) + " left offset character 0.9,0.5 front textcolor rgb " +
                      rgb(marker.colour) + " point " + pointStyle(marker) + "\n";
    }
    if (!marker.name.empty() && panel_.legend) {
      curves_.push_back("keyentry with points " + pointStyle(marker) + " title " +
                        inQuotes(marker.name));
    }
  }

  void addMark(const VerticalMark& mark) {
    if (!(mark.x >= limits_.x.min && mark.x <= limits_.x.max)) return;
    const std::string x = "first " + number(mark.x);
    decorations_ += "set arrow from " + x + ", graph 0 to " + x +
                    ", graph 1 nohead back dt (4,4) lw 1 lc rgb " + rgb(mark.colour) + "\n";
    if (mark.label.empty()) return;
    decorations_ += "set label " + inQuotes(mark.label) + " at " + x +
                    ", graph 0.97 right rotate by 90 front offset character -0.6,0 " +
                    "font ',10' textcolor rgb " + rgb(mark.colour) + "\n";
  }

  [[nodiscard]] std::string settings() const {
    std::string out = "unset label\nunset arrow\nunset logscale\n";
    out += "set title " + inQuotes(panel_.title) + "\n";
    if (panel_.legend_only) {
      out +=
          "unset border\nunset xtics\nunset ytics\nunset xlabel\nunset ylabel\nunset colorbox\nset "
          "size "
          "noratio\n";
      out +=
          "set key at graph 0.5, graph 0.55 center center vertical Left reverse maxcols 1 samplen "
          "3 spacing "
          "1.5\n";
      return out + "set xrange [0:1]\nset yrange [0:1]\n";
    }
    out += "set border 3 lw 1 lc rgb '#606060'\n" + tics();
    out += "set grid back lt 1 lw 0.6 lc rgb '#e4e4e4'\n";
    out += "set xlabel " + inQuotes(panel_.x.label) + " offset 0,0.4\nset ylabel " +
           inQuotes(panel_.y.label) + "\n";
    out += panel_.equal_aspect ? "set size ratio -1\n" : "set size noratio\n";
    if (panel_.equal_aspect) {
      out += "unset lmargin\nunset rmargin\n";
    } else {
      out += std::string("set lmargin 10\nset rmargin ") + (has_values_ ? "12\n" : "3\n");
    }
    out += panel_.legend ? "set key outside bottom center horizontal Left reverse samplen 2 "
                           "spacing 1.1 width 1\n"
                         : "unset key\n";
    if (has_values_ || panel_.value_limits) {
      out += "set colorbox\nset cblabel " + inQuotes(panel_.value_label) + "\nset cbrange " +
             (panel_.value_limits ? "[" + number(panel_.value_limits->min) + ":" +
                                        number(panel_.value_limits->max) + "]"
                                  : "[*:*]") +
             "\n";
    } else {
      out += "unset colorbox\n";
    }
    if (panel_.x.logarithmic) out += "set logscale x\n";
    if (panel_.y.logarithmic) out += "set logscale y\n";
    out += "set xrange " + rangeText(panel_.x, limits_.x) + "\nset yrange " +
           rangeText(panel_.y, limits_.y) + "\n";
    return out;
  }

  // Round steps, far enough apart for their numbers; the same on both axes of a map.
  [[nodiscard]] std::string tics() const {
    constexpr double kApartX = 75.0;  // [px]
    constexpr double kApartY = 38.0;
    const double span_x = limits_.x.max - limits_.x.min;
    const double span_y = limits_.y.max - limits_.y.min;
    double step_x = roundStep(span_x * kApartX * figure_.columns / figure_.width_px);
    double step_y = roundStep(span_y * kApartY * figure_.rows / figure_.height_px);
    if (panel_.equal_aspect) step_x = step_y = std::max(step_x, step_y);
    const std::string style = "nomirror out scale 0.6 textcolor rgb '#404040'";
    return "set xtics " + style + (panel_.x.logarithmic ? " autofreq" : " " + number(step_x)) +
           "\nset ytics " + style + (panel_.y.logarithmic ? " autofreq" : " " + number(step_y)) +
           "\n";
  }

  const Figure& figure_;
  const Panel& panel_;
  std::string prefix_;
  PanelLimits limits_;
  bool has_values_{false};
  int block_count_{0};
  std::string blocks_;
  std::string decorations_;
  std::vector<std::string> curves_;
};

bool isBlank(const Panel& panel) {
  return panel.rasters.empty() && panel.polygons.empty() && panel.series.empty() &&
         panel.markers.empty() && panel.title.empty();
}

}  // namespace

std::string gnuplotScript(const Figure& figure) {
  std::string out = "set terminal svg size " + std::to_string(figure.width_px) + "," +
                    std::to_string(figure.height_px) +
                    " fixed noenhanced font 'sans-serif,12' background '#ffffff'\n";
  out += "set encoding utf8\nset format '%g'\nset clip two\n";
  out += "set palette defined (" + viridisPalette() + ")\n";
  out +=
      "set multiplot layout " + std::to_string(figure.rows) + "," + std::to_string(figure.columns);
  if (!figure.title.empty()) out += " title " + inQuotes(figure.title) + " font ',14'";
  out += "\n";
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const Panel& panel = figure.panels[i];
    out += isBlank(panel) ? "set multiplot next\n" : PanelScript(figure, panel, i).text();
  }
  return out + "unset multiplot\n";
}

}  // namespace tautline::plot
