#pragma once

/// @file
/// Why a plan is as it is. Not real-time safe: offline only.

#include <optional>
#include <string>
#include <vector>

#include "planning_offline/planner/planner.h"

namespace tautline::planning {

struct Explanation {
  /// Enabled elements by falling share of the path's cost −log(1 − risk).
  struct Share {
    RiskElement element;
    double share;  ///< 0 … 1.
    double risk;   ///< What this element alone would make the path risk.
  };
  std::vector<Share> shares;
  std::size_t worst_state{0};  ///< With the highest state risk.
  /// The same planner's result without the plan's worst state between its ends; absent where there
  /// is none such.
  std::optional<std::size_t> avoided_state;
  std::optional<PlanResult> runner_up;
};

/// `result` must have a path.
[[nodiscard]] Explanation explain(std::string_view planner, const PlanProblem& problem,
                                  const PlanOptions& options, const PlanResult& result,
                                  const Progress& progress);

[[nodiscard]] std::string explanationText(const Explanation& explanation, const PlanResult& result);

}  // namespace tautline::planning
