#include "supervision/authority.h"

#include <algorithm>
#include <cmath>

namespace tautline {

void Authority::give(Time now, std::int64_t session, const OperatorName& name,
                     LeaseEvent how) noexcept {
  change_ = {how, lease_.name, name};
  lease_ = {session, name, now, now};
  sticks_.reset();
  lost_ = false;
}

void Authority::end(LeaseEvent how) noexcept {
  change_ = {how, lease_.name, {}};
  lease_ = {};
  sticks_.reset();
}

void Authority::live(Time now) noexcept {
  lease_.heard = now;
  lost_ = false;
}

bool Authority::takeIfFree(Time now, std::int64_t session, const OperatorName& name) noexcept {
  if (!lease_.held()) give(now, session, name, LeaseEvent::kTaken);
  if (lease_.session != session) return false;
  live(now);
  return true;
}

bool Authority::beyondDeadBand(const TeleopRates& r) const noexcept {
  return std::max({std::abs(r.length), std::abs(r.elevation), std::abs(r.azimuth), std::abs(r.yaw),
                   std::abs(r.gimbal_pitch)}) > config_.stick_dead_band;
}

void Authority::update(Time now, Mode mode, const std::optional<Heartbeat>& heartbeat,
                       const std::optional<Sticks>& sticks) noexcept {
  change_ = {};
  sticks_moved_ = false;
  if (heartbeat && lease_.held() && heartbeat->session == lease_.session) live(now);
  if (sticks && lease_.held() && sticks->session == lease_.session) {
    sticks_ = sticks;
    sticks_time_ = now;
    sticks_moved_ = sticks->dead_man && beyondDeadBand(sticks->rates);
  }

  if (!lease_.held()) return;
  const bool expired = silentFor(now, config_.lease_timeout_s);
  if (mode == Mode::kTeleop && silentFor(now, config_.teleop_heartbeat_timeout_s)) lost_ = true;
  if (mode == Mode::kAuto && expired && config_.auto_without_operator == WithoutOperator::kHold)
    lost_ = true;
  if (expired) end(LeaseEvent::kExpired);
}

AckResult Authority::decide(Time now, const OperatorCommand& c) noexcept {
  const bool is_request = c.request > Request::kNone && c.request <= Request::kEstop;
  const bool is_service = c.service > Service::kNone && c.service <= Service::kClearFaults;
  if (is_request == is_service ||
      (is_request ? c.service != Service::kNone : c.request != Request::kNone))
    return AckResult::kUnknown;

  if (c.service == Service::kForceLease && lease_.held() && lease_.session != c.session) {
    give(now, c.session, c.name, LeaseEvent::kTakenOver);
    return AckResult::kAccepted;
  }
  if (c.service == Service::kReleaseLease) {
    if (lease_.held() && lease_.session != c.session) return AckResult::kNotHolder;
    if (lease_.held()) end(LeaseEvent::kReleased);
    return AckResult::kAccepted;
  }
  if (is_request && isSafeDirection(c.request)) {
    lost_ = false;  // somebody is there, whoever it is
    if (lease_.session == c.session) live(now);
    return AckResult::kAccepted;
  }
  return takeIfFree(now, c.session, c.name) ? AckResult::kAccepted : AckResult::kNotHolder;
}

AckResult Authority::decideChunk(Time now, std::int64_t session,
                                 const OperatorName& name) noexcept {
  return takeIfFree(now, session, name) ? AckResult::kAccepted : AckResult::kNotHolder;
}

ConditionSet Authority::conditions(Time now, Mode mode) const noexcept {
  ConditionSet set;
  set.set(Condition::kNoOperator, !lease_.held());
  set.set(Condition::kOperatorLost, lost_);
  set.set(Condition::kTeleopStale,
          mode == Mode::kTeleop &&
              (!sticks_ || now - sticks_time_ > fromSeconds(config_.stick_timeout_s)));
  set.set(Condition::kSticksMoved, mode == Mode::kAuto && sticks_moved_);
  return set;
}

std::optional<TeleopRates> Authority::rates(Time now) const noexcept {
  if (!sticks_ || !sticks_->dead_man || now - sticks_time_ > fromSeconds(config_.stick_timeout_s))
    return std::nullopt;
  return sticks_->rates;
}

}  // namespace tautline
