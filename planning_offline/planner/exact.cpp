#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "planning_offline/planner/budget.h"
#include "planning_offline/planner/makers.h"
#include "planning_offline/planner/outcome.h"
#include "planning_offline/planner/traverse.h"
#include "planning_offline/search/cost_to_go.h"

namespace tautline::planning {
namespace {

constexpr const char* kWhat = "all simple paths";

class Exact final : public Planner {
 public:
  [[nodiscard]] PlanResult plan(const PlanProblem& problem, const PlanOptions& options,
                                const Progress& progress) const override;
};

/// A state at the end of a simple path.
struct State {
  CellIndex cell{kNoCell};
  Direction incoming{kNoDirection};
  double cost{0.0};
  double bound{0.0};  ///< To a goal: no path through here costs less.
  TraverseState carried;
};

/// A state that is part of the path at hand.
struct Frame {
  State state;
  double value{0.0};        ///< What utility is made from: discounted sum of (expected) rewards.
  double remaining{0.0};    ///< Rewards that the path has not collected.
  std::size_t children{0};  ///< Where its states begin among all that wait.
};

/// Depth-first search over all simple paths (the dissertation's Algorithm "Evaluate All Simple
/// Paths"). Going back restores the earlier frame, so nothing is divided by a discount of 0.
class Enumeration {
 public:
  Enumeration(const PlanProblem& problem, const PlanOptions& options, Budget& budget)
      : problem_(problem),
        options_(options),
        budget_(budget),
        traverse_(*problem.risk),
        reward_sum_(std::accumulate(problem.reward.begin(), problem.reward.end(), 0.0)),
        on_path_(problem.lattice->shape().size(), 0) {
    if (!options.goal) return;
    to_go_.emplace(
        *problem.lattice, *problem.risk, problem.start, *options.goal,
        CostToGo::Hooks{[this](CellIndex v, Direction d) { return traverse_.tetherBound(v, d); },
                        [this] { return budget_.spent(paths_, kWhat); }});
  }

  void run();

  [[nodiscard]] const std::vector<CellIndex>& best() const { return best_; }
  [[nodiscard]] double bestValue() const { return best_value_; }
  [[nodiscard]] double bestUtility() const { return best_utility_; }
  [[nodiscard]] double lowerBound() const { return lower_bound_; }
  [[nodiscard]] std::int64_t paths() const { return paths_; }
  [[nodiscard]] bool capped() const { return capped_; }
  [[nodiscard]] const BrokenLimits& refused() const { return traverse_.refused(); }

 private:
  [[nodiscard]] bool hopeless(const State& state, double value, double remaining);
  void enter(const State& state);
  void leave();
  void judge(const Frame& frame);
  void addChildren(const State& state);
  [[nodiscard]] double boundOf(const State& state) {
    return to_go_ ? state.cost + to_go_->cost(state.cell, state.incoming) : state.cost;
  }
  [[nodiscard]] double rewardAt(CellIndex cell) const {
    return problem_.reward.empty() ? 0.0 : problem_.reward[static_cast<std::size_t>(cell)];
  }
  /// What a reward at the end of the path counts for.
  [[nodiscard]] double weightAt(const State& state) const {
    return options_.objective == Objective::kExpectedReward ? std::exp(-state.cost) : 1.0;
  }
  [[nodiscard]] double utilityFor(double value, double cost) const {
    if (options_.objective == Objective::kExpectedReward) return value;
    return ratioOf(value, riskOfCost(cost));
  }

  const PlanProblem& problem_;
  const PlanOptions& options_;
  Budget& budget_;
  Traverse traverse_;
  std::optional<CostToGo> to_go_;
  double reward_sum_;
  std::vector<std::uint8_t> on_path_;  // one a cell
  std::vector<Frame> path_;
  std::vector<State> waiting_;  // children of all frames, the next one of the last frame last
  std::vector<CellIndex> best_;
  double best_cost_{kInfiniteCost};
  double best_value_{0.0};
  double best_utility_{-1.0};
  double lower_bound_{0.0};
  std::int64_t paths_{0};
  bool capped_{false};  // something was left out for the risk cap
};

void Enumeration::run() {
  State start{.cell = problem_.start,
              .cost = traverse_.startCost(problem_.start),
              .carried = traverse_.start(problem_.start)};
  start.bound = lower_bound_ = boundOf(start);
  if (hopeless(start, 0.0, reward_sum_)) return;
  enter(start);
  while (!path_.empty()) {
    if (waiting_.size() == path_.back().children) {
      leave();
      continue;
    }
    const State next = waiting_.back();
    waiting_.pop_back();
    if (hopeless(next, path_.back().value, path_.back().remaining)) continue;
    if (budget_.spent(paths_, kWhat)) return;
    enter(next);
  }
}

/// True if neither the path that ends here nor any that goes on can be better than the best. Cost
/// only grows along a path, and no path collects more than there is.
bool Enumeration::hopeless(const State& state, double value, double remaining) {
  if (!(state.bound < kInfiniteCost)) return true;
  if (riskOfCost(state.bound) > options_.risk_cap) {
    capped_ = true;
    return true;
  }
  if (options_.goal) return state.bound >= best_cost_;
  return utilityFor(value + weightAt(state) * remaining, state.cost) <= best_utility_;
}

void Enumeration::enter(const State& state) {
  const double reward = rewardAt(state.cell);
  const double value = path_.empty() ? 0.0 : options_.discount * path_.back().value;
  const double remaining = path_.empty() ? reward_sum_ : path_.back().remaining;
  const Frame frame{.state = state,
                    .value = value + weightAt(state) * reward,
                    .remaining = remaining - reward,
                    .children = waiting_.size()};
  path_.push_back(frame);
  on_path_[static_cast<std::size_t>(state.cell)] = 1;
  ++paths_;
  judge(frame);
  if (state.cell != options_.goal) addChildren(state);
}

void Enumeration::leave() {
  on_path_[static_cast<std::size_t>(path_.back().state.cell)] = 0;
  path_.pop_back();
}

void Enumeration::judge(const Frame& frame) {
  const double utility = utilityFor(frame.value, frame.state.cost);
  if (options_.goal) {
    if (frame.state.cell != options_.goal || frame.state.cost >= best_cost_) return;
  } else if (std::pair(-utility, frame.state.cost) >= std::pair(-best_utility_, best_cost_)) {
    return;
  }
  best_cost_ = frame.state.cost;
  best_value_ = frame.value;
  best_utility_ = utility;
  best_.clear();
  for (const Frame& f : path_) best_.push_back(f.state.cell);
}

/// Children in the order of their directions; towards a goal the most promising first.
void Enumeration::addChildren(const State& state) {
  const auto first = static_cast<std::ptrdiff_t>(waiting_.size());
  const std::uint32_t moves = problem_.lattice->moves(state.cell);
  for (const Direction d : problem_.lattice->directions()) {
    if ((moves >> d & 1U) == 0) continue;
    State next{.cell = problem_.lattice->neighbour(state.cell, d),
               .incoming = d,
               .carried = state.carried};
    if (on_path_[static_cast<std::size_t>(next.cell)] != 0) continue;
    next.cost = state.cost + traverse_.step(next.carried, state.cell, state.incoming, d, next.cell);
    next.bound = boundOf(next);
    waiting_.push_back(next);
  }
  std::reverse(waiting_.begin() + first, waiting_.end());
  if (!to_go_) return;
  std::stable_sort(waiting_.begin() + first, waiting_.end(),
                   [](const State& a, const State& b) { return a.bound > b.bound; });
}

PlanResult bestOfAll(const PlanProblem& problem, const PlanOptions& options, const Enumeration& all,
                     const char* cut) {
  PlanResult result;
  result.path = all.best();
  result.expanded = all.paths();
  describePath(problem, options, result);
  if (result && cut == nullptr) {
    result.status = PlanStatus::kOptimal;
    result.text = "greatest utility of all simple paths";
    result.utility_upper_bound = result.utility;
  } else if (result) {
    result.status = PlanStatus::kCut;
    result.text = std::string("best simple path so far: ") + cut;
  } else if (cut == nullptr) {
    result.status = PlanStatus::kUnreachable;
    result.text = "no path, nor staying, is within the risk cap";
  } else {
    result.text = std::string("stopped before there was a path: ") + cut;
  }
  if (!result) result.text += limitsClause(problem, options, all.refused());
  return result;
}

PlanResult Exact::plan(const PlanProblem& problem, const PlanOptions& options,
                       const Progress& progress) const {
  needGoalOrRewards(problem, options);
  Budget budget(options, progress);
  Enumeration all(problem, options, budget);
  all.run();
  PlanResult result = options.goal ? concludeGoal(problem, options,
                                                  {.path = all.best(),
                                                   .lower_bound = all.lowerBound(),
                                                   .capped = all.capped(),
                                                   .cut = budget.reason(),
                                                   .expanded = all.paths(),
                                                   .refused = all.refused()})
                                   : bestOfAll(problem, options, all, budget.reason());
  if (result && options.discount < 1.0) {
    result.utility = all.bestUtility();
    if (options.objective == Objective::kRatio) result.reward = all.bestValue();
    if (result.utility_upper_bound) result.utility_upper_bound = result.utility;
  }
  return result;
}

}  // namespace

std::unique_ptr<Planner> makeExact() { return std::make_unique<Exact>(); }

}  // namespace tautline::planning
