#include "planning_offline/planner/outcome.h"

#include <array>
#include <cstdio>
#include <utility>

namespace tautline::planning {
namespace {

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
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

PlanResult concludeGoal(const PlanProblem& problem, const PlanOptions& options,
                        const GoalSearch& found) {
  PlanResult result;
  if (found.path.empty()) {
    result = withoutPath(found);
    if (found.capped && found.cut == nullptr) result.text += " within the risk cap";
    return result;
  }
  result.path = found.path;
  describePath(problem, options, result);
  const double risk = result.report.risk;
  if (risk > options.risk_cap || !std::isfinite(result.report.cost)) {
    result = withoutPath(found);
    result.text += risk > options.risk_cap ? " within the risk cap (best found: risk " : " (risk ";
    result.text += number(risk) + ")";
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
    result.text = std::string("stopped before there was a path: ") + cut;
  } else {
    result.status = PlanStatus::kUnreachable;
    result.text = "no path, nor staying, is within the risk cap";
  }
  result.expanded = found.expanded;
  return result;
}

}  // namespace tautline::planning
