#pragma once

/// @file
/// One function a planner; planner.h's planners() is the table that names them.

#include <memory>

#include "planning_offline/planner/planner.h"

namespace tautline::planning {

[[nodiscard]] std::unique_ptr<Planner> makeExact();
[[nodiscard]] std::unique_ptr<Planner> makeAdditive();
[[nodiscard]] std::unique_ptr<Planner> makeDirectional();
[[nodiscard]] std::unique_ptr<Planner> makeLookback();
[[nodiscard]] std::unique_ptr<Planner> makeTether();
[[nodiscard]] std::unique_ptr<Planner> makeUtilityTwoStage();
[[nodiscard]] std::unique_ptr<Planner> makeUtility();
[[nodiscard]] std::unique_ptr<Planner> makePrm();

}  // namespace tautline::planning
