#pragma once

/// @file
/// One interface for all planners: same map, same risk, same result. docs/planning.md says what
/// each is optimal for. Not real-time safe: offline only.

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/fields.h"
#include "planning_offline/map/lattice.h"
#include "planning_offline/progress.h"
#include "planning_offline/risk/risk_model.h"

namespace tautline::planning {

/// What a planner may use. The lattice says where the vehicle may be, the model what it risks
/// there.
struct PlanProblem {
  const Lattice* lattice{nullptr};
  const RiskModel* risk{nullptr};
  std::vector<double>
      reward;  ///< One a cell, >= 0; empty = no rewards anywhere. Counts once per distinct cell.
  CellIndex start{kNoCell};  ///< Free.
};

/// What the plan is to be good at, for planners that choose the goal themselves.
enum class Objective : std::uint8_t {
  kRatio,           ///< Σ reward / risk, the dissertation's utility.
  kExpectedReward,  ///< Σ_i reward_i Π_{j<=i} (1 − r_j).
};
inline constexpr std::array<EnumName<Objective>, 2> kObjectiveNames{
    {{Objective::kRatio, "ratio"}, {Objective::kExpectedReward, "expected_reward"}}};

struct PlanOptions {
  std::optional<CellIndex> goal;  ///< Absent: the planner chooses where to end, by the objective.
  Objective objective{Objective::kRatio};
  double risk_cap{1.0};                  ///< Paths of a higher risk are no candidates.
  double discount{1.0};                  ///< γ of the exact planner's reward, in [0, 1].
  int lookback{3};                       ///< n of `lookback`: 2, 3, 4.
  double time_limit{60.0};               ///< [s]
  std::int64_t label_limit{10'000'000};  ///< Paths or labels held or enumerated; about 100 B each.
  std::uint64_t seed{1};
  int threads{0};  ///< 0 = all cores.
};

enum class PlanStatus : std::uint8_t {
  kOptimal,      ///< What the planner's page promises, proven.
  kFeasible,     ///< A path, without that promise: bound and text say how far it may be off.
  kCut,          ///< A path, best so far when time, labels or the user stopped the search.
  kUnreachable,  ///< No path.
  kNone,         ///< Stopped before there was any path.
};
inline constexpr std::array<EnumName<PlanStatus>, 5> kPlanStatusNames{
    {{PlanStatus::kOptimal, "optimal"},
     {PlanStatus::kFeasible, "feasible"},
     {PlanStatus::kCut, "cut"},
     {PlanStatus::kUnreachable, "unreachable"},
     {PlanStatus::kNone, "none"}}};

/// One point of the front of reward against risk, and the path that has it.
struct FrontPoint {
  double risk{0.0};
  double reward{0.0};
  std::vector<CellIndex> path;
};

struct PlanResult {
  PlanStatus status{PlanStatus::kNone};
  std::string text;  ///< What the status means here, one line.
  std::vector<CellIndex>
      path;  ///< Start first; empty without a path. Neighbours on the lattice, but for `prm`.
  RiskReport report;    ///< Of the path, by RiskModel::evaluate().
  double reward{0.0};   ///< Σ over distinct cells (exact planner with discount < 1: discounted).
  double utility{0.0};  ///< By the objective.
  bool simple{true};    ///< No cell twice.
  std::optional<double> risk_lower_bound;     ///< No path to the goal has less risk.
  std::optional<double> utility_upper_bound;  ///< No path has more.
  std::vector<FrontPoint> front;              ///< `utility` only, by rising risk.
  std::int64_t expanded{0};                   ///< States, labels or paths taken up.
  double seconds{0.0};                        ///< Wall time of the planner alone.

  explicit operator bool() const noexcept { return !path.empty(); }
};

class Planner {
 public:
  virtual ~Planner() = default;
  /// Deterministic for a problem and options (but for where time or the user cuts). Fills
  /// everything of the result but `seconds`, which solve() sets.
  [[nodiscard]] virtual PlanResult plan(const PlanProblem& problem, const PlanOptions& options,
                                        const Progress& progress) const = 0;
};

/// Name, how to make it, what it is optimal for: the one table of planners.
struct PlannerInfo {
  const char* name;
  const char* optimal_for;
  std::unique_ptr<Planner> (*make)();
};
[[nodiscard]] const std::vector<PlannerInfo>& planners();

/// Checks the problem (start free, goal free), runs the planner, measures it. Throws InputError for
/// an unknown planner or a start or goal that is not free.
[[nodiscard]] PlanResult solve(std::string_view planner, const PlanProblem& problem,
                               const PlanOptions& options, const Progress& progress);

/// Σ reward over the distinct cells of a path.
[[nodiscard]] double rewardOf(const std::vector<double>& reward,
                              const std::vector<CellIndex>& path);

/// Reward over risk: infinite for a reward without risk, 0 without both.
[[nodiscard]] inline double ratioOf(double reward, double risk) noexcept {
  if (reward <= 0.0) return 0.0;
  return risk > 0.0 ? reward / risk : std::numeric_limits<double>::infinity();
}

/// Utility of a path by the objective; the ratio is ratioOf().
[[nodiscard]] double utilityOf(const std::vector<double>& reward,
                               const std::vector<CellIndex>& path, const RiskReport& report,
                               Objective objective);

/// Fills report, reward, utility, simple from `path` and the problem. What every planner ends with.
void describePath(const PlanProblem& problem, const PlanOptions& options, PlanResult& result);

}  // namespace tautline::planning
