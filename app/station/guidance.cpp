#include "app/station/guidance.h"

#include "app/station/station_config.h"

namespace tautline {
namespace {

constexpr double kBelowGround =
    0.3;  // [m] the descent aims this far below home, so that it ends on the ground
constexpr double kGroundHeight = 0.3;  // [m] no lower for a while and below this: on the ground
constexpr Duration kNoLowerFor = std::chrono::seconds(2);
constexpr int kGroundedSamples = 2;
constexpr double kSmallestDescent = 0.01;  // [m]

}  // namespace

Guidance::Guidance(const GuidanceConfig& config, const ExecutorConfig& executor,
                   const PoleConfig& pole, const VehicleLimits& limits) noexcept
    : config_(config), executor_(executor, pole, limits, contacts_) {}

GuidanceOutput Guidance::update(const GuidanceInput& in) noexcept {
  mode_ = in.mode;
  if (in.entered) enter(in);
  watchVehicle(in);

  GuidanceOutput out;
  switch (in.mode) {
    case Mode::kStandby:
    case Mode::kArmed:
      return out;
    case Mode::kEstop:
      out.engaged = true;
      out.action = paced(VehicleAction::kMotorStop, in.now);
      return out;
    case Mode::kTakeoff:
      if (!has_flown_) out.action = paced(VehicleAction::kTakeoff, in.now);
      break;
    case Mode::kLand:
      if (landing_ == Landing::kStopMotors) out.action = paced(VehicleAction::kMotorStop, in.now);
      break;
    default:
      break;
  }
  out.engaged = true;
  // Once it has flown it counts as airborne until it says that it stands: a fault in the air is no
  // touch-down.
  out.reel_controller = has_flown_;
  if (!has_flown_) return out;

  fly(in);
  ExecutorInput executor_in;
  executor_in.estimate = in.estimate;
  if (in.sensors->attitude.valid) executor_in.R_WB = in.sensors->attitude.value.R_WB;
  if (in.sensors->gimbal.valid) executor_in.gimbal_pitch = in.sensors->gimbal.value.pitch;
  out.route = executor_.update(in.dt, executor_in);
  if (in.mode == Mode::kAuto && under_way_) mission_ = executor_.status();
  return out;
}

/// One garbled status line must not end a flight, so standing takes several samples in a row.
void Guidance::watchVehicle(const GuidanceInput& in) noexcept {
  const bool stands = in.vehicle == VehiclePhase::kIdle || in.vehicle == VehiclePhase::kStopped;
  const bool flies = in.vehicle == VehiclePhase::kFlying || in.vehicle == VehiclePhase::kLanding;
  if (flies && in.mode != Mode::kStandby) has_flown_ = true;
  if (!stands) grounded_samples_ = 0;
  if (stands && in.sensors->vehicle.sequence != vehicle_sequence_) ++grounded_samples_;
  vehicle_sequence_ = in.sensors->vehicle.sequence;
}

void Guidance::enter(const GuidanceInput& in) noexcept {
  under_way_ = false;
  last_action_.reset();
  executor_.abort();
  if (in.mode == Mode::kArmed || in.mode == Mode::kStandby) {
    contacts_.clear();
    has_flown_ = false;
  }
  if (in.mode == Mode::kLand)
    landing_ = contacts_.contactCount() > 0 ? Landing::kRetrace : Landing::kApproach;
}

/// Starts what the mode flies as soon as there is an estimate to start from, and moves a landing
/// on.
void Guidance::fly(const GuidanceInput& in) noexcept {
  if (!in.estimate.usable()) return;
  if (in.mode == Mode::kLand) {
    land(in);
  } else if (!under_way_) {
    switch (in.mode) {
      case Mode::kTakeoff:
        under_way_ = goTo(config_.home_position_m + Eigen::Vector3d(0, config_.takeoff_height_m, 0),
                          config_.travel_speed_mps, in.estimate);
        break;
      case Mode::kAuto:
        under_way_ = in.plan != nullptr && executor_.start(*in.plan, in.estimate);
        break;
      default:
        under_way_ = goTo(in.estimate.p_WD, config_.travel_speed_mps, in.estimate);
    }
  }
}

/// Retrace the contacts, go above home, descend, stop the motors. A step that fails is tried again
/// from where the drone is: to give up in the air is no landing.
void Guidance::land(const GuidanceInput& in) noexcept {
  const Eigen::Vector3d above =
      config_.home_position_m + Eigen::Vector3d(0, config_.approach_height_m, 0);
  const Eigen::Vector3d below = config_.home_position_m - Eigen::Vector3d(0, kBelowGround, 0);
  const MissionState state = executor_.status().state;
  const bool arrived = under_way_ && state == MissionState::kCompleted;
  if (under_way_ && state == MissionState::kFailed) under_way_ = false;

  if (landing_ == Landing::kRetrace) {
    if (!under_way_) under_way_ = executor_.goBack(in.estimate);
    if (!under_way_ || arrived) {
      landing_ = Landing::kApproach;
      under_way_ = false;
    }
  } else if (landing_ == Landing::kApproach && arrived) {
    landing_ = Landing::kDescend;
    under_way_ = false;
    lowest_ = in.estimate.p_WD.y() - config_.home_position_m.y();
    lowest_since_ = in.now;
  } else if (landing_ == Landing::kDescend && onGround(in)) {
    landing_ = Landing::kStopMotors;
    executor_.abort();
  }

  if (under_way_) return;
  if (landing_ == Landing::kApproach)
    under_way_ = goTo(above, config_.travel_speed_mps, in.estimate);
  if (landing_ == Landing::kDescend)
    under_way_ = goTo(below, config_.descent_speed_mps, in.estimate);
}

bool Guidance::onGround(const GuidanceInput& in) noexcept {
  const double height = in.estimate.p_WD.y() - config_.home_position_m.y();
  if (height < lowest_ - kSmallestDescent) {
    lowest_ = height;
    lowest_since_ = in.now;
  }
  return height < config_.touchdown_height_m ||
         (height < kGroundHeight && in.now - lowest_since_ > kNoLowerFor);
}

bool Guidance::goTo(const Eigen::Vector3d& p_WD, double speed, const Estimate& estimate) noexcept {
  PointTarget target;
  target.p_WD = p_WD;
  target.speed = speed;
  return executor_.goTo(target, estimate);
}

VehicleAction Guidance::paced(VehicleAction action, Time now) noexcept {
  if (last_action_ && now - *last_action_ < fromSeconds(config_.action_period_s))
    return VehicleAction::kNone;
  last_action_ = now;
  return action;
}

bool Guidance::startsWithPresentTether(const MissionPlan& plan) const noexcept {
  constexpr double kSamePoint = 1e-3;  // [m]
  const int first = plan.waypoints[0].contact;
  if (first != contacts_.activeId()) return false;
  const MissionContact* contact = plan.findContact(first);
  return contact == nullptr || (contact->p_WC - contacts_.anchor().p_WA).norm() < kSamePoint;
}

ConditionSet Guidance::conditions() const noexcept {
  const MissionState state = executor_.status().state;
  ConditionSet set;
  set.set(Condition::kAtTarget, mode_ == Mode::kTakeoff && under_way_ &&
                                    executor_.status().distance < config_.takeoff_radius_m);
  const bool stands = grounded_samples_ >= kGroundedSamples;
  // A take-off that never left the ground ends there too.
  set.set(Condition::kTouchdown, stands && (has_flown_ || mode_ == Mode::kLand));
  set.set(Condition::kMissionDone,
          mode_ == Mode::kAuto && under_way_ && state == MissionState::kCompleted);
  set.set(Condition::kMissionFailed,
          mode_ == Mode::kAuto && under_way_ && state == MissionState::kFailed);
  return set;
}

}  // namespace tautline
