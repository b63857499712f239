#include "app/experiments/truth_paths.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "app/experiments/cluttered_map.h"
#include "app/experiments/map_world.h"

namespace tautline::experiments {
namespace {

using planning::RiskElement;

constexpr int kLevels = 8;        // of clutter
constexpr int kFewestThings = 4;  // in the room of the first level
constexpr int kThingsALevel = 4;  // more in each further one
constexpr double kFar = 2.0;      // of a goal from the start [m]

std::uint32_t roomSeed(int map, std::uint64_t seed) {
  return static_cast<std::uint32_t>(seed * 1000) + static_cast<std::uint32_t>(map);
}

}  // namespace

std::string TruthCase::name() const {
  return fmt::format("room {} goal {} {}", map, goal, planner);
}

std::vector<TruthCase> truthCases(const TruthOptions& options) {
  std::vector<TruthCase> cases;
  for (int map = 0; map < options.maps; ++map) {
    for (int goal = 0; goal < options.goals; ++goal) {
      for (const char* planner : kTruthPlanners) cases.push_back({map, goal, planner});
    }
  }
  return cases;
}

planning::RiskSpace truthSpace(int map, std::uint64_t seed, const planning::RiskParams& params) {
  const int things = kFewestThings + kThingsALevel * (map % kLevels);
  return riskSpaceOf(clutteredMap(things, roomSeed(map, seed)), params);
}

std::int64_t TruthPath::flights() const noexcept {
  return std::accumulate(ends.begin(), ends.end(), std::int64_t{0}) -
         ends[static_cast<std::size_t>(FlightEnd::kNotStarted)];
}

std::int64_t TruthPath::failed() const noexcept {
  return flights() - ends[static_cast<std::size_t>(FlightEnd::kFinished)];
}

nlohmann::json toJson(const TruthPath& path) {
  nlohmann::json points = nlohmann::json::array();
  for (const Eigen::Vector3d& p : path.points) points.push_back({p.x(), p.y(), p.z()});
  return {{"map", path.map},
          {"planner", path.planner},
          {"points", points},
          {"risk", path.prediction.risk},
          {"additive", path.prediction.additive},
          {"element_cost", path.prediction.element_cost},
          {"ends", path.ends}};
}

TruthPath truthPathFrom(const nlohmann::json& json) {
  TruthPath path;
  path.map = json.at("map");
  path.planner = json.at("planner");
  for (const auto& p : json.at("points")) path.points.emplace_back(p.at(0), p.at(1), p.at(2));
  path.prediction.risk = json.at("risk");
  path.prediction.additive = json.at("additive");
  json.at("element_cost").get_to(path.prediction.element_cost);
  json.at("ends").get_to(path.ends);
  return path;
}

TruthPath flyTruthCase(const TruthCase& c, const TruthOptions& options,
                       const planning::RiskParams& params, const CampaignFlight& who) {
  TruthPath result{.map = c.map, .planner = c.planner};
  const planning::RiskSpace space = truthSpace(c.map, options.seed, params);
  const planning::VoxelMap& map = *space.space.map;
  const std::vector<Eigen::Vector3d> goals =
      goalsIn(space, static_cast<std::size_t>(options.goals), kFar, roomSeed(c.map, options.seed));
  if (static_cast<std::size_t>(c.goal) >= goals.size()) return result;
  const PlannedPath path =
      planPath(space, c.planner, *map.start, goals[static_cast<std::size_t>(c.goal)]);
  if (!path.found()) return result;
  result.points = path.points;
  result.prediction = path.prediction;
  CampaignFlight flight = who;
  flight.mission = &path.mission;
  flight.world = worldOf(map, *map.reel, *path.mission.plan, who.plant.vehicle.radius);
  // A seed is a machine: other ones for every goal, the same for both planners and both stations.
  const std::int64_t first = (std::int64_t{c.map} * options.goals + c.goal) * options.flights;
  for (std::int64_t i = 0; i < options.flights; ++i) {
    const FlightVerdict verdict =
        flyPlanned(flight.config(options.seed + static_cast<std::uint64_t>(first + i)),
                   *path.mission.plan, flight.goal_tolerance);
    ++result.ends[static_cast<std::size_t>(verdict.end)];
  }
  return result;
}

std::vector<RiskElement> elementsOf(const std::vector<TruthPath>& paths) {
  std::vector<RiskElement> elements;
  for (std::size_t k = 0; k < planning::kRiskElements; ++k) {
    const auto has = [&](const TruthPath& p) { return p.prediction.element_cost[k] > 0.0; };
    if (std::any_of(paths.begin(), paths.end(), has))
      elements.push_back(static_cast<RiskElement>(k));
  }
  return elements;
}

std::vector<CostOutcome> outcomesOf(const std::vector<TruthPath>& paths,
                                    const std::vector<RiskElement>& elements) {
  std::vector<CostOutcome> rows;
  for (const TruthPath& p : paths) {
    Eigen::VectorXd cost(static_cast<Eigen::Index>(elements.size()));
    for (std::size_t k = 0; k < elements.size(); ++k)
      cost[static_cast<Eigen::Index>(k)] =
          p.prediction.element_cost[static_cast<std::size_t>(elements[k])];
    rows.push_back({std::move(cost), p.failed(), p.flights()});
  }
  return rows;
}

std::vector<CostOutcome> additiveOutcomes(const std::vector<TruthPath>& paths) {
  std::vector<CostOutcome> rows;
  for (const TruthPath& p : paths)
    rows.push_back({Eigen::VectorXd::Constant(1, p.prediction.additive), p.failed(), p.flights()});
  return rows;
}

std::array<Measure, kMeasures> measure(const std::vector<TruthPath>& seen,
                                       const std::vector<TruthPath>& judged) {
  const std::vector<RiskElement> elements = elementsOf(seen);
  const std::vector<CostOutcome> costs = outcomesOf(seen, elements);
  const double index_scale = fitScale(costs);
  const double additive_scale = fitScale(additiveOutcomes(seen));
  const Eigen::VectorXd factors = fitFactors(costs);
  double failed = 0.0;
  double flights = 0.0;
  for (const TruthPath& p : seen) {
    failed += static_cast<double>(p.failed());
    flights += static_cast<double>(p.flights());
  }
  std::array<Measure, kMeasures> all{{{"risk index", {}},
                                      {"additive", {}},
                                      {"risk index, one factor", {}},
                                      {"additive, one factor", {}},
                                      {"risk index, a factor for each element", {}},
                                      {"base rate", {}}}};
  const std::vector<CostOutcome> rows = outcomesOf(judged, elements);
  for (std::size_t i = 0; i < judged.size(); ++i) {
    const TruthPath& p = judged[i];
    const auto add = [&](MeasureIndex m, double predicted) {
      all[m].forecasts.push_back(p.forecast(predicted));
    };
    add(kIndex, p.prediction.risk);
    add(kAdditive, p.prediction.additiveRisk());
    add(kIndexScaled, -std::expm1(-index_scale * rows[i].cost.sum()));
    add(kAdditiveScaled, -std::expm1(-additive_scale * p.prediction.additive));
    add(kIndexFitted, riskWith(factors, rows[i].cost));
    add(kBaseRate, failed / flights);
  }
  return all;
}

bool canFit(const std::vector<TruthPath>& paths) {
  std::int64_t failed = 0;
  std::int64_t flights = 0;
  for (const TruthPath& p : paths) {
    failed += p.failed();
    flights += p.flights();
  }
  return failed > 0 && failed < flights;
}

Halves halve(const std::vector<TruthPath>& paths) {
  Halves halves;
  for (const TruthPath& p : paths) {
    if (p.flights() > 0) (p.map % 2 == 0 ? halves.even : halves.odd).push_back(p);
  }
  return halves;
}

}  // namespace tautline::experiments
