#include "app/station/telemetry.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "app/station/input_message.h"
#include "lcmtypes/channels.h"

namespace tautline {
namespace {

constexpr Duration kSafetyPeriod = std::chrono::milliseconds(500);

void put(double (&out)[3], const Eigen::Vector3d& v) noexcept {
  for (int i = 0; i < 3; ++i) out[i] = v[i];
}

template <class T>
double ageOf(const Sample<T>& sample, Time now) noexcept {
  return sample.sequence == 0 ? -1.0 : toSeconds(now - sample.time);
}

/// Heading of the body about +y.
double yawOf(const Eigen::Quaterniond& R_WB) noexcept {
  const Eigen::Vector3d forward = R_WB * Eigen::Vector3d::UnitX();
  return std::atan2(-forward.z(), forward.x());
}

template <class Int, class T>
Int as(T value) noexcept {
  return static_cast<Int>(value);
}

/// " (0.62 s, limit 0.50)" where something was measured. Stays inside the text's room: no
/// allocation.
void appendMeasured(std::string& text, const StationEvent& event, const char* unit) noexcept {
  if (event.value == 0.0 && event.limit == 0.0) return;
  const auto append = [&text](double x) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.begin(), digits.end(), x, std::chars_format::general, 4);
    text.append(digits.data(), as<std::size_t>(end.ptr - digits.data()));
  };
  text.append(" (");
  append(event.value);
  text.append(" ").append(unit).append(", limit ");
  append(event.limit);
  text.append(")");
}

}  // namespace

Telemetry::Telemetry(TelemetrySink& sink, RunMode run_mode, Duration unix_offset,
                     Duration state_period)
    : sink_(sink), run_mode_(run_mode), unix_offset_(unix_offset), state_period_(state_period) {
  setPlace("");
}

void Telemetry::publish(const StepInput& in, const StepOutput& out) noexcept {
  sendInput(in);
  if (out.ack) {
    tautline::command_ack_t ack{};
    ack.session = out.ack->session;
    ack.sequence = out.ack->sequence;
    ack.result = as<std::int8_t>(out.ack->result);
    ack.reasons = as<std::int64_t>(out.ack->reasons.bits());
    ack.detail = out.ack->detail;
    send(channel::kCommandAck, ack, in.now);
  }
  if (in.now >= next_safety_ || out.conditions != safety_told_) sendSafety(in.now, out);
  for (int i = 0; i < out.event_count; ++i) sendEvent(in.now, out.events[as<std::size_t>(i)]);

  publishOperators(in, out);

  const bool due = in.now >= next_state_;
  if (due || out.command.action != VehicleAction::kNone) sendCommand(in.now, out.command);
  // A change of mode is told at once, so that clients need not wait for the next round; the mission
  // first, so that who sees the mode change knows how the mission ended.
  if (due || out.supervision.changed) {
    sendMission(in.now, out);
    sendStation(in.now, out);
  }
  if (!due) return;
  next_state_ = std::max(next_state_ + state_period_, in.now);  // on a grid, without catching up
  sendTether(in, out);
  sendVehicle(in);
  sendEstimate(in.now, out);
}

void Telemetry::sendInput(const StepInput& in) noexcept {
  tautline::station_input_t m = messageOf(in);
  send(channel::kStationInput, m, in.now);
}

void Telemetry::sendStation(Time now, const StepOutput& out) noexcept {
  tautline::station_state_t m{};
  m.run_mode = as<std::int8_t>(run_mode_);
  m.mode = as<std::int8_t>(out.supervision.mode);
  m.conditions = as<std::int64_t>(out.conditions.bits());
  m.reasons = as<std::int64_t>(out.supervision.reasons.bits());
  m.time_in_mode_us =
      std::chrono::duration_cast<std::chrono::microseconds>(out.supervision.time_in_mode).count();
  m.mission_hash = as<std::int64_t>(out.loaded_hash);
  m.mission_items = out.mission_items;
  send(channel::kStationState, m, now);
}

void Telemetry::sendSafety(Time now, const StepOutput& out) noexcept {
  next_safety_ = now + kSafetyPeriod;
  safety_told_ = out.conditions;
  tautline::safety_t m{};
  static_assert(kConditionCount <= tautline::safety_t::ROOM);
  m.conditions = as<std::int64_t>(out.conditions.bits());
  m.raised = as<std::int64_t>(out.findings.raised.bits());
  m.arming_blockers =
      as<std::int64_t>((out.conditions & conditionsOf(ConditionKind::kForbidsArming)).bits());
  std::copy(out.findings.value.begin(), out.findings.value.end(), m.value);
  std::copy(out.findings.limit.begin(), out.findings.limit.end(), m.limit);
  send(channel::kSafety, m, now);
}

void Telemetry::sendTether(const StepInput& in, const StepOutput& out) noexcept {
  const SensorFrame& f = in.sensors;
  tautline::tether_state_t m{};
  m.encoder_counts = f.reel.value.counts;
  m.length_meas_m = f.reel.value.length;
  m.elevation_meas_rad = f.angles.value.theta;
  m.azimuth_meas_rad = f.angles.value.phi;
  m.reel_age_s = ageOf(f.reel, in.now);
  m.angles_age_s = ageOf(f.angles, in.now);
  m.length_free_m = out.estimate.L_free;
  m.length_static_m = out.anchor.L_static;
  m.elevation_rad = out.estimate.theta_tangent;
  m.azimuth_rad = out.estimate.phi;
  m.tension_n = out.estimate.T;
  m.tension_sigma_n = out.estimate.sigma_T;
  m.contact_count = as<std::int16_t>(out.anchor.contact_count);
  m.contact_id = as<std::int16_t>(out.contact_id);
  put(m.anchor_m, out.anchor.p_WA);
  send(channel::kTetherState, m, in.now);
}

void Telemetry::sendVehicle(const StepInput& in) noexcept {
  const SensorFrame& f = in.sensors;
  tautline::vehicle_state_t& m = vehicle_;
  m.phase = as<std::int8_t>(f.vehicle.value.phase);
  m.flight_mode = f.vehicle.value.flight_mode;
  m.flags = f.vehicle.value.flags;
  m.protocol = as<std::int8_t>(f.vehicle.value.protocol);
  put(m.attitude_wxyz, f.attitude.value.R_WB);
  m.yaw_rad = yawOf(f.attitude.value.R_WB);
  m.gimbal_pitch_rad = f.gimbal.value.pitch;
  m.altitude_m = f.angles.value.altitude.value_or(0.0);
  m.ground_battery_v = f.ground.value.battery_voltage;
  m.backup_battery_v = f.vehicle.value.backup_battery_voltage;
  m.status_age_s = ageOf(f.vehicle, in.now);
  putLink(m, f.link);
  send(channel::kVehicleState, m, in.now);
}

void Telemetry::sendEstimate(Time now, const StepOutput& out) noexcept {
  const Estimate& e = out.estimate;
  tautline::estimate_t m{};
  m.valid = e.valid;
  m.health = as<std::int8_t>(e.health);
  put(m.position_m, e.p_WD);
  put(m.velocity_mps, e.v_WD);
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) m.position_cov_m2[3 * row + col] = e.P_position(row, col);
  }
  m.tension_n = e.T;
  m.tension_sigma_n = e.sigma_T;
  m.reel_scale = e.reel_scale;
  m.reel_scale_sigma = e.sigma_reel_scale;
  m.elevation_bias_rad = e.elevation_bias;
  m.azimuth_zero_rad = e.azimuth_zero;
  m.nis = e.nis;
  send(channel::kEstimate, m, now);
}

void Telemetry::sendCommand(Time now, const VehicleCommand& c) noexcept {
  tautline::command_t m{};
  m.engaged = c.engaged;
  m.length_rate_mps = c.length_rate;
  m.elevation_rate_radps = c.elevation_rate;
  m.azimuth_rate_radps = c.azimuth_rate;
  m.yaw_rate_radps = c.yaw_rate;
  m.gimbal_pitch_rate_radps = c.gimbal_pitch_rate;
  m.reel_controller = c.reel_controller;
  m.action = as<std::int8_t>(c.action);
  send(channel::kCommand, m, now);
}

void Telemetry::sendMission(Time now, const StepOutput& out) noexcept {
  const ExecutorStatus& s = out.mission;
  tautline::mission_status_t m{};
  m.mission_hash = as<std::int64_t>(s.mission_hash);
  m.state = as<std::int8_t>(s.state);
  m.failure = as<std::int8_t>(s.failure);
  m.waypoint = s.waypoint;
  m.waypoint_count = s.waypoint_count;
  put(m.target_m, s.p_WTarget);
  put(m.segment_start_m, s.p_WSegmentStart);
  m.distance_m = s.distance;
  m.cross_track_m = s.cross_track;
  m.acceptance_radius_m = s.acceptance_radius;
  m.target_length_m = s.target_length;
  m.target_elevation_rad = s.target_elevation;
  m.target_azimuth_rad = s.target_azimuth;
  m.time_on_waypoint_s = toSeconds(s.time_on_waypoint);
  send(channel::kMissionStatus, m, now);
}

void Telemetry::sendEvent(Time now, const StationEvent& event) noexcept {
  // What follows stays inside the reserved capacity: no allocation.
  event_.text.clear();
  appendText(event_.text, textOf(event.code).text, vehicle_.link_place);
  if (event.code == EventCode::kModeChanged) {
    event_.text.append(nameOf(event.mode, kModeNames));
    const char* separator = " because of ";
    for (const auto& entry : kConditionInfos) {
      if (!event.reasons.has(entry.condition)) continue;
      event_.text.append(separator).append(entry.name);
      separator = " ";
    }
  }
  if (event.code == EventCode::kConditionCame || event.code == EventCode::kConditionWent) {
    sendCondition(now, event);
  } else {
    sendText(now, event.code);
  }
}

/// event_.text is begun.
void Telemetry::sendCondition(Time now, const StationEvent& event) noexcept {
  const EventText& text = textOf(event.code);
  const ConditionInfo& info = infoOf(event.condition);
  const bool came = event.code == EventCode::kConditionCame;
  const bool warns = came && info.kind == ConditionKind::kWarns;
  event_.severity = as<std::int8_t>(warns ? Severity::kWarning : text.severity);
  event_.code = kFirstConditionCode + 2 * as<std::int32_t>(event.condition) + (came ? 0 : 1);
  event_.text.append(info.name).append(": ").append(info.text);
  if (came) appendMeasured(event_.text, event, info.unit);
  event_.reaction.assign(text.reaction);
  event_.remedy.assign(came ? info.remedy : text.remedy);
  send(channel::kEvent, event_, now);
}

/// event_.text is there already.
void Telemetry::sendText(Time now, EventCode code) noexcept {
  const EventText& text = textOf(code);
  event_.severity = as<std::int8_t>(text.severity);
  event_.code = as<std::int32_t>(code);
  event_.reaction.assign(text.reaction);
  event_.remedy.clear();
  appendText(event_.remedy, text.remedy, vehicle_.link_place);
  send(channel::kEvent, event_, now);
}

void Telemetry::publishLoop(Time now, Duration period, const LoopStatistics::Snapshot& s) noexcept {
  tautline::loop_stats_t m{};
  m.period_s = toSeconds(period);
  m.cycles = s.cycles;
  m.overruns = s.overruns;
  m.skipped_periods = s.skipped_periods;
  m.lateness_mean_s = s.lateness_mean;
  m.lateness_max_s = s.lateness_max;
  m.work_mean_s = s.work_mean;
  m.work_max_s = s.work_max;
  m.work_max_ever_s = s.work_max_ever;
  m.publish_errors = errors_;
  m.commands_refused = refused_;
  send(channel::kLoopStats, m, now);
}

void Telemetry::setParams(const std::string& program, const std::string& version,
                          const std::string& toml) {
  params_.program = program;
  params_.version = version;
  params_.toml = toml;
  // A number that `param set` changes may become longer text.
  constexpr std::size_t kRoomForChanges = 2048;
  params_.toml.reserve(toml.size() + kRoomForChanges);
  params_buffer_.resize(as<std::size_t>(params_.getEncodedSize()) + kRoomForChanges);
}

void Telemetry::setPlace(const std::string& place) {
  constexpr std::size_t kLongestText = 512;  // with the names of all conditions, or without {}
  constexpr std::size_t kHoles = 2;
  vehicle_.link_place = place;
  for (std::string* text : {&event_.text, &event_.reaction, &event_.remedy})
    text->reserve(kLongestText + kHoles * place.size());
}

void Telemetry::publishParams(Time now) noexcept {
  send(channel::kParams, params_, now, params_buffer_);
}

}  // namespace tautline
