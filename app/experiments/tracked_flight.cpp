#include "app/experiments/tracked_flight.h"

#include <algorithm>

#include "app/report/series_math.h"
#include "common/error.h"

namespace tautline::experiments {
namespace {

constexpr Duration kSample = std::chrono::milliseconds(50);

}  // namespace

TrackedFlight flyTracked(const bench::LockstepConfig& config, const MissionPlan& mission,
                         Duration limit) {
  bench::Lockstep bench(config, nullptr);
  TrackedFlight flight;
  std::optional<Time> began;
  Time next{};
  const auto follow = [&](const bench::Lockstep& b) {
    const StepOutput& out = b.output();
    if (began && flight.reasons.empty() && !out.supervision.reasons.empty())
      flight.reasons = describe(out.supervision.reasons);
    if (out.supervision.mode != Mode::kAuto) {
      if (began && flight.last_mode == Mode::kAuto) flight.last_mode = out.supervision.mode;
      return;
    }
    flight.last_mode = Mode::kAuto;
    if (!began) began = next = b.now();
    if (b.now() < next) return;
    next += kSample;
    flight.track.push_back({toSeconds(b.now() - *began), b.truth().p_WD, out.estimate.p_WD,
                            out.mission.waypoint, out.anchor.contact_count, b.truth().contact_count,
                            b.truth().p_WA, out.anchor.p_WA});
  };
  flight.result = bench::flyMission(bench, mission, limit, follow);
  return flight;
}

std::unique_ptr<MissionPlan> missionThrough(const std::vector<Eigen::Vector3d>& points,
                                            double final_hold) {
  TAUTLINE_CHECK(!points.empty() && points.size() <= static_cast<std::size_t>(kMaxWaypoints));
  auto plan = std::make_unique<MissionPlan>();
  plan->hash = 1;
  plan->waypoint_count = static_cast<int>(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) plan->waypoints[i].p_WD = points[i];
  plan->waypoints[points.size() - 1].hold = final_hold;
  return plan;
}

double crossTrack(const Eigen::Vector3d& p, const std::vector<Eigen::Vector3d>& polyline) {
  double nearest = (p - polyline.front()).norm();
  for (std::size_t i = 1; i < polyline.size(); ++i)
    nearest = std::min(nearest, report::distanceToSegment(p, polyline[i - 1], polyline[i]));
  return nearest;
}

}  // namespace tautline::experiments
