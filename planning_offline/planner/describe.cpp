#include <algorithm>
#include <unordered_set>

#include "planning_offline/planner/planner.h"

namespace tautline::planning {
namespace {

/// Calls f(state index, reward) at the first visit of each cell.
template <class F>
void forFirstVisits(const std::vector<double>& reward, const std::vector<CellIndex>& path, F f) {
  if (reward.empty()) return;
  std::unordered_set<CellIndex> seen;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (seen.insert(path[i]).second) f(i, reward[static_cast<std::size_t>(path[i])]);
  }
}

bool isSimple(std::vector<CellIndex> path) {
  std::sort(path.begin(), path.end());
  return std::adjacent_find(path.begin(), path.end()) == path.end();
}

}  // namespace

double rewardOf(const std::vector<double>& reward, const std::vector<CellIndex>& path) {
  double sum = 0.0;
  forFirstVisits(reward, path, [&](std::size_t, double r) { sum += r; });
  return sum;
}

double utilityOf(const std::vector<double>& reward, const std::vector<CellIndex>& path,
                 const RiskReport& report, Objective objective) {
  if (objective == Objective::kRatio) return ratioOf(rewardOf(reward, path), report.risk);
  std::vector<double> survival;
  survival.reserve(path.size());
  double cost = 0.0;
  for (const StateRisk& state : report.states) {
    cost += costOfRisk(state.risk);
    survival.push_back(std::exp(-cost));
  }
  double expected = 0.0;
  forFirstVisits(reward, path, [&](std::size_t i, double r) { expected += r * survival[i]; });
  return expected;
}

void describePath(const PlanProblem& problem, const PlanOptions& options, PlanResult& result) {
  result.simple = isSimple(result.path);
  if (result.path.empty()) return;
  result.report = problem.risk->evaluate(result.path);
  result.reward = rewardOf(problem.reward, result.path);
  result.utility = utilityOf(problem.reward, result.path, result.report, options.objective);
}

}  // namespace tautline::planning
