#include "app/station/guidance.h"

#include <limits>

#include "app/station/station_config.h"

namespace tautline {
namespace {

// A landing aims so far below home that it ends on the ground, whatever the estimate is off by [m].
constexpr double kBelowGround = 0.8;
constexpr Duration kLevelFor = std::chrono::seconds(1);
// Higher than this above home by the estimate a drone that stands still may as well have been
// stopped in the air, by its reel or a lost command: it takes longer [m].
constexpr double kAtHome = 0.1;
constexpr Duration kLevelForHigher = std::chrono::seconds(8);
constexpr double kStandsStill = 1.0 / 3.0;             // of a descent's way in that time
constexpr Duration kHangs = std::chrono::seconds(60);  // or twice the descent, whichever is longer
constexpr int kGroundedSamples = 2;
constexpr Duration kStandsForSure = std::chrono::seconds(10);  // whatever the estimate says
constexpr double kAllTheWay = std::numeric_limits<double>::infinity();

}  // namespace

Guidance::Guidance(const GuidanceConfig& config, const ExecutorConfig& executor,
                   const PoleConfig& pole, const VehicleLimits& limits) noexcept
    : config_(config), limits_(limits), executor_(executor, pole, limits, contacts_) {}

GuidanceOutput Guidance::update(const GuidanceInput& in) noexcept {
  if (in.entered) enter(in);
  watchVehicle(in);

  GuidanceOutput out;
  VehicleCommand& command = out.command;
  switch (in.mode) {
    case Mode::kStandby:
    case Mode::kArmed:
      return out;
    case Mode::kEstop:
      command.engaged = true;
      command.action = paced(VehicleAction::kMotorStop, in.now);
      return out;
    case Mode::kTakeoff:
      if (!has_flown_) command.action = paced(VehicleAction::kTakeoff, in.now);
      break;
    case Mode::kLand:
      // A take-off that is broken off before the vehicle says that it flies still lifts off.
      if (landing_ == Landing::kStopMotors || !has_flown_)
        command.action = paced(VehicleAction::kMotorStop, in.now);
      break;
    default:
      break;
  }
  command.engaged = true;
  // Once it has flown it counts as airborne until it says that it stands: a fault in the air is no
  // touch-down.
  command.reel_controller = has_flown_;
  // While it says that it stands, nothing winds the reel, whatever the estimate says.
  if (!has_flown_ || grounded_samples_ >= kGroundedSamples) return out;

  if (!flyByRates(in, command)) {
    fly(in);
    ExecutorInput executor_in;
    executor_in.estimate = in.estimate;
    if (in.sensors->attitude.valid) executor_in.R_WB = in.sensors->attitude.value.R_WB;
    if (in.sensors->gimbal.valid) executor_in.gimbal_pitch = in.sensors->gimbal.value.pitch;
    out.route = executor_.update(in.dt, executor_in);
  }
  if (in.mode == Mode::kAuto && under_way_) mission_ = executor_.status();
  recordFlight(in);
  return out;
}

/// One garbled status line must not end a flight, so standing takes several samples in a row; nor a
/// vehicle that says so while the estimate has it in the air, so there it takes long. One that gave
/// up flying has landed once it is low for as long.
void Guidance::watchVehicle(const GuidanceInput& in) noexcept {
  const bool stands = in.vehicle == VehiclePhase::kIdle || in.vehicle == VehiclePhase::kStopped;
  const bool flies = in.vehicle == VehiclePhase::kFlying || in.vehicle == VehiclePhase::kLanding;
  if (flies && in.mode != Mode::kStandby) has_flown_ = true;
  if (!stands || in.entered) grounded_samples_ = 0;
  if (stands && in.sensors->vehicle.sequence != vehicle_sequence_) ++grounded_samples_;
  if (flies || in.entered) not_flying_since_ = in.now;
  const bool in_the_air = in.estimate.usable() && !config_.isNearFloor(in.estimate.p_WD);
  const bool for_long = in.now - not_flying_since_ > kStandsForSure;
  stands_ = grounded_samples_ >= kGroundedSamples && (!in_the_air || for_long);
  gave_up_ = in.vehicle == VehiclePhase::kFault && !in_the_air && for_long;
  vehicle_sequence_ = in.sensors->vehicle.sequence;
}

void Guidance::enter(const GuidanceInput& in) noexcept {
  viewpoint_.reset();
  if (in.mode == Mode::kHold && conditions().has(Condition::kMissionDone))
    viewpoint_ = executor_.holdPoint();
  mode_ = in.mode;
  under_way_ = false;
  last_action_.reset();
  executor_.abort();
  switch (in.mode) {
    case Mode::kStandby:
    case Mode::kArmed:
      contacts_.clear();
      path_.clear();
      has_flown_ = false;
      break;
    case Mode::kTakeoff:
      path_.begin(aboveHome(config_.takeoff_height_m));
      // A vehicle that is lost sight of in its take-off goes on up to about there.
      p_AD_ = aboveHome(config_.takeoff_height_m) - contacts_.anchor().p_WA;
      break;
    case Mode::kLand:
      landing_ = contacts_.contactCount() > 0 ? Landing::kRetrace : Landing::kApproach;
      break;
    case Mode::kDescend:
      landing_ = Landing::kDescend;
      descending_since_ = in.now;
      down_since_.reset();
      descent_.begin(p_AD_, (contacts_.anchor().p_WA + p_AD_ - config_.home_position_m).y());
      break;
    default:
      break;
  }
}

/// What is flown without the executor; false: everything else.
bool Guidance::flyByRates(const GuidanceInput& in, VehicleCommand& command) noexcept {
  if (in.mode == Mode::kDescend) {
    descend(in, command);
    return true;
  }
  if (in.mode == Mode::kFailsafe && in.conditions.has(Condition::kTetherSlack)) {
    command.length_rate = -config_.slack_reel_in_mps;
    return true;
  }
  if (in.mode != Mode::kTeleop || !in.teleop) return false;
  command.length_rate = in.teleop->length;
  command.elevation_rate = in.teleop->elevation;
  command.azimuth_rate = in.teleop->azimuth;
  command.yaw_rate = in.teleop->yaw;
  command.gimbal_pitch_rate = in.teleop->gimbal_pitch;
  under_way_ = false;  // where the sticks go silent a new hover begins
  return true;
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
        under_way_ =
            goTo(aboveHome(config_.takeoff_height_m), config_.travel_speed_mps, in.estimate);
        break;
      case Mode::kAuto:
        under_way_ = in.plan != nullptr && executor_.start(*in.plan, in.estimate);
        break;
      case Mode::kBackUp:
        under_way_ = goBack(config_.back_up_m, in.estimate);
        break;
      case Mode::kReturn:
        under_way_ = goBack(kAllTheWay, in.estimate);
        break;
      default:
        under_way_ = viewpoint_ ? executor_.goTo(*viewpoint_, in.estimate)
                                : goTo(in.estimate.p_WD, config_.travel_speed_mps, in.estimate);
    }
  }
}

/// Retrace the way flown if there are contacts to undo, go above home, descend, stop the motors. A
/// step that fails is tried again from where the drone is: to give up in the air is no landing.
void Guidance::land(const GuidanceInput& in) noexcept {
  const MissionState state = executor_.status().state;
  const bool arrived = under_way_ && state == MissionState::kCompleted;
  if (under_way_ && state == MissionState::kFailed) under_way_ = false;

  if (landing_ == Landing::kRetrace) {
    if (!under_way_) under_way_ = goBack(kAllTheWay, in.estimate);
    if (!under_way_ || arrived) {
      landing_ = Landing::kApproach;
      under_way_ = false;
    }
  } else if (landing_ == Landing::kApproach && arrived) {
    landing_ = Landing::kDescend;
    under_way_ = false;
    level_ = in.estimate.p_WD.y() - config_.home_position_m.y();
    level_since_ = in.now;
  } else if (landing_ == Landing::kDescend && onGround(in)) {
    landing_ = Landing::kStopMotors;
    executor_.abort();
  }

  if (under_way_) return;
  if (landing_ == Landing::kApproach)
    under_way_ = goTo(aboveHome(config_.approach_height_m), config_.travel_speed_mps, in.estimate);
  if (landing_ == Landing::kDescend) {
    double depth = kBelowGround;
    const auto reach = [&] { return contacts_.effective(aboveHome(-depth)).L_total; };
    while (depth > 0.1 && reach() > limits_.tether_length_m) depth *= 0.5;
    under_way_ = goTo(aboveHome(-depth), config_.descent_speed_mps, in.estimate);
  }
}

/// A vehicle that comes down by itself stops its motors by itself, unless it hangs on a tether that
/// something holds; any other is brought down by the rates.
void Guidance::descend(const GuidanceInput& in, VehicleCommand& command) noexcept {
  const TetherAngles& angles = in.sensors->angles.value;
  const bool fresh = in.sensors->angles.valid && !in.conditions.has(Condition::kAnglesStale);
  const RateCommand rates = descent_.update(in.dt, config_.descent_speed_mps, limits_,
                                            fresh ? angles.altitude : std::nullopt);
  if (descent_.onGround()) {
    if (!down_since_) down_since_ = in.now;
    const bool hangs =
        in.now - *down_since_ > std::max(kHangs, 2 * (*down_since_ - descending_since_));
    if (in.vehicle != VehiclePhase::kLanding || hangs) landing_ = Landing::kStopMotors;
  }
  if (landing_ == Landing::kStopMotors) {
    command.action = paced(VehicleAction::kMotorStop, in.now);
    return;
  }
  command.action = VehicleAction::kLand;
  command.length_rate = rates.length_rate;
  command.elevation_rate = rates.elevation_rate;
}

/// Told to go lower it does not. A height alone would stop the motors in the air where the estimate
/// is too low.
bool Guidance::onGround(const GuidanceInput& in) noexcept {
  const double height = in.estimate.p_WD.y() - config_.home_position_m.y();
  const double still = kStandsStill * config_.descent_speed_mps * toSeconds(kLevelFor);
  // One that is told to stand still comes no lower either.
  if (std::abs(height - level_) > still || in.conditions.any(kStandStill)) {
    level_ = height;
    level_since_ = in.now;
  }
  return config_.isNearFloor(in.estimate.p_WD) &&
         in.now - level_since_ > (height < kAtHome ? kLevelFor : kLevelForHigher);
}

bool Guidance::goTo(const Eigen::Vector3d& p_WD, double speed, const Estimate& estimate) noexcept {
  PointTarget target;
  target.p_WD = p_WD;
  target.speed = speed;
  return executor_.goTo(target, estimate);
}

bool Guidance::goBack(double distance, const Estimate& estimate) noexcept {
  return executor_.goBack(path_, distance, config_.travel_speed_mps, estimate);
}

bool Guidance::goingBack() const noexcept {
  const bool back = isIn(mode_, maskOf({Mode::kBackUp, Mode::kReturn})) ||
                    (mode_ == Mode::kLand && landing_ == Landing::kRetrace);
  return back && under_way_;
}

/// Where it is flown to is remembered, and forgotten as it is flown back. A take-off is one
/// straight piece up to where the way home ends.
void Guidance::recordFlight(const GuidanceInput& in) noexcept {
  constexpr ConditionSet kTetherUnknown{Condition::kUnplannedContact, Condition::kContactLost,
                                        Condition::kContactNotFormed, Condition::kTetherSnagged,
                                        Condition::kTetherBroken};
  const bool blind = !in.estimate.usable() || in.conditions.any(kStandStill);
  if (blind || isIn(in.mode, maskOf({Mode::kTakeoff, Mode::kDescend}))) return;
  p_AD_ = in.estimate.p_WD - contacts_.anchor().p_WA;
  if (goingBack()) {
    path_.cutAfter(executor_.status().waypoint);
  } else {
    path_.record(in.estimate.p_WD, contacts_, !in.conditions.any(kTetherUnknown));
  }
}

Eigen::Vector3d Guidance::aboveHome(double height) const noexcept {
  return config_.home_position_m + Eigen::Vector3d(0, height, 0);
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

bool Guidance::routeFailed() const noexcept {
  return isIn(mode_, maskOf({Mode::kAuto, Mode::kBackUp, Mode::kReturn})) && under_way_ &&
         executor_.status().state == MissionState::kFailed;
}

ConditionSet Guidance::conditions() const noexcept {
  const bool completed = under_way_ && executor_.status().state == MissionState::kCompleted;
  const bool back = isIn(mode_, maskOf({Mode::kBackUp, Mode::kReturn}));
  ConditionSet set;
  set.set(Condition::kAtTarget,
          (back && completed) || (mode_ == Mode::kTakeoff && under_way_ &&
                                  executor_.status().distance < config_.takeoff_radius_m));
  // A take-off that never left the ground ends there too.
  set.set(Condition::kTouchdown, (stands_ || gave_up_) && (has_flown_ || mode_ == Mode::kLand));
  set.set(Condition::kMissionDone, mode_ == Mode::kAuto && completed);
  set.set(Condition::kMissionFailed, routeFailed() || (back && !path_.known()));
  set.set(Condition::kNoWayBack, isIn(mode_, kFlyingModes) && !path_.known());
  return set;
}

}  // namespace tautline
