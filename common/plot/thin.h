#pragma once

/// @file
/// Leaves out the points of a line that nobody could see, so that a picture of an hour stays as
/// small as one of a minute.

#include <cstddef>
#include <vector>

#include "common/plot/figure.h"

namespace tautline::plot {

/// Indices, ascending, of the points to draw, for a picture whose smallest visible steps are
/// `step_x` and `step_y` (> 0, units of the data). Where x never falls, each column of width
/// `step_x` keeps its first, lowest, highest and last point: peaks stay. Elsewhere a point is
/// dropped while it is within one step of the last one kept. Breaks (non-finite points) and both
/// ends stay.
[[nodiscard]] std::vector<std::size_t> visiblePoints(const std::vector<Point>& points,
                                                     double step_x, double step_y);

}  // namespace tautline::plot
