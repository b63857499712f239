#include "common/plot/views.h"

#include <algorithm>
#include <utility>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace tautline::plot {
namespace {

std::pair<Point, Point> corners(const Polygon& polygon) {
  std::pair<Point, Point> out{polygon.outline.front(), polygon.outline.front()};
  for (const auto& p : polygon.outline) {
    out.first = {std::min(out.first.x, p.x), std::min(out.first.y, p.y)};
    out.second = {std::max(out.second.x, p.x), std::max(out.second.y, p.y)};
  }
  return out;
}

// The same solid as a box and as a prism must look the same from everywhere.
TEST(Views, ABoxAndAPrismOfTheSameSizeLookAlike) {
  Drawing drawing;
  drawing.boxes.push_back({"box", {1, 0, -3}, {2, 5, -1}});
  drawing.prisms.push_back({"prism", {{-3, 1}, {-1, 1}, {-1, 2}, {-3, 2}}, 0, 5});
  const double expected[3][4] = {
      {1, -3, 2, -1}, {1, 0, 2, 5}, {-3, 0, -1, 5}};  // top x z, front x y, side z y
  for (const auto& view : kViewNames) {
    const Panel panel = viewPanel(drawing, view.value);
    ASSERT_EQ(panel.polygons.size(), 2U);
    EXPECT_TRUE(panel.equal_aspect);
    for (const auto& polygon : panel.polygons) {
      const auto [min, max] = corners(polygon);
      const double* want = expected[static_cast<int>(view.value)];
      EXPECT_EQ(min.x, want[0]) << view.name;
      EXPECT_EQ(min.y, want[1]) << view.name;
      EXPECT_EQ(max.x, want[2]) << view.name;
      EXPECT_EQ(max.y, want[3]) << view.name;
    }
  }
}

// Views of a right-handed frame: right x up must point at the viewer, who is above, in front (+z),
// at the side (-x).
TEST(Views, NoViewIsMirrored) {
  const Eigen::Vector3d viewer[3] = {{0, 1, 0}, {0, 0, 1}, {-1, 0, 0}};
  for (const auto& view : kViewNames) {
    const Panel panel = viewPanel({}, view.value);
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    Eigen::Vector3d up = Eigen::Vector3d::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const Point p = project(view.value, Eigen::Vector3d::Unit(axis));
      right[axis] = panel.x.reversed ? -p.x : p.x;
      up[axis] = panel.y.reversed ? -p.y : p.y;
    }
    EXPECT_TRUE(right.cross(up).isApprox(viewer[static_cast<int>(view.value)])) << view.name;
  }
}

TEST(Views, AllThreeHaveOneScale) {
  Drawing drawing;
  drawing.curves.push_back({.name = "path", .points = {{0, 0, 0}, {8, 1, 2}, {-1, 3, 0}}});
  const Figure figure = viewsFigure(drawing);
  ASSERT_EQ(figure.panels.size(), 4U);
  const auto span = [](const Axis& axis) { return axis.limits->max - axis.limits->min; };
  const auto &top = figure.panels[0], &front = figure.panels[2], &side = figure.panels[3];
  EXPECT_NEAR(span(top.x), span(front.x), 1e-12);
  EXPECT_NEAR(span(front.x), span(side.x), 1e-12);
  EXPECT_EQ(top.x.limits->min, front.x.limits->min);
  EXPECT_EQ(front.y.limits->min, side.y.limits->min);
  for (const auto& p : drawing.curves[0].points) {
    EXPECT_TRUE(p.x() > front.x.limits->min && p.x() < front.x.limits->max);
    EXPECT_TRUE(p.y() > front.y.limits->min && p.y() < front.y.limits->max);
    EXPECT_TRUE(p.z() > top.y.limits->min && p.z() < top.y.limits->max);
    EXPECT_TRUE(p.z() > side.x.limits->min && p.z() < side.x.limits->max);
  }
}

}  // namespace
}  // namespace tautline::plot
