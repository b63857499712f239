#include "app/station/condition_monitor.h"

#include <cmath>

#include "app/station/station_config.h"
#include "app/station/vehicle_signs.h"
#include "common/tether_geometry.h"

namespace tautline {
namespace {

using C = Condition;

// The lean is no witness of the pull if it may be wrong by more than this part of it.
constexpr double kLeanTells = 0.5;

/// A stream's newest sample may be used.
template <class T>
bool isGood(const Sample<T>& sample, const StreamHealth& health) noexcept {
  return sample.valid && !health.has(SensorFault::kRange);
}

/// What no single range can say: places that the configuration itself makes impossible to fly.
bool isUnflyable(const CoreConfig& config) {
  const GuidanceConfig& guidance = config.guidance;
  const Eigen::Vector3d hover =
      guidance.home_position_m + Eigen::Vector3d(0.0, guidance.takeoff_height_m, 0.0);
  Findings at_hover;
  Fence(config.fence).update({true, hover.norm(), hover}, at_hover);
  const PowerConfig& power = config.detect.power;
  return !at_hover.raised.empty() || hover.norm() > config.limits.tether_length_m ||
         config.localizer.nominal_tension_n >= config.detect.tether.max_tension_n ||
         power.battery_critical_v > power.battery_low_v;
}

}  // namespace

ConditionMonitor::ConditionMonitor(const CoreConfig& config)
    : config_(config),
      lean_(config.detect.tether.lean_time_s, config.detect.tether.least_lean_angle_rad,
            config.localizer.vehicle_weight_n),
      tether_(config.detect.tether),
      contact_(config.detect.contact, config.fence.obstacles),
      observer_(config.contact_observer),
      oscillation_(config.detect.oscillation),
      fence_(config.fence),
      power_(config.detect.power),
      link_(config.detect.link),
      host_(config.detect.host),
      parked_(config.detect.parked, config.guidance.home_position_m),
      reel_scale_(config.detect.reel_scale),
      config_bad_(isUnflyable(config)) {}

ConditionSet ConditionMonitor::update(const MonitorInput& in) noexcept {
  if (!first_) first_ = in.now;
  findings_ = {};
  findings_.raised = in.facts;
  watchSensors(in);
  watchTether(in);
  watchSpace(in);
  watchContact(in);
  watchVehicle(in);
  const LinkStatus& link = in.sensors->link;
  link_.update(in.now, link.lines_ok, link.lines_bad + link.check_errors, findings_);
  host_.update(in.now, !isIn(in.mode, kFlyingModes), *in.host, findings_);
  findings_.report(C::kLinkLost, !link.connected);
  findings_.report(C::kLinkFault, link.fault != LinkFault::kNone);
  findings_.report(C::kOverruns, in.missed_in_a_row >= config_.overruns_in_a_row,
                   in.missed_in_a_row, config_.overruns_in_a_row);
  findings_.report(C::kConfigBad, config_bad_);
  const ConditionSet counting = filter_.update(in.now, findings_.raised);
  // On the ground there is time: arming waits for what is the case now, too.
  if (in.mode != Mode::kStandby) return counting;
  return counting | (findings_.raised & conditionsOf(ConditionKind::kForbidsArming));
}

void ConditionMonitor::watchSensors(const MonitorInput& in) noexcept {
  const SensorHealth& health = *in.health;
  const auto stale = [&](Condition c, SensorStream stream) {
    const StreamHealth& s = health[stream];
    const bool missing = s.has(SensorFault::kMissing);
    findings_.report(c, missing || s.has(SensorFault::kStale),
                     missing ? toSeconds(in.now - *first_) : s.age, s.stale_after);
  };
  stale(C::kReelStale, SensorStream::kReel);
  stale(C::kAnglesStale, SensorStream::kAngles);
  stale(C::kAttitudeStale, SensorStream::kAttitude);
  stale(C::kVehicleStale, SensorStream::kVehicle);
  const StreamHealth& reel = health[SensorStream::kReel];
  const StreamHealth& angles = health[SensorStream::kAngles];
  findings_.report(C::kReelStuck, reel.has(SensorFault::kStuck));
  findings_.report(C::kAnglesStuck, angles.has(SensorFault::kStuck));

  findings_.reportAbove(C::kReelJump, reel.step, reel.step_allowed);
  // Where the floor carries the drone, its tether may go slack and swing.
  const bool touches_down = in.mode == Mode::kLand && in.estimate->usable() &&
                            config_.guidance.isNearFloor(in.estimate->p_WD);
  if (!touches_down) findings_.reportAbove(C::kAnglesJump, angles.step, angles.step_allowed);

  const SensorFrame& f = *in.sensors;
  if (isGood(f.reel, reel)) L_total_ = f.reel.value.length;

  const bool parked = !isIn(in.mode, kFlyingModes) && f.vehicle.value.phase == VehiclePhase::kIdle;
  std::optional<double> L_total, phi;
  if (parked && reel.ok()) L_total = L_total_;
  if (parked && angles.ok()) phi = f.angles.value.phi;
  parked_.update(in.now, L_total, phi, findings_);
}

void ConditionMonitor::watchTether(const MonitorInput& in) noexcept {
  const SensorFrame& f = *in.sensors;
  const Estimate& e = *in.estimate;
  const StreamHealth& reel = (*in.health)[SensorStream::kReel];
  findings_.report(C::kLocalizationLost, !e.usable(), e.nis, config_.localizer.health.lost_nis);
  reel_scale_.update(isFlying(f) && e.usable(), e.reel_scale, e.sigma_reel_scale, findings_);
  lean_.update(f.attitude, e.theta_tangent, e.phi);
  TetherWatchInput t;
  t.flying = isFlying(f) && e.usable();
  t.L_total = L_total_;
  t.L_max = config_.limits.tether_length_m;
  t.L_free = e.L_free;
  t.theta = e.theta_tangent;
  t.phi = e.phi;
  t.lean_angle = lean_.angle();
  if ((*in.health)[SensorStream::kAttitude].ok()) t.T_lean = lean_.tension();
  if (t.T_lean) {
    t.T_lean_error = lean_.tensionError(*t.T_lean, config_.detect.tether.lean_error_rad);
    // Under a steep tether a pull of nothing and one as usual may look alike.
    const double usual = config_.localizer.nominal_tension_n;
    if (t.T_lean_error > kLeanTells * std::max(*t.T_lean, usual)) t.T_lean.reset();
  }
  if (reel.ok()) t.T_reel = f.reel.value.tension;
  t.w = config_.localizer.tether_weight_n_per_m;
  if (in.last_command->engaged) {
    t.length_rate = in.last_command->length_rate;
    t.elevation_rate = in.last_command->elevation_rate;
    t.azimuth_rate = in.last_command->azimuth_rate;
  }
  tether_.update(in.now, t, findings_);
}

void ConditionMonitor::watchSpace(const MonitorInput& in) noexcept {
  const SensorFrame& f = *in.sensors;
  const Estimate& e = *in.estimate;
  const bool flying = isFlying(f);
  const bool angles_good = isGood(f.angles, (*in.health)[SensorStream::kAngles]);
  if (e.usable()) fence_.update({flying, L_total_, e.p_WD}, findings_);

  ContactWatchInput c;
  c.flying = flying;
  c.usable = e.usable();
  c.p_WA = in.anchor->p_WA;
  c.p_WD = e.p_WD;
  c.nis = e.nis;
  if (angles_good && f.angles.value.altitude) {
    const double height = e.p_WD.y() - config_.guidance.home_position_m.y();
    c.height_residual = *f.angles.value.altitude - height;
  }
  contact_.update(in.now, c, findings_);

  std::optional<Eigen::Vector3d> sensed;
  // With another anchor the sensed position steps: not the drone.
  const bool same_anchor = in.anchor->p_WA == p_WA_;
  p_WA_ = in.anchor->p_WA;
  if (flying && angles_good && same_anchor) {
    const TetherAngles& angles = f.angles.value;
    sensed = in.anchor->p_WA + toCartesian({e.L_free, angles.theta, angles.phi});
  }
  oscillation_.update(in.now, sensed, findings_);
}

/// What the tether turns about. On a way back it is not asked: contacts, known or not, come off
/// there when they will, and the way back is the remedy.
void ConditionMonitor::watchContact(const MonitorInput& in) noexcept {
  const SensorFrame& f = *in.sensors;
  const Estimate& e = *in.estimate;
  const SensorHealth& health = *in.health;
  ContactObserverInput o;
  constexpr ModeMask kWayBack = maskOf({Mode::kBackUp, Mode::kReturn, Mode::kLand, Mode::kDescend});
  const ContactObserverConfig& c = config_.contact_observer;
  const auto good = [&](SensorStream stream) {
    return health[stream].ok() && health[stream].period <= c.longest_period_s;
  };
  o.flying = isFlying(f) && !isIn(in.mode, kWayBack) && e.usable() &&
             health[SensorStream::kReel].ok() && good(SensorStream::kAngles) &&
             good(SensorStream::kAttitude) &&
             config_.localizer.nominal_tension_n >= c.least_tension_n;
  o.L_total = L_total_ * e.reel_scale;
  o.theta = f.angles.value.theta - e.elevation_bias;
  o.phi = f.angles.value.phi - e.azimuth_zero;
  o.R_WB = f.attitude.value.R_WB;
  o.T = e.T;
  o.G = config_.localizer.vehicle_weight_n;
  o.anchor = *in.anchor;
  const Eigen::Vector3d chord = e.p_WD - in.anchor->p_WA;
  o.sag = e.theta_tangent - std::atan2(chord.y(), std::hypot(chord.x(), chord.z()));
  o.height_sequence = f.angles.sequence;
  if (config_.localizer.noise.use_altitude && f.angles.value.altitude)
    o.height = config_.guidance.home_position_m.y() + *f.angles.value.altitude;
  const ContactVerdict& verdict = observer_.update(in.now, o);
  const auto report = [&](C condition, TetherHypothesis hypothesis) {
    findings_.report(condition, verdict.hypothesis == hypothesis, verdict.evidence, 1.0);
  };
  report(C::kContactLost, TetherHypothesis::kLost);
  report(C::kContactNotFormed, TetherHypothesis::kNotFormed);
  findings_.report(C::kContactSlipped, verdict.hypothesis == TetherHypothesis::kSlipped,
                   verdict.slip, c.slip.slip_m);
  if (verdict.hypothesis == TetherHypothesis::kUnplanned)
    findings_.report(C::kUnplannedContact, true, verdict.evidence, 1.0);
}

void ConditionMonitor::watchVehicle(const MonitorInput& in) noexcept {
  const SensorFrame& f = *in.sensors;
  std::optional<double> battery, backup;
  // A device that has no such sensor says 0.
  if (f.ground.valid && f.ground.value.battery_voltage > 0.0)
    battery = f.ground.value.battery_voltage;
  if (f.vehicle.valid && f.vehicle.value.backup_battery_voltage > 0.0)
    backup = f.vehicle.value.backup_battery_voltage;
  power_.update(battery, backup, findings_);
  if (config_.detect.vehicle_signs && f.vehicle.sequence > 0)
    findings_.raised = findings_.raised | conditionsOf(f.vehicle.value);
  // Motors that stop without being told to; at the end of a landing they are.
  constexpr ModeMask kMotorsWanted = maskOf(
      {Mode::kHold, Mode::kTeleop, Mode::kAuto, Mode::kFailsafe, Mode::kBackUp, Mode::kReturn});
  if (isIn(in.mode, kMotorsWanted) && f.vehicle.value.phase == VehiclePhase::kStopped)
    findings_.raised.set(C::kVehicleFault);
  findings_.report(C::kVehicleFlying, isFlying(f));
}

}  // namespace tautline
