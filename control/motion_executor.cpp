#include "control/motion_executor.h"

#include <algorithm>
#include <cmath>

#include "control/segment.h"

namespace tautline {
namespace {

bool isUsable(const Estimate& estimate) noexcept {
  return estimate.valid && estimate.health != EstimateHealth::kLost && estimate.p_WD.allFinite();
}

}  // namespace

MotionExecutor::MotionExecutor(const ExecutorConfig& config, const PoleConfig& pole,
                               const VehicleLimits& limits, ContactStack& contacts) noexcept
    : config_(config), limits_(limits), pole_(poleCylinder(pole, limits)), contacts_(contacts) {}

// Requests ---------------------------------------------------------------------------------------

bool MotionExecutor::start(const MissionPlan& plan, const Estimate& estimate) noexcept {
  return begin(Route::along(plan), estimate);
}

bool MotionExecutor::goTo(const PointTarget& target, const Estimate& estimate) noexcept {
  return target.p_WD.allFinite() && begin(Route::to(target), estimate);
}

bool MotionExecutor::goBack(const FlownPath& path, double distance, double speed,
                            const Estimate& estimate) noexcept {
  return begin(Route::back(path, estimate.p_WD, distance, speed), estimate);
}

bool MotionExecutor::pause() noexcept {
  was_holding_ = status_.state == MissionState::kHolding;
  if (!was_holding_ && status_.state != MissionState::kRunning) return false;
  holdAt(MissionState::kPaused, was_holding_ ? leg_.p_WD : p_WD_);
  return true;
}

bool MotionExecutor::resume() noexcept {
  if (status_.state != MissionState::kPaused) return false;
  if (was_holding_) {
    holdAt(MissionState::kHolding, leg_.p_WD);
  } else {
    flyLegFrom(p_WD_);
  }
  return true;
}

bool MotionExecutor::skip() noexcept {
  const MissionState state = status_.state;
  if (state != MissionState::kRunning && state != MissionState::kHolding &&
      state != MissionState::kPaused) {
    return false;
  }
  const std::optional<Leg> next = nextLeg();
  if (next && next->contact && *next->contact != contacts_.activeId()) return false;
  if (next) {
    beginLeg(index_ + 1, p_WD_);
  } else {
    holdAt(MissionState::kCompleted, p_WD_);
  }
  return true;
}

void MotionExecutor::abort() noexcept {
  status_ = ExecutorStatus{};  // idle: route and leg are not looked at again
}

// Legs -------------------------------------------------------------------------------------------

bool MotionExecutor::begin(const Route& route, const Estimate& estimate) noexcept {
  if (route.count() == 0 || !isUsable(estimate)) return false;
  route_ = route;
  p_WD_ = estimate.p_WD;
  status_ = ExecutorStatus{};
  status_.waypoint_count = route.count();
  if (route.plan() != nullptr) status_.mission_hash = route.plan()->hash;
  beginLeg(0, p_WD_);
  describe(estimate);
  return true;
}

void MotionExecutor::beginLeg(int index, Eigen::Vector3d p_WS) noexcept {
  index_ = index;
  const ContactStack::Change change = route_.select(index, contacts_);
  leg_ = route_.leg(index);
  flyLegFrom(p_WS);
  if (change == ContactStack::Change::kUnknownId || change == ContactStack::Change::kFull ||
      change == ContactStack::Change::kBadPoint) {
    fail(MissionFailure::kBadContact);
  }
}

void MotionExecutor::flyLegFrom(const Eigen::Vector3d& p_WS) noexcept {
  held_ = Duration(0);
  since_best_ = Duration(0);
  unreachable_for_ = Duration(0);
  status_.state = MissionState::kRunning;
  status_.waypoint = leg_.waypoint;
  status_.p_WTarget = leg_.p_WD;
  status_.p_WSegmentStart = p_WS;
  status_.time_on_waypoint = Duration(0);
  best_ = (leg_.p_WD - p_WD_).norm();

  // Written so that a target that is not finite fails, too.
  if (!(contacts_.effective(leg_.p_WD).L_total <= limits_.tether_length_m)) {
    fail(MissionFailure::kUnreachable);
  }
}

void MotionExecutor::advance() noexcept {
  if (nextLeg()) {
    beginLeg(index_ + 1, leg_.p_WD);
  } else {
    holdAt(MissionState::kCompleted, leg_.p_WD);
  }
}

void MotionExecutor::holdAt(MissionState state, const Eigen::Vector3d& p_WD) noexcept {
  status_.state = state;
  p_WHold_ = p_WD;
}

void MotionExecutor::fail(MissionFailure failure) noexcept {
  status_.failure = failure;
  holdAt(MissionState::kFailed, p_WD_);
}

std::optional<Leg> MotionExecutor::nextLeg() const noexcept {
  if (index_ + 1 >= route_.count()) return std::nullopt;
  return route_.leg(index_ + 1);
}

double MotionExecutor::speed() const noexcept {
  return leg_.speed > 0.0 ? leg_.speed : config_.speed_mps;
}

// One cycle --------------------------------------------------------------------------------------

ExecutorOutput MotionExecutor::update(Duration dt, const ExecutorInput& in) noexcept {
  const Duration step = std::max(dt, Duration(0));
  const bool usable = isUsable(in.estimate);
  if (usable) p_WD_ = in.estimate.p_WD;
  describe(in.estimate);

  if (status_.state == MissionState::kRunning) {
    status_.time_on_waypoint += step;
    if (usable) fly(step, in.estimate.T);
  } else if (status_.state == MissionState::kHolding) {
    status_.time_on_waypoint += step;
    held_ += step;
    if (held_ >= fromSeconds(leg_.hold)) advance();
  }
  describe(in.estimate);

  ExecutorOutput out;
  if (status_.state == MissionState::kIdle) return out;
  out.active = true;
  out.control.estimate = in.estimate;
  out.control.anchor = contacts_.anchor();
  out.control.speed = speed();
  out.control.limits = limits_;
  if (status_.state == MissionState::kRunning) {
    out.control.p_WS = status_.p_WSegmentStart;
    out.control.p_WE = leg_.p_WD;
    const std::optional<Leg> next = nextLeg();
    if (next && leg_.hold <= 0.0) out.control.p_WN = next->p_WD;
  } else {
    out.control.p_WS = p_WHold_;
    out.control.p_WE = p_WHold_;
  }
  if (leg_.p_WL && usable && status_.state != MissionState::kFailed) {
    const LookAtRates turn =
        lookAt(config_.look_at, limits_, p_WD_, *leg_.p_WL, in.R_WB, in.gimbal_pitch);
    out.yaw_rate = turn.yaw_rate;
    out.gimbal_pitch_rate = turn.gimbal_pitch_rate;
  }
  return out;
}

void MotionExecutor::fly(Duration dt, double T) noexcept {
  if (arrived()) {
    if (leg_.hold > 0.0) {
      holdAt(MissionState::kHolding, leg_.p_WD);
    } else {
      advance();
    }
    return;
  }
  const MissionFailure failure = failureAfter(dt, T);
  if (failure != MissionFailure::kNone) fail(failure);
}

bool MotionExecutor::endsNearPole() const noexcept {
  return axisDistance(leg_.p_WD - contacts_.anchor().p_WA) < pole_.outer_radius;
}

bool MotionExecutor::arrived() const noexcept {
  const SegmentProgress here = projectOnSegment(p_WD_, status_.p_WSegmentStart, leg_.p_WD);
  const double radius = status_.acceptance_radius;
  const bool close = (leg_.p_WD - p_WD_).norm() <= radius;
  const std::optional<Leg> next = nextLeg();
  const bool on_the_way = config_.pass_by_progress && next && leg_.hold <= 0.0;
  const bool beyond = here.along >= here.length;

  if (endsNearPole()) {
    // Where no law can go exactly, closeness says nothing: on the way only progress counts. To stop
    // there, every azimuth of the cylinder is as good as any other.
    if (on_the_way) {
      return beyond && here.off_line <= std::max(config_.corridor_m, pole_.outer_radius);
    }
    const Eigen::Vector3d p_AD = p_WD_ - contacts_.anchor().p_WA;
    return close || (axisDistance(p_AD) <= pole_.outer_radius &&
                     std::abs(p_WD_.y() - leg_.p_WD.y()) <= radius);
  }
  if (close) return true;
  // A waypoint at which a contact forms or comes off has to be reached, or the tether may not be
  // where the plan has it.
  const bool same_anchor = next && (!next->contact || *next->contact == contacts_.activeId());
  return on_the_way && same_anchor && beyond && here.off_line <= config_.corridor_m;
}

MissionFailure MotionExecutor::failureAfter(Duration dt, double T) noexcept {
  const Eigen::Vector3d& p_WS = status_.p_WSegmentStart;
  const SegmentProgress here = projectOnSegment(p_WD_, p_WS, leg_.p_WD);
  const double left =
      endsNearPole() ? std::abs(here.length - here.along) : (leg_.p_WD - p_WD_).norm();
  since_best_ += dt;
  if (left < best_ - config_.progress_m) {
    best_ = left;
    since_best_ = Duration(0);
  }
  const TetherTarget target = tetherTarget(config_.target, leg_.p_WD - contacts_.anchor().p_WA, T);
  unreachable_for_ = target.reachable ? Duration(0) : unreachable_for_ + dt;

  if (toSeconds(unreachable_for_) > config_.unreachable_time_s) return MissionFailure::kUnreachable;
  if (toSeconds(since_best_) > config_.progress_time_s) return MissionFailure::kNoProgress;
  const double timeout =
      config_.timeout_constant_s + config_.timeout_factor * here.length / speed();
  if (toSeconds(status_.time_on_waypoint) > timeout) return MissionFailure::kWaypointTimeout;
  return MissionFailure::kNone;
}

void MotionExecutor::describe(const Estimate& estimate) noexcept {
  if (status_.state == MissionState::kIdle) return;
  const double sigma = std::sqrt(std::max(0.0, estimate.P_position.trace()));
  status_.acceptance_radius =
      std::min(config_.acceptance_ceiling_m,
               std::max(config_.acceptance_floor_m, config_.acceptance_sigmas * sigma));
  status_.distance = (leg_.p_WD - p_WD_).norm();
  status_.cross_track = projectOnSegment(p_WD_, status_.p_WSegmentStart, leg_.p_WD).cross_track;
  const Anchor anchor = contacts_.anchor();
  const TetherTarget target = tetherTarget(config_.target, leg_.p_WD - anchor.p_WA, estimate.T);
  status_.target_length = anchor.L_static + target.q.L;
  status_.target_elevation = target.q.theta;
  status_.target_azimuth = target.q.phi;
}

}  // namespace tautline
