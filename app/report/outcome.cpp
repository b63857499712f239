#include "app/report/outcome.h"

#include <algorithm>

namespace tautline::report {
namespace {

// What the executor said while it flew the mission: in AUTO, or in HOLD, where a mission ends or is
// interrupted. Take-off and landing are its work too, and the way back undoes the mission's legs
// under the mission's hash.
std::vector<MissionSample> ofMissions(const FlightLog& log) {
  std::vector<MissionSample> out;
  for (const auto& m : log.mission) {
    if (m.hash == 0 || m.state == MissionState::kIdle) continue;
    const auto after = std::upper_bound(log.states.begin(), log.states.end(), m.t,
                                        [](double t, const StateSample& s) { return t < s.t; });
    const bool known = after != log.states.begin();
    const Mode mode = known ? (after - 1)->mode : Mode::kAuto;
    if (mode == Mode::kAuto || mode == Mode::kHold) out.push_back(m);
  }
  return out;
}

std::optional<double> touchdownSpeed(const std::vector<TruthSample>& truth) {
  std::optional<double> speed;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    if (truth[i].on_ground && !truth[i - 1].on_ground) speed = truth[i - 1].v_WD.norm();
  }
  return speed;
}

// What came after the last AUTO.
std::string interruption(const std::vector<ModeSpan>& modes) {
  const auto last = std::find_if(modes.rbegin(), modes.rend(),
                                 [](const ModeSpan& m) { return m.mode == Mode::kAuto; });
  if (last == modes.rend() || last == modes.rbegin()) return {};
  const ModeSpan& next = *(last - 1);
  const std::string reasons = describe(next.reasons);
  return nameOf(next.mode, kModeNames) + (reasons.empty() ? " by the operator" : " for " + reasons);
}

std::string outcomeText(const Outcome& o) {
  std::string text;
  if (o.mission_completed) {
    text = "Mission completed";
  } else if (o.mission_state == MissionState::kIdle) {
    text = "No mission flown";
  } else {
    std::string why = nameOf(o.mission_state, kMissionStateNames);
    if (o.mission_failure != MissionFailure::kNone)
      why += std::string(": ") + nameOf(o.mission_failure, kMissionFailureNames);
    if (!o.interruption.empty()) why += ", then " + o.interruption;
    text = "Mission not completed (" + why + "), " + std::to_string(o.waypoints_reached) + " of " +
           std::to_string(o.waypoint_count) + " waypoints reached";
  }
  if (!o.flew) return text + "; never left the ground.";
  if (o.crashed) return text + "; crashed.";
  return text + (o.landed ? "; landed." : "; not landed.");
}

}  // namespace

bool isAirborne(VehiclePhase phase) {
  return phase == VehiclePhase::kFlying || phase == VehiclePhase::kLanding;
}

std::vector<MissionSample> ofLastMission(const FlightLog& log) {
  std::vector<MissionSample> out = ofMissions(log);
  if (out.empty()) return out;
  std::erase_if(out, [hash = out.back().hash](const MissionSample& m) { return m.hash != hash; });
  return out;
}

Outcome findOutcome(const FlightLog& log, const std::vector<MissionSample>& mission,
                    const std::vector<ModeSpan>& modes) {
  Outcome out;
  for (const auto& m : mission) {
    out.waypoint_count = std::max(out.waypoint_count, m.waypoint_count);
    out.waypoints_reached = std::max(out.waypoints_reached, m.waypoint);
    out.mission_completed = out.mission_completed || m.state == MissionState::kCompleted;
    out.mission_state = m.state;
    out.mission_failure = m.failure;
  }
  if (out.mission_completed) out.waypoints_reached = out.waypoint_count;

  const bool vehicle_flew = std::any_of(log.vehicle.begin(), log.vehicle.end(),
                                        [](const auto& v) { return isAirborne(v.phase); });
  const bool truth_flew =
      std::any_of(log.truth.begin(), log.truth.end(), [](const auto& s) { return !s.on_ground; });
  out.flew = log.truth.empty() ? vehicle_flew : truth_flew;
  out.touchdown_speed = touchdownSpeed(log.truth);
  out.crashed =
      std::any_of(log.truth.begin(), log.truth.end(), [](const auto& s) { return s.crashed; });
  const bool vehicle_down = log.vehicle.empty() ||
                            log.vehicle.back().phase == VehiclePhase::kIdle ||
                            log.vehicle.back().phase == VehiclePhase::kStopped;
  const bool truth_down = log.truth.empty() || (log.truth.back().on_ground &&
                                                !log.truth.back().motors_on && !out.crashed);
  out.landed = out.flew && vehicle_down && truth_down;
  if (!out.mission_completed && !mission.empty()) out.interruption = interruption(modes);
  out.text = outcomeText(out);
  return out;
}

}  // namespace tautline::report
