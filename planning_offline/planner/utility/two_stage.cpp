#include "planning_offline/planner/makers.h"

namespace tautline::planning {
namespace {

/// The published pair of planners: the directional search is the upper stage, the choice among its
/// paths the lower one. With a goal there is nothing left to choose.
class UtilityTwoStage final : public Planner {
 public:
  [[nodiscard]] PlanResult plan(const PlanProblem& problem, const PlanOptions& options,
                                const Progress& progress) const override {
    PlanResult result = makeDirectional()->plan(problem, options, progress);
    result.risk_lower_bound.reset();
    if (result.status == PlanStatus::kOptimal) result.status = PlanStatus::kFeasible;
    if (result.status == PlanStatus::kFeasible) {
      result.text =
          "best utility among the paths of least risk and staying; others may have more: utility";
    }
    return result;
  }
};

}  // namespace

std::unique_ptr<Planner> makeUtilityTwoStage() { return std::make_unique<UtilityTwoStage>(); }

}  // namespace tautline::planning
