#include "control/test/flight.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "control/segment.h"

namespace tautline::testing {
namespace {

double distanceTo(const Path& path, const Eigen::Vector3d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < path.size(); ++i) {
    least = std::min(least, projectOnSegment(p, path[i - 1], path[i]).cross_track);
  }
  return least;
}

}  // namespace

Path path1() { return {{-1.5, 1.0, 1.5}, {1.5, 1.0, 1.5}, {1.5, 1.9, -1.5}}; }

Path path2() { return {{1.5, 1.5, 1.5}, {-1.5, 1.5, -1.5}}; }

Path densify(const Path& corners, double interval) {
  Path out{corners.front()};
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const Eigen::Vector3d piece = corners[i] - corners[i - 1];
    const int n = static_cast<int>(std::ceil(piece.cwiseAbs().maxCoeff() / interval - 1e-9));
    for (int k = 1; k <= n; ++k) {
      out.emplace_back(corners[i - 1] +
                       piece * std::min(1.0, k * interval / piece.cwiseAbs().maxCoeff()));
    }
  }
  return out;
}

FlightRecord fly(const FlightPlan& plan) {
  const auto mission = std::make_unique<MissionPlan>();
  mission->waypoint_count = static_cast<int>(plan.waypoints.size());
  for (std::size_t i = 0; i < plan.waypoints.size(); ++i) {
    mission->waypoints[i].p_WD = plan.waypoints[i];
    mission->waypoints[i].speed = plan.speed;
    mission->waypoints[i].contact = plan.p_WC.isZero() ? kReelContact : 1;
  }
  mission->contact_count = 1;
  mission->contacts[0] = {.id = 1, .p_WC = plan.p_WC};
  const std::unique_ptr<Controller> configured = makeController(plan.control);
  Controller* const law = plan.other_law != nullptr ? plan.other_law : configured.get();
  ContactStack contacts;
  MotionExecutor executor(plan.executor, plan.control.composite.pole, plan.plant.limits, contacts);
  PlantConfig plant_config = plan.plant;
  plant_config.p_WA = plan.p_WC;
  KinematicPlant plant(plant_config, plan.waypoints.front(), plan.seed);
  const Duration dt = fromSeconds(kPlantStep);

  FlightRecord out;
  int steps = 0;
  executor.start(*mission, plant.measure());
  for (; steps * kPlantStep < plan.time_limit; ++steps) {
    const ExecutorOutput target = executor.update(dt, {.estimate = plant.measure()});
    const MissionState state = executor.status().state;
    if (state == MissionState::kCompleted || state == MissionState::kFailed) break;
    plant.step(law->update(dt, target.control));
    const double error = distanceTo(plan.waypoints, plant.position());
    out.mean_error += error;
    out.max_error = std::max(out.max_error, error);
    if (axisDistance(plant.position() - plan.p_WC) < 0.35) out.near_axis += kPlantStep;
  }
  out.finished = executor.status().state == MissionState::kCompleted;
  out.failure = executor.status().failure;
  out.time = steps * kPlantStep;
  out.mean_error /= std::max(1, steps);
  return out;
}

ExecutorConfig publishedExecutor(double acceptance) {
  ExecutorConfig out;
  out.acceptance_floor_m = acceptance;
  out.acceptance_ceiling_m = acceptance;
  out.pass_by_progress = false;
  out.progress_time_s = 3600.0;
  out.timeout_constant_s = 3600.0;
  return out;
}

}  // namespace tautline::testing
