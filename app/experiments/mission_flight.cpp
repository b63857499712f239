#include "app/experiments/mission_flight.h"

#include <algorithm>
#include <chrono>

namespace tautline::experiments {
namespace {

constexpr Duration kStartLimit = std::chrono::minutes(2);  // to arm and take off
constexpr Duration kLimit = std::chrono::minutes(30);      // of the mission
constexpr Duration kPatience = std::chrono::seconds(60);   // for the next waypoint
constexpr Duration kHover = std::chrono::seconds(5);  // at the last waypoint, before it is judged
constexpr Duration kSample = std::chrono::milliseconds(100);
constexpr ConditionSet kLost{Condition::kLocalizationLost, Condition::kUnplannedContact,
                             Condition::kContactLost, Condition::kContactNotFormed};
constexpr ConditionSet kNeverThere{Condition::kMissionFailed, Condition::kOscillation};

/// Flies on until the mission is left, whatever the reason.
class Follower {
 public:
  Follower(bench::Lockstep& bench, FlightTrack* track) : bench_(bench), track_(track) {}

  void fly(Time end) {
    progress_ = bench_.now();
    while (bench_.output().supervision.mode == Mode::kAuto && !bench_.truth().crashed &&
           bench_.now() < end && !facts_.stood_still && !facts_.grounded) {
      look();
      bench_.step();
    }
    look();
    const StepOutput& out = bench_.output();
    facts_.completed = out.mission.state == MissionState::kCompleted;
    facts_.conditions = out.supervision.reasons | out.conditions;
    reasons_ = out.supervision.mode == Mode::kAuto ? ConditionSet{} : out.supervision.reasons;
    if (facts_.completed) hover();
  }

  [[nodiscard]] FlightFacts facts() const { return facts_; }
  [[nodiscard]] ConditionSet reasons() const { return reasons_; }
  [[nodiscard]] int waypoint() const { return waypoint_; }

 private:
  /// The last waypoint counts as reached from some way off; the flight is judged where it hovers.
  void hover() {
    for (const Time end = bench_.now() + kHover; bench_.now() < end && !bench_.truth().crashed;) {
      bench_.step();
      look();
    }
  }
  void look() {
    const sim::Truth& truth = bench_.truth();
    const ExecutorStatus& mission = bench_.output().mission;
    if (mission.waypoint != waypoint_ || mission.state == MissionState::kHolding ||
        mission.state == MissionState::kCompleted) {
      waypoint_ = mission.waypoint;
      progress_ = bench_.now();
    }
    facts_.stood_still = bench_.now() - progress_ > kPatience;
    facts_.contact = facts_.contact || truth.contact_count > 0;
    facts_.grounded = facts_.grounded || truth.on_ground;
    if (track_ == nullptr || bench_.now() < next_sample_) return;
    next_sample_ = bench_.now() + kSample;
    track_->push_back(truth.p_WD);
  }

  bench::Lockstep& bench_;
  FlightTrack* track_;
  FlightFacts facts_;
  ConditionSet reasons_;
  int waypoint_{0};
  Time progress_{};
  Time next_sample_{};
};

}  // namespace

FlightEnd judge(const FlightFacts& facts, double goal_tolerance) noexcept {
  switch (facts.crash) {
    case sim::CrashReason::kObstacle:
      return FlightEnd::kObstacle;
    case sim::CrashReason::kRoom:
    case sim::CrashReason::kHardLanding:
      return FlightEnd::kRoom;
    case sim::CrashReason::kNone:
      break;
  }
  if (!facts.began) return FlightEnd::kNotStarted;
  if (facts.grounded) return FlightEnd::kRoom;
  if (facts.completed && facts.goal_distance <= goal_tolerance) return FlightEnd::kFinished;
  const bool lost = facts.error > kGoalTolerance || facts.conditions.any(kLost);
  if (facts.contact && lost) return FlightEnd::kContactLost;
  if (facts.completed) return FlightEnd::kMissed;
  if (facts.stood_still || facts.conditions.any(kNeverThere)) return FlightEnd::kOscillation;
  return FlightEnd::kAborted;
}

FlightVerdict flyPlanned(const bench::LockstepConfig& config, const MissionPlan& mission,
                         double goal_tolerance, FlightTrack* track) {
  bench::Lockstep bench(config, nullptr);
  const bench::MissionStart start = bench::beginMission(bench, mission, bench.now() + kStartLimit);
  Follower follower(bench, track);
  if (start.navigating) follower.fly(bench.now() + kLimit);
  const Eigen::Vector3d goal =
      mission.waypoints[static_cast<std::size_t>(mission.waypoint_count - 1)].p_WD;
  FlightVerdict verdict;
  verdict.waypoint = follower.waypoint();
  verdict.p_WD = bench.truth().p_WD;
  verdict.error = (bench.output().estimate.p_WD - verdict.p_WD).norm();
  verdict.seconds = toSeconds(bench.now() - Time{});
  verdict.why = describe(start.navigating ? follower.reasons()
                                          : bench.output().supervision.refusal |
                                                bench.output().supervision.reasons);
  FlightFacts facts = follower.facts();
  facts.began = start.navigating;
  facts.crash = bench.truth().crash_reason;
  facts.goal_distance = (verdict.p_WD - goal).norm();
  facts.error = verdict.error;
  verdict.end = judge(facts, goal_tolerance);
  return verdict;
}

nlohmann::json toJson(const FlightVerdict& v) {
  return {{"end", nameOf(v.end, kFlightEndNames)},
          {"waypoint", v.waypoint},
          {"position_m", {v.p_WD.x(), v.p_WD.y(), v.p_WD.z()}},
          {"error_m", v.error},
          {"flight_s", v.seconds},
          {"why", v.why}};
}

FlightVerdict verdictFrom(const nlohmann::json& json) {
  FlightVerdict v;
  const std::string end = json.at("end");
  for (const auto& name : kFlightEndNames)
    if (end == name.name) v.end = name.value;
  v.waypoint = json.at("waypoint");
  const auto& p = json.at("position_m");
  v.p_WD = Eigen::Vector3d(p.at(0), p.at(1), p.at(2));
  v.error = json.at("error_m");
  v.seconds = json.at("flight_s");
  v.why = json.at("why");
  return v;
}

}  // namespace tautline::experiments
