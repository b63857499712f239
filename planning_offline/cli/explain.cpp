#include "planning_offline/cli/explain.h"

#include <algorithm>

#include <fmt/core.h>

#include "planning_offline/cli/plan_output.h"

namespace tautline::planning {
namespace {

/// State with the highest risk among first … last; the earlier one of equals.
std::size_t riskiest(const RiskReport& report, std::size_t first, std::size_t last) {
  const auto begin = report.states.begin();
  const auto worst = std::max_element(
      begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(last) + 1,
      [](const StateRisk& a, const StateRisk& b) { return a.risk < b.risk; });
  return static_cast<std::size_t>(worst - begin);
}

}  // namespace

Explanation explain(std::string_view planner, const PlanProblem& problem,
                    const PlanOptions& options, const PlanResult& result,
                    const Progress& progress) {
  Explanation out;
  const RiskReport& report = result.report;
  for (const RiskElement e : problem.risk->enabled()) {
    const double cost = report.element_cost[static_cast<std::size_t>(e)];
    out.shares.push_back({e, report.cost > 0.0 ? cost / report.cost : 0.0, riskOfCost(cost)});
  }
  std::stable_sort(out.shares.begin(), out.shares.end(),
                   [](const auto& a, const auto& b) { return a.share > b.share; });
  out.worst_state = riskiest(report, 0, report.states.size() - 1);
  if (report.states.size() < 3) return out;

  out.avoided_state = riskiest(report, 1, report.states.size() - 2);
  const CellIndex avoided = problem.risk->map().indexAt(report.states[*out.avoided_state].position);
  std::vector<std::uint8_t> free(problem.lattice->freeCells().begin(),
                                 problem.lattice->freeCells().end());
  free[static_cast<std::size_t>(avoided)] = 0;
  if (avoided == problem.start || avoided == options.goal) return out;
  const Lattice lattice(problem.lattice->shape(), problem.lattice->connectivity(), std::move(free));
  PlanProblem other = problem;
  other.lattice = &lattice;
  PlanResult runner_up = solve(planner, other, options, progress);
  out.runner_up = std::move(runner_up);
  return out;
}

std::string explanationText(const Explanation& e, const PlanResult& result) {
  std::string out = "What the risk is made of:\n";
  for (const auto& share : e.shares) {
    out += fmt::format("  {:<20} {:>5.1f} %   alone {:.4f}\n",
                       nameOf(share.element, kRiskElementNames), 100.0 * share.share, share.risk);
  }
  const StateRisk& worst = result.report.states[e.worst_state];
  out += fmt::format("Riskiest state: {} at ({:.2f}, {:.2f}, {:.2f}), {:.4f}\n", e.worst_state,
                     worst.position.x(), worst.position.y(), worst.position.z(), worst.risk);
  if (!e.avoided_state) return out;
  if (!e.runner_up) return out;
  const PlanResult& other = *e.runner_up;
  if (!other) {
    const char* found =
        other.status == PlanStatus::kUnreachable ? "there is no path" : "no path was found in time";
    return out + fmt::format("Without state {} {}.\n", *e.avoided_state, found);
  }
  out += fmt::format(
      "Runner-up, the best path that keeps off state {}: risk {:.4f} ({:+.4f}), {} states ({:+d}), "
      "{:.2f} m ({:+.2f} m)\n",
      *e.avoided_state, other.report.risk, other.report.risk - result.report.risk,
      other.path.size(), static_cast<int>(other.path.size()) - static_cast<int>(result.path.size()),
      wayLength(other.report), wayLength(other.report) - wayLength(result.report));
  for (const auto& share : e.shares) {
    const auto k = static_cast<std::size_t>(share.element);
    const double more = other.report.element_cost[k] - result.report.element_cost[k];
    out += fmt::format("  {:<20} costs it {:+.4f} (of −log(1 − risk))\n",
                       nameOf(share.element, kRiskElementNames), more);
  }
  return out;
}

}  // namespace tautline::planning
