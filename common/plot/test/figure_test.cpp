#include "common/plot/figure.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.h"

namespace tautline::plot {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string contents(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

// Not a matcher: a failed one would print the whole picture.
bool has(const std::string& svg, const std::string& text) {
  return svg.find(text) != std::string::npos;
}

std::filesystem::path folder() {
  const auto path = std::filesystem::path(::testing::TempDir()) / "tautline_plot_test";
  std::filesystem::create_directories(path);
  return path;
}

Figure sample() {
  Panel panel;
  panel.title = "Circle";
  panel.x.label = "x [m]";
  panel.y.label = "y [m]";
  panel.equal_aspect = true;
  Series circle{.name = "flown", .points = {}};
  for (int i = 0; i <= 100; ++i)
    circle.points.push_back({2 * std::cos(0.0628 * i), std::sin(0.0628 * i)});
  panel.series.push_back(circle);
  panel.polygons.push_back({.outline = {{0, 0}, {1, 0}, {1, 0.5}, {0, 0.5}}, .name = "box"});
  panel.markers.push_back({.at = {0, 0}, .label = "reel"});
  Series coloured = circle;
  coloured.name = "risk";
  for (const Point& p : coloured.points) coloured.values.push_back(p.x);
  Panel second = panel;
  second.value_label = "risk [1]";
  second.series.push_back(coloured);
  second.marks.push_back({.x = 0.5, .label = "contact 1"});
  return {.title = "Two panels", .rows = 1, .columns = 2, .panels = {panel, second}};
}

TEST(Figure, DrawsTheSameBytesEveryTime) {
  const auto first = folder() / "first.svg";
  const auto second = folder() / "second.svg";
  writeSvg(sample(), first);
  writeSvg(sample(), second);
  const std::string svg = contents(first);
  EXPECT_EQ(svg, contents(second));
  EXPECT_TRUE(has(svg, "<svg")) << "<svg";
  EXPECT_TRUE(has(svg, "</svg>")) << "</svg>";
  for (const char* text : {"Two panels", "x [m]", "flown", "reel", "contact 1", "risk [1]"}) {
    EXPECT_TRUE(has(svg, text)) << text;
  }
}

TEST(Figure, TextIsNeverACommand) {
  const auto victim = folder() / "victim";
  std::filesystem::remove(victim);
  const std::string touch = "touch " + victim.string();
  Figure figure = sample();
  figure.title = "`" + touch + "` <b>&amp; {/Bold it's} %s @x";
  figure.panels[0].title = "'; system('" + touch + "'); '";
  figure.panels[0].x.label = "a\nsystem \"" + touch + "\"\n!" + touch + "\n";
  figure.panels[0].series[0].name = "END_OF_DATA\n!" + touch;
  figure.panels[0].markers[0].label = "'.system(\"" + touch + "\").'";
  const auto file = folder() / "text.svg";
  writeSvg(figure, file);
  EXPECT_FALSE(std::filesystem::exists(victim));
  const std::string svg = contents(file);
  EXPECT_TRUE(has(svg, "&lt;b>&amp;amp; {/Bold it's} %s @x"))
      << "&lt;b>&amp;amp; {/Bold it's} %s @x";
  EXPECT_FALSE(has(svg, "<b>")) << "<b>";
}

TEST(Figure, OddDataAreStillAPicture) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Figure figure{.title = "", .rows = 2, .columns = 2, .panels = {}};
  Panel constant;
  constant.series.push_back({.name = "one value", .points = {{1, 3}, {2, 3}, {3, 3}}});
  Panel single;
  single.equal_aspect = true;
  single.series.push_back({.name = "one point", .points = {{1, 3}}, .style = Style::kPoints});
  Panel gaps;
  gaps.y.logarithmic = true;
  gaps.series.push_back(
      {.name = "gaps", .points = {{nan, 1}, {0, 1}, {1, nan}, {2, 0.0}, {3, 100}, {4, nan}}});
  Panel none;
  none.title = "nothing here";
  none.series.push_back({.name = "empty", .points = {}});
  figure.panels = {constant, single, gaps, none};
  const auto file = folder() / "odd.svg";
  ASSERT_NO_THROW(writeSvg(figure, file));
  const std::string svg = contents(file);
  for (const char* text : {"one value", "one point", "gaps", "nothing here"})
    EXPECT_TRUE(has(svg, text)) << text;
  EXPECT_FALSE(has(svg, "nan")) << "nan";
}

TEST(Figure, EqualAspectMeansEqualScale) {
  // Independent look at the drawing itself: a 2 m x 2 m square must be as wide as it is high in
  // pixels.
  Figure figure{.width_px = 900, .height_px = 400, .panels = {Panel{}}};
  Panel& panel = figure.panels[0];
  panel.equal_aspect = true;
  panel.legend = false;
  panel.series.push_back({.points = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {0, 0}},
                          .colour = Colour::kVermilion,
                          .width = 3.21});
  const auto file = folder() / "square.svg";
  writeSvg(figure, file);
  const std::string svg = contents(file);
  const auto stroke = svg.find("d='M", svg.find("gnuplot_plot_"));
  std::istringstream numbers;
  double min_x = 1e9, max_x = -1e9, min_y = 1e9, max_y = -1e9;
  std::size_t at = svg.find("3.21");
  ASSERT_NE(at, std::string::npos);
  at = svg.find("d='M", std::min(at, stroke));
  std::string path = svg.substr(at + 3, svg.find('\'', at + 4) - at - 3);
  for (char& c : path) {
    if (c == 'M' || c == 'L' || c == ',') c = ' ';
  }
  numbers.str(path);
  for (double x = 0, y = 0; numbers >> x >> y;) {
    min_x = std::min(min_x, x);
    max_x = std::max(max_x, x);
    min_y = std::min(min_y, y);
    max_y = std::max(max_y, y);
  }
  EXPECT_GT(max_x - min_x, 100.0);
  EXPECT_NEAR(max_x - min_x, max_y - min_y, 1.5);
}

TEST(Figure, AMissingFolderIsAnErrorThatNamesTheFile) {
  try {
    writeSvg(sample(), folder() / "not" / "there" / "a.svg");
    FAIL() << "no exception";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("a.svg"));
  }
}

TEST(Figure, AMissingGnuplotIsAnErrorThatSaysWhatToInstall) {
  const std::string path = std::getenv("PATH") != nullptr ? std::getenv("PATH") : "";
  const auto file = folder() / "kept.svg";
  std::ofstream(file) << "before";
  ASSERT_EQ(::setenv("PATH", "/nowhere", 1), 0);
  std::string message;
  try {
    writeSvg(sample(), file);
  } catch (const InputError& e) {
    message = e.what();
  }
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(message, HasSubstr("apt-get install gnuplot-nox"));
  EXPECT_EQ(contents(file), "before");
  for (const auto& entry : std::filesystem::directory_iterator(folder())) {
    EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr("kept.svg.")))
        << "temporary file left behind";
  }
}

}  // namespace
}  // namespace tautline::plot
