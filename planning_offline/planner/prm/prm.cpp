#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "planning_offline/field/reach.h"
#include "planning_offline/planner/choose_goal.h"
#include "planning_offline/planner/makers.h"
#include "planning_offline/planner/prm/roadmap.h"

namespace tautline::planning {
namespace {

constexpr std::size_t kTargets = 2000;  // rewards that become milestones, the greatest

/// Points about a cell apart along straight legs, and the cells that hold them.
struct Flight {
  std::vector<Eigen::Vector3d> points;  // M [m]
  std::vector<CellIndex> cells;
};

Flight flightAlong(const VoxelMap& map, const std::vector<CellIndex>& milestones) {
  Flight flight{{map.centre(milestones.front())}, {milestones.front()}};
  for (std::size_t i = 1; i < milestones.size(); ++i) {
    const Eigen::Vector3d from = map.shape.cell(milestones[i - 1]).cast<double>();
    const Eigen::Vector3d way = map.shape.cell(milestones[i]).cast<double>() - from;
    const int steps = static_cast<int>(way.cwiseAbs().maxCoeff());
    for (int k = 1; k <= steps; ++k) {
      const Eigen::Vector3d centre = from + way * k / steps;  // in cells, relative to a centre
      // Where the line crosses from cell to cell, the cell that it goes on in: the other ones on
      // that edge it may never have been in.
      const Eigen::Vector3d ahead = centre + 1e-9 * way;
      const Eigen::Vector3i cell = (ahead.array() + 0.5).floor().cast<int>();
      flight.points.push_back(map.origin + map.resolution * (centre.array() + 0.5).matrix());
      flight.cells.push_back(map.shape.index(cell));
    }
  }
  return flight;
}

class Prm final : public Planner {
 public:
  [[nodiscard]] PlanResult plan(const PlanProblem& problem, const PlanOptions& options,
                                const Progress& progress) const override;
};

/// Where the roadmap may be: what a straight tether reaches, or all free cells without a reel.
struct Space {
  std::vector<std::uint8_t> allowed;
  const char* name{"in the free cells"};
};

Space spaceOf(const PlanProblem& problem, const PlanOptions& options, const Progress& progress) {
  const RiskModel& risk = *problem.risk;
  const auto cells = problem.lattice->freeCells();
  Space space{{cells.begin(), cells.end()}};
  std::optional<Eigen::Vector3d> reel = risk.map().reel;
  if (risk.string() != nullptr) reel = risk.string()->reel();
  if (!reel) return space;
  space.allowed =
      computeReach(risk.map(), space.allowed, *reel, {.threads = options.threads}, progress)
          .straight;
  space.name = "in the space that a straight tether reaches";
  return space;
}

/// The start, then the goal or the rewards.
std::vector<CellIndex> wantedCells(const PlanProblem& problem, const PlanOptions& options,
                                   const Space& space) {
  std::vector<CellIndex> targets;
  if (options.goal) {
    targets = {*options.goal};
  } else {
    for (std::size_t i = 0; i < problem.reward.size(); ++i) {
      if (problem.reward[i] > 0.0 && space.allowed[i] != 0) {
        targets.push_back(static_cast<CellIndex>(i));
      }
    }
    std::stable_sort(targets.begin(), targets.end(), [&](CellIndex a, CellIndex b) {
      return problem.reward[static_cast<std::size_t>(a)] >
             problem.reward[static_cast<std::size_t>(b)];
    });
    targets.resize(std::min(targets.size(), kTargets));
  }
  std::vector<CellIndex> wanted{problem.start};
  for (const CellIndex target : targets) {
    if (target != problem.start) wanted.push_back(target);
  }
  return wanted;
}

std::vector<CellIndex> wayTo(const Roadmap& roadmap, const Roadmap::Tree& tree, std::size_t i) {
  std::vector<CellIndex> way{roadmap.milestones[i]};
  for (; tree.from[i] != i; i = tree.from[i]) way.push_back(roadmap.milestones[tree.from[i]]);
  std::reverse(way.begin(), way.end());
  return way;
}

/// Fills the result from the points flown, not from the centres of their cells: a straight leg has
/// no turns.
PlanResult describeFlight(const PlanProblem& problem, const PlanOptions& options, Flight flight) {
  PlanResult result;
  result.path = std::move(flight.cells);
  describePath(problem, options, result);
  result.report = problem.risk->evaluate(flight.points);
  result.utility = utilityOf(problem.reward, result.path, result.report, options.objective);
  return result;
}

PlanResult without(PlanStatus status, std::string text) {
  PlanResult result;
  result.status = status;
  result.text = std::move(text);
  return result;
}

PlanResult Prm::plan(const PlanProblem& problem, const PlanOptions& options,
                     const Progress& progress) const {
  needGoalOrRewards(problem, options);
  const Space space = spaceOf(problem, options, progress);
  const auto outside = [&](CellIndex cell) {
    return space.allowed[static_cast<std::size_t>(cell)] == 0;
  };
  if (progress.cancelled()) return without(PlanStatus::kNone, "cancelled before there was a path");
  if (outside(problem.start)) {
    return without(PlanStatus::kUnreachable, std::string("the start is not ") + space.name);
  }
  if (options.goal && outside(*options.goal)) {
    return without(PlanStatus::kUnreachable, std::string("the goal is not ") + space.name);
  }

  const std::vector<CellIndex> wanted = wantedCells(problem, options, space);
  RoadmapSettings settings;
  settings.seed = options.seed;
  settings.connected = options.goal ? wanted.size() : 0;
  const Roadmap roadmap =
      growRoadmap(problem.lattice->shape(), space.allowed, wanted, settings, progress);

  std::optional<PlanResult> best;
  const auto consider = [&](const std::vector<CellIndex>& milestones) {
    PlanResult candidate =
        describeFlight(problem, options, flightAlong(problem.risk->map(), milestones));
    if (candidate.report.risk > options.risk_cap || !std::isfinite(candidate.report.cost)) return;
    if (!best || candidate.utility > best->utility) best = std::move(candidate);
  };
  if (!options.goal || *options.goal == problem.start) consider({problem.start});
  const std::size_t root = roadmap.indexOf(problem.start);
  if (root < roadmap.milestones.size()) {
    const Roadmap::Tree tree = roadmap.shortestFrom(root);
    for (std::size_t k = 1; k < wanted.size(); ++k) {
      const std::size_t i = roadmap.indexOf(wanted[k]);
      if (i == roadmap.milestones.size() || !std::isfinite(tree.length[i])) continue;
      consider(wayTo(roadmap, tree, i));
      if (progress.cancelled()) break;
    }
  }
  const std::string roadmap_text =
      "roadmap of " + std::to_string(roadmap.milestones.size()) + " milestones " + space.name;
  if (!best) {
    const bool cut = progress.cancelled();
    return without(cut ? PlanStatus::kNone : PlanStatus::kUnreachable,
                   cut ? "cancelled before there was a path"
                       : "no path within the risk cap on a " + roadmap_text);
  }
  best->status = progress.cancelled() ? PlanStatus::kCut : PlanStatus::kFeasible;
  best->text = "shortest way on a " + roadmap_text + ", risk looked at afterwards";
  best->expanded = static_cast<std::int64_t>(roadmap.milestones.size());
  return *std::move(best);
}

}  // namespace

std::unique_ptr<Planner> makePrm() { return std::make_unique<Prm>(); }

}  // namespace tautline::planning
