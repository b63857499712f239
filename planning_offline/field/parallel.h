#pragma once

/// @file
/// Loops over independent pieces of work on several threads. Not real-time safe: offline only.

#include <functional>
#include <string_view>

#include "planning_offline/progress.h"

namespace tautline::planning {

/// What a loop reports: its text, and the part of the whole that it covers.
struct Stage {
  std::string_view what;
  double from{0.0};
  double to{1.0};
};

/// Calls body(i) once for every i in [0, count), in any order, from up to `threads` threads (0 =
/// all cores), the caller's among them, which alone reports. The result does not depend on the
/// number of threads if no two calls write the same thing. The body must not throw. False if
/// cancelled: then some calls were left out.
[[nodiscard]] bool parallelFor(int count, int threads, const Progress& progress, const Stage& stage,
                               const std::function<void(int)>& body);

}  // namespace tautline::planning
