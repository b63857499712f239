#include "planning_offline/examples/test/example.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "common/error.h"
#include "common/toml/config_file.h"
#include "planning_offline/field/free_space.h"
#include "planning_offline/field/map_fields.h"
#include "planning_offline/map/load_map.h"
#include "planning_offline/risk/risk_params.h"
#include "planning_offline/tether/taut_string.h"

namespace tautline::planning {
namespace {

std::string config(const std::string& file) {
  return std::string(TAUTLINE_SOURCE_DIR) + "/config/" + file;
}

}  // namespace

Example loadExample(const std::string& map, const std::string& params, Connectivity connectivity) {
  const Progress progress;
  Example example;
  example.map = std::make_shared<const VoxelMap>(loadMap(config(map), {}));
  example.lattice = std::make_unique<Lattice>(example.map->shape, connectivity,
                                              freeSpace(*example.map, {}, progress));
  const auto risk = loadConfig<RiskParams>(config(params));
  std::shared_ptr<TautString> string;
  if (example.map->reel) string = makeTautString(*example.map, *example.map->reel);
  example.risk = std::make_unique<RiskModel>(
      example.map, computeFields(*example.map, neededFields(risk, *example.map), progress), risk,
      std::move(string));
  return example;
}

CellIndex Example::cellAt(const Eigen::Vector3d& p) const {
  const CellIndex cell = map->indexAt(p);
  TAUTLINE_CHECK(cell != kNoCell && lattice->free(cell));
  return cell;
}

PlanProblem Example::problem(std::optional<Eigen::Vector3d> start) const {
  if (!start) start = map->start;
  TAUTLINE_CHECK(start.has_value());
  PlanProblem problem;
  problem.lattice = lattice.get();
  problem.risk = risk.get();
  problem.start = cellAt(*start);
  if (!map->rewards.empty()) problem.reward.assign(map->shape.size(), 0.0);
  for (const Reward& reward : map->rewards) {
    problem.reward[static_cast<std::size_t>(cellAt(reward.position))] += reward.value;
  }
  return problem;
}

PlanResult Example::planTo(const char* planner, const Eigen::Vector3d& goal) const {
  PlanOptions options;
  options.goal = cellAt(goal);
  return solve(planner, problem(), options, Progress{});
}

std::vector<Eigen::Vector3d> pointsOf(const Example& example, const std::vector<CellIndex>& path) {
  std::vector<Eigen::Vector3d> points;
  std::transform(path.begin(), path.end(), std::back_inserter(points),
                 [&](CellIndex cell) { return example.map->centre(cell); });
  return points;
}

}  // namespace tautline::planning
