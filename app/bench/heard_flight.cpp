#include "app/bench/heard_flight.h"

#include <algorithm>
#include <array>

#include <Eigen/Core>
#include <tautline/command_ack_t.hpp>
#include <tautline/command_t.hpp>
#include <tautline/estimate_t.hpp>
#include <tautline/event_t.hpp>
#include <tautline/safety_t.hpp>
#include <tautline/sim_truth_t.hpp>
#include <tautline/station_input_t.hpp>
#include <tautline/station_state_t.hpp>
#include <tautline/tether_state_t.hpp>

#include "app/station/input_message.h"
#include "app/station/operator_message.h"
#include "lcmtypes/channels.h"

namespace tautline::bench {
namespace {

Eigen::Vector3d vectorOf(const double (&xyz)[3]) { return {xyz[0], xyz[1], xyz[2]}; }

ConditionSet conditionsOf(std::int64_t bits) {
  return ConditionSet::fromBits(static_cast<std::uint64_t>(bits));
}

VehicleCommand ratesOf(const tautline::command_t& m) {
  return {.engaged = m.engaged != 0,
          .length_rate = m.length_rate_mps,
          .elevation_rate = m.elevation_rate_radps,
          .azimuth_rate = m.azimuth_rate_radps,
          .yaw_rate = m.yaw_rate_radps,
          .gimbal_pitch_rate = m.gimbal_pitch_rate_radps,
          .reel_controller = m.reel_controller != 0,
          .action = static_cast<VehicleAction>(m.action)};
}

/// Whether a code of a message is one of `names`: another station's need not be.
template <class Enum, std::size_t n>
bool isKnown(std::int64_t code, const std::array<EnumName<Enum>, n>& names) {
  return std::any_of(names.begin(), names.end(), [&](const EnumName<Enum>& name) {
    return static_cast<std::int64_t>(name.value) == code;
  });
}

CommandAck ackOf(const tautline::command_ack_t& m) {
  return {.session = m.session,
          .sequence = m.sequence,
          .result = static_cast<AckResult>(m.result),
          .reasons = conditionsOf(m.reasons),
          .detail = m.detail};
}

StationEvent eventOf(const tautline::event_t& m) {
  if (m.code < kFirstConditionCode) return {.code = static_cast<EventCode>(m.code)};
  const std::int32_t k = m.code - kFirstConditionCode;
  return {.code = k % 2 == 0 ? EventCode::kConditionCame : EventCode::kConditionWent,
          .condition = static_cast<Condition>(k / 2)};
}

void read(const tautline::estimate_t& m, Estimate& out) {
  out.valid = m.valid != 0;
  out.health = static_cast<EstimateHealth>(m.health);
  out.p_WD = vectorOf(m.position_m);
  out.v_WD = vectorOf(m.velocity_mps);
  out.T = m.tension_n;
  out.sigma_T = m.tension_sigma_n;
}

sim::Truth truthOf(const tautline::sim_truth_t& m) {
  sim::Truth t;
  t.p_WD = vectorOf(m.position_m);
  t.v_WD = vectorOf(m.velocity_mps);
  t.tension = m.tension_n;
  t.reel_tension = m.reel_tension_n;
  t.length = m.length_m;
  t.reel_scale = m.reel_scale;
  t.tangent_elevation = m.tangent_elevation_rad;
  t.tangent_azimuth = m.tangent_azimuth_rad;
  t.on_ground = m.on_ground != 0;
  t.motors_on = m.motors_on != 0;
  t.crashed = m.crashed != 0;
  t.crash_reason = static_cast<sim::CrashReason>(m.crash_reason);
  t.contact_count = m.contact_count;
  t.p_WA = vectorOf(m.anchor_m);
  t.gust = vectorOf(m.gust_mps);
  return t;
}

struct Packet {
  std::string_view channel;
  std::span<const std::uint8_t> bytes;

  /// None if it came on another channel or is damaged.
  template <class Message>
  [[nodiscard]] std::optional<Message> as(const char* name) const {
    if (channel != name) return std::nullopt;
    return decodeExactly<Message>(bytes.data(), static_cast<int>(bytes.size()));
  }
};

}  // namespace

void HeardFlight::take(std::string_view channel, std::span<const std::uint8_t> bytes) {
  const Packet packet{channel, bytes};
  if (const auto m = packet.as<station_input_t>(channel::kStationInput)) next_ = inputOf(*m);
  if (const auto m = packet.as<station_state_t>(channel::kStationState)) {
    if (isKnown(m->mode, kModeNames)) enter(static_cast<Mode>(m->mode));
    output_.conditions = conditionsOf(m->conditions);
    output_.supervision.reasons = conditionsOf(m->reasons);
  }
  if (const auto m = packet.as<safety_t>(channel::kSafety))
    output_.conditions = conditionsOf(m->conditions);
  if (const auto m = packet.as<command_t>(channel::kCommand)) {
    output_.command = ratesOf(*m);
    rates_heard_ = true;
  }
  if (const auto m = packet.as<command_ack_t>(channel::kCommandAck)) output_.ack = ackOf(*m);
  if (const auto m = packet.as<event_t>(channel::kEvent)) add(eventOf(*m));
  if (const auto m = packet.as<estimate_t>(channel::kEstimate)) read(*m, output_.estimate);
  if (const auto m = packet.as<tether_state_t>(channel::kTetherState))
    output_.estimate.L_free = m->length_free_m;
  if (const auto m = packet.as<sim_truth_t>(channel::kSimTruth)) {
    truth_ = truthOf(*m);
    truth_heard_ = true;
  }
}

void HeardFlight::goOn() noexcept {
  output_.supervision.changed = false;
  output_.ack.reset();
  output_.event_count = 0;
  rates_heard_ = false;
  if (!next_) return;
  sensors_ = next_->sensors;
  next_.reset();
}

void HeardFlight::enter(Mode mode) noexcept {
  // What the mode before commanded says nothing of this one.
  const bool changed = state_heard_ && mode != output_.supervision.mode;
  if (changed && !rates_heard_) output_.command = {};
  output_.supervision.changed = output_.supervision.changed || changed;
  output_.supervision.mode = mode;
  state_heard_ = true;
}

/// The audit of operators is told as events too, but is none of the core's output.
void HeardFlight::add(const StationEvent& event) noexcept {
  if (!isAudit(event.code) && output_.event_count < std::ssize(output_.events))
    output_.events[static_cast<std::size_t>(output_.event_count++)] = event;
}

}  // namespace tautline::bench
