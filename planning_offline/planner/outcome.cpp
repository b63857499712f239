#include "planning_offline/planner/outcome.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace tautline::planning {
namespace {

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

/// The limits by their names in the parameters, and what the map forbids.
std::string textOf(const BrokenLimits& broken, const TetherLimits& limits) {
  std::string text;
  const auto add = [&text](const std::string& limit) {
    text += (text.empty() ? "" : ", ") + limit;
  };
  if (broken.length) add("length_max_m = " + number(limits.length_max));
  if (broken.contacts) add("contacts_max = " + std::to_string(limits.contacts_max));
  if (broken.elevation) add("elevation_min_deg = " + number(limits.elevation_min));
  if (broken.no_contact) add("no contact on forbidden surfaces");
  return text;
}

/// Whether the lattice leads from the start to the goal through cells that are not forbidden.
bool connected(const PlanProblem& problem, CellIndex goal) {
  const Lattice& lattice = *problem.lattice;
  const std::vector<double>& locale = problem.risk->costs().locale;
  std::vector<std::uint8_t> seen(lattice.shape().size(), 0);
  std::vector<CellIndex> waiting;
  const auto visit = [&](CellIndex cell) {
    const auto i = static_cast<std::size_t>(cell);
    if (seen[i] != 0 || !std::isfinite(locale[i])) return;
    seen[i] = 1;
    waiting.push_back(cell);
  };
  visit(problem.start);
  while (!waiting.empty()) {
    const CellIndex cell = waiting.back();
    waiting.pop_back();
    const std::uint32_t moves = lattice.moves(cell);
    for (const Direction d : lattice.directions()) {
      if ((moves >> d & 1U) != 0) visit(lattice.neighbour(cell, d));
    }
  }
  return seen[static_cast<std::size_t>(goal)] != 0;
}

/// Limits that a path breaks which was found without regard to them.
BrokenLimits brokenBy(const RiskReport& report, const RiskModel& risk) {
  BrokenLimits broken;
  TautString* const string = risk.string();
  if (string == nullptr) return broken;
  StackId stack = kStraight;
  Eigen::Vector3d last = string->reel();
  for (const StateRisk& state : report.states) {
    stack = string->move(stack, last, state.position);
    last = state.position;
    broken |= risk.brokenLimits(stack, last);
  }
  return broken;
}

PlanResult withoutPath(const GoalSearch& found) {
  PlanResult result;
  result.expanded = found.expanded;
  result.risk_lower_bound = riskOfCost(found.lower_bound);
  if (found.cut != nullptr) {
    result.status = PlanStatus::kNone;
    result.text = std::string("stopped before there was a path: ") + found.cut;
  } else {
    result.status = PlanStatus::kUnreachable;
    result.text = found.proven ? "no path to the goal" : "found no path to the goal";
  }
  return result;
}

}  // namespace

std::string limitsClause(const PlanProblem& problem, const PlanOptions& options,
                         const BrokenLimits& refused) {
  if (!refused.any() || (options.goal && !connected(problem, *options.goal))) return {};
  return "; limits of the tether refused the ways: " +
         textOf(refused, problem.risk->params().tether_limits);
}

PlanResult concludeGoal(const PlanProblem& problem, const PlanOptions& options,
                        const GoalSearch& found) {
  PlanResult result;
  if (found.path.empty()) {
    result = withoutPath(found);
    if (found.capped && found.cut == nullptr) result.text += " within the risk cap";
    result.text += limitsClause(problem, options, found.refused);
    return result;
  }
  result.path = found.path;
  describePath(problem, options, result);
  const double risk = result.report.risk;
  if (risk > options.risk_cap || !std::isfinite(result.report.cost)) {
    std::string clause;
    if (!std::isfinite(result.report.cost)) {
      BrokenLimits refused = found.refused;
      refused |= brokenBy(result.report, *problem.risk);
      clause = limitsClause(problem, options, refused);
    }
    result = withoutPath(found);
    result.text += risk > options.risk_cap ? " within the risk cap (best found: risk " : " (risk ";
    result.text += number(risk) + ")" + clause;
    return result;
  }
  result.expanded = found.expanded;
  const bool least = found.proven && !found.rounded && found.cut == nullptr;
  result.risk_lower_bound = least ? risk : std::min(risk, riskOfCost(found.lower_bound));
  const std::string range =
      "the least risk is between " + number(*result.risk_lower_bound) + " and " + number(risk);
  if (found.cut != nullptr) {
    result.status = PlanStatus::kCut;
    result.text = std::string("best so far, ") + found.cut + ": " + range;
  } else if (found.proven) {
    result.status = PlanStatus::kOptimal;
    result.text = "least risk to the goal";
  } else {
    result.status = PlanStatus::kFeasible;
    result.text = range;
  }
  return result;
}

PlanResult concludeAll(const PlanProblem& problem, const PlanOptions& options,
                       const AllSearch& found, const Progress& progress) {
  PlanResult result;
  std::optional<GoalChoice> choice = chooseGoal(problem, options, found.paths, progress);
  const char* cut = progress.cancelled() ? "cancelled" : found.cut;
  if (cut == nullptr && choice) cut = choice->cut;
  if (choice) {
    result.path = std::move(choice->path);
    describePath(problem, options, result);
    result.status = cut != nullptr ? PlanStatus::kCut
                    : found.proven ? PlanStatus::kOptimal
                                   : PlanStatus::kFeasible;
    result.text = found.proven ? "best end among the paths of least risk"
                               : "best end among the paths that were found";
    if (cut != nullptr) result.text += std::string(", as far as known: ") + cut;
  } else if (cut != nullptr) {
    result.status = PlanStatus::kNone;
    result.text = std::string("stopped before there was a path: ") + cut +
                  limitsClause(problem, options, found.refused);
  } else {
    result.status = PlanStatus::kUnreachable;
    result.text = "no path, nor staying, is within the risk cap" +
                  limitsClause(problem, options, found.refused);
  }
  result.expanded = found.expanded;
  return result;
}

}  // namespace tautline::planning
