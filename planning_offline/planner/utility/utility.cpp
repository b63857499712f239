#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <numeric>
#include <string>

#include "planning_offline/planner/budget.h"
#include "planning_offline/planner/choose_goal.h"
#include "planning_offline/planner/makers.h"
#include "planning_offline/planner/outcome.h"
#include "planning_offline/planner/utility/beam_search.h"
#include "planning_offline/planner/utility/candidates.h"
#include "planning_offline/planner/utility/leg_chain.h"
#include "planning_offline/planner/utility/reward_problem.h"
#include "planning_offline/planner/utility/reward_search.h"
#include "planning_offline/search/least_risk_tree.h"

namespace tautline::planning {
namespace {

constexpr std::size_t kBeamWidth = 200;
constexpr std::size_t kSetLimit = 4096;        // bits of a visited set that are worth searching
constexpr std::size_t kSparse = 4;             // cells a reward from which on walks come first
constexpr std::int64_t kFrontLabels = 50'000;  // of the search for the exact front

/// One run of the planner: ever better candidates, and an ever lower bound.
class UtilityRun {
 public:
  UtilityRun(const PlanProblem& problem, const PlanOptions& options, const Progress& progress)
      : problem_(problem),
        options_(options),
        progress_(progress),
        tree_(leastRiskTree(*problem.lattice, *problem.risk, problem.start, options.threads,
                            progress)),
        rewards_(problem, options, *tree_, progress),
        found_(options.objective) {}

  [[nodiscard]] PlanResult run();

 private:
  void findIncumbent();
  void bound();
  void search(RewardSearch::Over over);
  void findFront();
  [[nodiscard]] PlanResult conclude() const;
  [[nodiscard]] std::string text(const PlanResult& result) const;
  /// What is left of the time, or a part of it.
  [[nodiscard]] PlanOptions limits(double part) const;

  const PlanProblem& problem_;
  const PlanOptions& options_;
  const Progress& progress_;
  std::chrono::steady_clock::time_point begin_{std::chrono::steady_clock::now()};
  std::unique_ptr<LeastRiskTree> tree_;
  RewardProblem rewards_;
  Candidates found_;
  double two_stage_walk_{-1.0};  ///< Utility of the two-stage planner's path if it is not simple.
  double upper_bound_{std::numeric_limits<double>::infinity()};
  bool proven_{false};
  bool stopped_{false};  ///< The last search for the best path ran out of time, labels or memory.
  bool front_exact_{false};
  std::int64_t expanded_{0};
};

PlanResult UtilityRun::run() {
  findIncumbent();
  bound();
  if (tree_->complete()) {
    const std::size_t rewards = rewards_.collectibles().size();
    if (rewards <= kSetLimit && rewards * kSparse <= rewards_.reachable().size()) {
      search(RewardSearch::Over::kWalks);
    }
    if (rewards_.reachable().size() <= kSetLimit) {
      if (!proven_) search(RewardSearch::Over::kSimple);
      findFront();
    }
  }
  return conclude();
}

PlanOptions UtilityRun::limits(double part) const {
  const std::chrono::duration<double> used = std::chrono::steady_clock::now() - begin_;
  PlanOptions limits = options_;
  limits.time_limit = part * std::max(0.0, options_.time_limit - used.count());
  return limits;
}

void UtilityRun::findIncumbent() {
  const PathPrefix start = rewards_.start();
  const auto offer = [this](const PathPrefix& end, const std::vector<CellIndex>& path) {
    found_.offer(end.so_far, [&] { return path; });
  };
  if (rewards_.withinCap(start) && rewards_.mayEndAt(start.cell)) offer(start, {start.cell});
  const PlanResult two_stage = makeUtilityTwoStage()->plan(problem_, limits(0.2), progress_);
  if (!two_stage.simple) {
    two_stage_walk_ = two_stage.utility;
  } else if (two_stage) {
    if (const auto end = rewards_.follow(start, two_stage.path)) offer(*end, two_stage.path);
  }
  Budget chain(limits(0.2), progress_);
  if (tree_->complete()) {
    chainLegs(rewards_, *tree_, options_.threads, progress_, found_, chain);
  }
  Budget beam(limits(0.2), progress_);
  beamSearch(rewards_, kBeamWidth, found_, beam);
}

void UtilityRun::bound() {
  const Candidate start = rewards_.start().so_far;
  if (tree_->complete()) {
    upper_bound_ = rewards_.bound().utilityFromStart(start, options_.objective);
    return;
  }
  // Cells that the cancelled search did not reach may hold rewards.
  const double all = std::accumulate(problem_.reward.begin(), problem_.reward.end(), 0.0);
  const bool ratio = options_.objective == Objective::kRatio;
  upper_bound_ = ratio ? ratioOf(all, riskOfCost(start.cost)) : all * std::exp(-start.cost);
}

void UtilityRun::search(RewardSearch::Over over) {
  RewardSearch search(rewards_, over, RewardSearch::Aim::kBest, found_);
  Budget budget(limits(over == RewardSearch::Over::kWalks ? 0.5 : 1.0), progress_);
  search.run(budget);
  expanded_ += search.expanded();
  upper_bound_ = std::min(upper_bound_, search.upperBound());
  proven_ = search.exhausted() && search.bestWalk() <= found_.utility();
  stopped_ = !search.exhausted();
}

void UtilityRun::findFront() {
  PlanOptions limited = limits(1.0);
  limited.label_limit = std::min(limited.label_limit, kFrontLabels);
  RewardSearch search(rewards_, RewardSearch::Over::kSimple, RewardSearch::Aim::kFront, found_);
  Budget budget(limited, progress_);
  search.run(budget);
  expanded_ += search.expanded();
  front_exact_ = search.exhausted();
}

PlanResult UtilityRun::conclude() const {
  PlanResult result;
  result.path = found_.bestPath();
  describePath(problem_, options_, result);
  result.expanded = expanded_;
  for (const auto& [cost, point] : found_.front()) {
    result.front.push_back({riskOfCost(cost), point.reward, point.path});
  }
  if (result) {
    result.utility_upper_bound = proven_ ? result.utility : std::max(upper_bound_, result.utility);
    const bool cut = stopped_ || progress_.cancelled();
    result.status = proven_ ? PlanStatus::kOptimal : cut ? PlanStatus::kCut : PlanStatus::kFeasible;
  } else {
    const bool none =
        rewards_.reachable().empty() || proven_ ||
        (options_.goal && tree_->complete() && !std::isfinite(tree_->costTo(*options_.goal)));
    result.utility_upper_bound = std::max(0.0, none ? 0.0 : upper_bound_);
    result.status = none ? PlanStatus::kUnreachable : PlanStatus::kNone;
  }
  result.text = text(result);
  return result;
}

std::string UtilityRun::text(const PlanResult& result) const {
  if (!result) {
    const std::string none = result.status == PlanStatus::kNone ? "stopped before there was a path"
                             : options_.goal ? "no simple path to the goal within the risk cap"
                                             : "no path, nor staying, is within the risk cap";
    return none + limitsClause(problem_, options_, rewards_.refused());
  }
  std::string text = "no simple path has more utility";
  if (!proven_) {
    std::array<char, 120> bounds{};
    const double bound = *result.utility_upper_bound;
    std::snprintf(bounds.data(), bounds.size(),
                  "best found: the greatest utility is between %.4g and %.4g (gap %.1f %%)",
                  result.utility, bound, 100.0 * (1.0 - result.utility / bound));
    text = bounds.data();
  }
  text += front_exact_ ? "; the front is exact" : "; the front is of the paths that were found";
  if (two_stage_walk_ > result.utility) {
    text += "; a least-risk walk that visits a cell twice has more: utility two-stage";
  }
  return text;
}

class Utility final : public Planner {
 public:
  [[nodiscard]] PlanResult plan(const PlanProblem& problem, const PlanOptions& options,
                                const Progress& progress) const override {
    needGoalOrRewards(problem, options);
    return UtilityRun(problem, options, progress).run();
  }
};

}  // namespace

std::unique_ptr<Planner> makeUtility() { return std::make_unique<Utility>(); }

}  // namespace tautline::planning
