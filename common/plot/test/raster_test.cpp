#include "common/plot/raster.h"

#include <gtest/gtest.h>

#include "common/plot/figure.h"

namespace tautline::plot {
namespace {

TEST(Raster, TheScaleGrowsLighterAndClamps) {
  const auto lightness = [](const Rgb& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; };
  double before = -1.0;
  for (int i = 0; i <= 20; ++i) {
    const double now = lightness(viridis(0.05 * i));
    EXPECT_GT(now, before) << i;
    before = now;
  }
  EXPECT_EQ(viridis(-1.0), viridis(0.0));
  EXPECT_EQ(viridis(2.0), viridis(1.0));
}

// gnuplot wants pixel centres, and the panel must be as large as the image's outer edges.
TEST(Raster, PixelsAreWrittenAtTheirCentres) {
  Panel panel;
  panel.rasters.push_back({.x_min = 10.0,
                           .y_min = 20.0,
                           .pixel_width = 2.0,
                           .pixel_height = 4.0,
                           .columns = 2,
                           .rows = 1,
                           .pixels = {grey(0.0), grey(1.0)}});
  const std::string script = gnuplotScript({.panels = {panel}});
  EXPECT_NE(script.find("11 22 0 0 0\n13 22 255 255 255\n"), std::string::npos) << script;
  EXPECT_NE(script.find("with rgbimage pixels"), std::string::npos);
  EXPECT_NE(script.find("set xrange [10:14]"), std::string::npos) << script;
}

// The colours of an image are explained by a colour bar, though nothing else is drawn by value.
TEST(Raster, ValueLimitsAloneShowTheColourBar) {
  Panel panel;
  panel.title = "field";
  panel.value_label = "distance [m]";
  panel.value_limits = Limits{0.0, 3.0};
  const std::string script = gnuplotScript({.panels = {panel}});
  EXPECT_NE(script.find("set cbrange [0:3]"), std::string::npos);
  EXPECT_NE(script.find("with lines lc palette"), std::string::npos);
}

}  // namespace
}  // namespace tautline::plot
