#pragma once

/// @file
/// Pictures of things in space: top, front and side view, laid out so that neighbouring views share
/// an axis. Frame W (y up), [m].
///
///     top    x to the right, z downwards  (seen from above)
///     front  x to the right, y upwards    (seen from +z)
///     side   z to the right, y upwards    (seen from -x)

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/fields.h"
#include "common/mission/scene.h"
#include "common/plot/figure.h"

namespace tautline::plot {

enum class View : std::uint8_t { kTop, kFront, kSide };
inline constexpr std::array<EnumName<View>, 3> kViewNames{
    {{View::kTop, "top"}, {View::kFront, "front"}, {View::kSide, "side"}}};

/// A line or a cloud of points in space, drawn like a Series.
struct SpaceCurve {
  std::string name{};  ///< In the legend; empty = not listed.
  std::vector<Eigen::Vector3d> points{};
  Style style{Style::kLine};
  Colour colour{Colour::kBlue};
  double width{1.6};
  Symbol symbol{Symbol::kDot};
  bool background{false};  ///< Does not widen the views.
  std::vector<double>
      values{};  ///< One a point: coloured by value (Drawing::value_label); empty = `colour`.
};

struct SpaceMarker {
  Eigen::Vector3d at{Eigen::Vector3d::Zero()};
  std::string label{};
  Symbol symbol{Symbol::kCircle};
  Colour colour{Colour::kBlack};
  double size{1.0};
  std::string name{};  ///< In the legend; empty = not listed.
};

/// What is to be seen, in drawing order: obstacles, curves, markers. The views are as large as
/// curves and markers need; obstacles and room are seen as far as they reach into them.
struct Drawing {
  std::string title{};
  std::string value_label{};                      ///< Of the colour bar of curves with values.
  std::optional<Limits> value_limits{};           ///< Absent: from the values.
  std::array<std::optional<Raster>, 3> images{};  ///< Under each View; in that view's coordinates.
  std::vector<Box> boxes{};
  std::vector<Prism> prisms{};
  std::vector<SpaceCurve> curves{};
  std::vector<SpaceMarker> markers{};
};

/// Adds obstacles, room and floor of a scene that is in W (sceneInWorld()).
void addScene(Drawing& drawing, const Scene& scene);

[[nodiscard]] Point project(View view, const Eigen::Vector3d& p);

/// One view as a panel of equal aspect, without limits.
[[nodiscard]] Panel viewPanel(const Drawing& drawing, View view);

/// One view as a figure of its own.
[[nodiscard]] Figure viewFigure(const Drawing& drawing, View view);

/// All three views and one legend.
[[nodiscard]] Figure viewsFigure(const Drawing& drawing);

}  // namespace tautline::plot
