#include "app/experiments/planned_path.h"

#include <optional>

#include <fmt/format.h>

#include "common/error.h"
#include "planning_offline/cli/mission_output.h"
#include "planning_offline/cli/path_file.h"
#include "planning_offline/cli/plan_output.h"
#include "planning_offline/planner/planner.h"

namespace tautline::experiments {

using namespace planning;

namespace {
constexpr double kSameReel = 1e-3;  // [m]
}

Prediction predict(const RiskModel& risk, const std::vector<Eigen::Vector3d>& points) {
  const RiskReport report = risk.evaluate(points);
  Prediction prediction;
  prediction.risk = report.risk;
  prediction.element_cost = report.element_cost;
  for (const StateRisk& state : report.states) {
    for (std::size_t k = 0; k < kRiskElements; ++k) {
      if (depthOf(static_cast<RiskElement>(k)) == RiskDepth::kLocale)
        prediction.additive += state.elements[k];
    }
  }
  return prediction;
}

Prediction predictMission(const RiskSpace& space, const std::string& file) {
  PathFileOptions options;
  options.reel = space.space.map->reel;
  options.states_only = true;
  const GivenPath path = readPath(file, options);
  const std::optional<Eigen::Vector3d>& reel = space.space.map->reel;
  if (path.reel && reel && (*path.reel - *reel).norm() > kSameReel) {
    throw InputError({.file = file,
                      .key = "reel_position_m",
                      .problem = fmt::format("is {}", pointText(*path.reel)),
                      .allowed = fmt::format("{}, the reel of the map {}", pointText(*reel),
                                             space.space.map->name),
                      .remedy = "use the map that the mission was planned in, or --reel"});
  }
  needFreeWay(path.points, space.space, file);
  return predict(*space.risk, path.points);
}

PlannedPath planPath(const RiskSpace& space, const std::string& planner,
                     const Eigen::Vector3d& start, const Eigen::Vector3d& goal) {
  const VoxelMap& map = *space.space.map;
  PlanProblem problem;
  problem.lattice = space.space.lattice.get();
  problem.risk = space.risk.get();
  problem.start = map.indexAt(start);
  PlanOptions options;
  options.goal = map.indexAt(goal);
  options.threads = 1;
  const PlanResult result = solve(planner, problem, options, Progress{});
  PlannedPath path;
  if (!result) return path;
  std::vector<Waypoint> orders(result.report.states.size());
  for (std::size_t i = 0; i < orders.size(); ++i) {
    orders[i].risk = result.report.states[i].risk;
    path.points.push_back(result.report.states[i].position);
  }
  path.mission = missionOf(contactsOf(result.report, map, {.frictionless = false}), orders, map,
                           fmt::format("{} by {}", map.name, planner),
                           std::filesystem::path(map.file).replace_extension(".mission.toml"));
  path.mission.plan->hash = missionHash(path.mission);
  path.prediction = predict(*space.risk, path.points);
  return path;
}

}  // namespace tautline::experiments
