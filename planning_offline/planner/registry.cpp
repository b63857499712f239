#include <chrono>
#include <string>

#include "common/error.h"
#include "planning_offline/planner/makers.h"
#include "planning_offline/planner/planner.h"

namespace tautline::planning {
namespace {

void checkCell(const PlanProblem& problem, CellIndex cell, const char* key) {
  const Lattice& lattice = *problem.lattice;
  const bool inside = cell >= 0 && static_cast<std::size_t>(cell) < lattice.shape().size();
  if (inside && lattice.free(cell)) return;
  throw InputError({.key = key,
                    .problem = inside ? "is not free: in an obstacle, unknown, or nearer to an "
                                        "obstacle than the clearance"
                                      : "is outside the map",
                    .allowed = "a free cell of the map"});
}

void checkRange(const char* key, double value, Range range) {
  if (range.contains(value)) return;
  throw InputError({.key = key,
                    .problem = "is " + std::to_string(value),
                    .allowed = std::to_string(range.min) + " to " + std::to_string(range.max)},
                   ExitCode::kUsage);
}

void check(const PlanProblem& problem, const PlanOptions& options) {
  TAUTLINE_CHECK(problem.lattice != nullptr && problem.risk != nullptr);
  TAUTLINE_CHECK(problem.lattice->shape() == problem.risk->map().shape);
  TAUTLINE_CHECK(problem.reward.empty() ||
                 problem.reward.size() == problem.lattice->shape().size());
  checkCell(problem, problem.start, "start");
  if (options.goal) checkCell(problem, *options.goal, "goal");
  checkRange("risk_cap", options.risk_cap, {0.0, 1.0});
  checkRange("discount", options.discount, {0.0, 1.0});
  checkRange("lookback", options.lookback, {2, 4});
  checkRange("time_limit", options.time_limit, {0.0, 1e9});
  checkRange("label_limit", static_cast<double>(options.label_limit), {1, 4e9});
}

const PlannerInfo& find(std::string_view name) {
  std::string names;
  for (const PlannerInfo& info : planners()) {
    if (name == info.name) return info;
    names += (names.empty() ? "" : ", ") + std::string(info.name);
  }
  throw InputError({.key = "planner",
                    .problem = "there is no planner \"" + std::string(name) + '"',
                    .allowed = names},
                   ExitCode::kUsage);
}

}  // namespace

const std::vector<PlannerInfo>& planners() {
  static const std::vector<PlannerInfo> table{
      {"exact", "everything, over all simple paths; tiny maps", makeExact},
      {"additive", "the plain sum of normalized locale risks: the conventional baseline",
       makeAdditive},
      {"directional", "locale and action elements", makeDirectional},
      {"lookback", "elements that look up to n states back", makeLookback},
      {"tether", "all elements, those of the tether, slippage and battery included", makeTether},
      {"utility two-stage", "best end among the paths of least risk, as published",
       makeUtilityTwoStage},
      {"utility", "reward against risk, with a bound of the gap", makeUtility},
      {"prm", "nothing: a roadmap in the space a straight tether reaches, as published", makePrm}};
  return table;
}

PlanResult solve(std::string_view planner, const PlanProblem& problem, const PlanOptions& options,
                 const Progress& progress) {
  const PlannerInfo& info = find(planner);
  check(problem, options);
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  PlanResult result = info.make()->plan(problem, options, progress);
  result.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  return result;
}

}  // namespace tautline::planning
