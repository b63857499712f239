#include "app/station/operator_dialogue.h"

#include "app/station/station.h"

namespace tautline {

OperatorDialogue::OperatorDialogue(CoreConfig& config, MissionStore& missions) noexcept
    : config_(config), missions_(missions), authority_(config.authority) {}

Request OperatorDialogue::take(const StepInput& in, Mode mode) noexcept {
  asked_.reset();
  ack_.reset();
  audit_.reset();
  parameter_.reset();
  authority_.update(in.now, mode, in.heartbeat, in.sticks);

  if (in.turned_away) {
    const TurnedAway& t = *in.turned_away;
    ack_ = CommandAck{t.session, t.sequence, t.result, {}, 0};
    audit_ = AuditRecord{{}, t.session, "message", t.result};
  }
  if (in.chunk != nullptr) {
    const tautline::mission_chunk_t& chunk = *in.chunk;
    AckResult result = authority_.decideChunk(in.now, chunk.session, nameFromBytes(chunk.name));
    if (result == AckResult::kAccepted && !missions_.add(chunk)) result = AckResult::kBadMission;
    say(chunk.session, chunk.sequence, result);
    ack_->detail = missions_.receivedWaypoints();
    if (result != AckResult::kAccepted)
      audit_ = AuditRecord{nameFromBytes(chunk.name), chunk.session, "mission", result};
  }
  if (!in.command) return Request::kNone;
  const OperatorCommand& c = *in.command;
  // A command that is sent again because its answer was lost must not act twice.
  for (const CommandAck& answered : answered_) {
    if (answered.session != c.session || answered.sequence != c.sequence) continue;
    ack_ = answered;
    return Request::kNone;
  }
  if (const AckResult result = authority_.decide(in.now, c); result != AckResult::kAccepted) {
    sayCommand(c, result);
    return Request::kNone;
  }
  if (c.service != Service::kNone) {
    sayCommand(c, serve(c, mode));
    return Request::kNone;
  }
  if (c.request == Request::kNavigate &&
      (missions_.loaded() == nullptr || missions_.loaded()->hash != c.mission_hash)) {
    sayCommand(c, AckResult::kBadMission);
    return Request::kNone;
  }
  asked_ = c;
  return c.request;
}

/// What is not the supervisor's: parameters and faults; the lease is already as it was asked for.
AckResult OperatorDialogue::serve(const OperatorCommand& c, Mode mode) noexcept {
  if (c.service != Service::kSetParameter && c.service != Service::kClearFaults)
    return AckResult::kAccepted;
  if (mode != Mode::kStandby) return AckResult::kLocked;
  if (c.service == Service::kClearFaults) {
    faults_.acknowledge();
    return AckResult::kAccepted;
  }
  ParameterSetter setter(c.parameter, c.value);
  config_.fields(setter);
  if (!setter.change()) return AckResult::kBadValue;
  parameter_ = setter.change();
  authority_.configure(config_.authority);
  return AckResult::kAccepted;
}

void OperatorDialogue::answer(Time now, const SupervisorOutput& decision) noexcept {
  faults_.update(now, decision);
  if (!asked_) return;
  if (decision.request_taken) {
    if (asked_->request == Request::kDisarm) faults_.acknowledge();
    sayCommand(*asked_, AckResult::kAccepted);
  } else {
    sayCommand(*asked_, decision.refusal.empty() ? AckResult::kOutOfMode : AckResult::kRefused,
               decision.refusal);
  }
}

ConditionSet OperatorDialogue::conditions(Time now, Mode mode) const noexcept {
  ConditionSet set = authority_.conditions(now, mode);
  set.set(Condition::kFaultLatched, faults_.latched());
  return set;
}

void OperatorDialogue::say(std::int64_t session, std::int64_t sequence, AckResult result,
                           ConditionSet reasons) noexcept {
  ack_ = CommandAck{session, sequence, result, reasons, 0};
  answered_[next_answer_] = *ack_;
  next_answer_ = (next_answer_ + 1) % answered_.size();
  ++counts_[static_cast<std::size_t>(result)];
}

void OperatorDialogue::sayCommand(const OperatorCommand& c, AckResult result,
                                  ConditionSet reasons) noexcept {
  say(c.session, c.sequence, result, reasons);
  audit_ = AuditRecord{c.name, c.session, result == AckResult::kUnknown ? "?" : verbOf(c), result};
}

}  // namespace tautline
