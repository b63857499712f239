/// @file
/// The part of Telemetry that tells operators of their own dealings: lease, audit, faults, safety,
/// changed parameters. Texts stay inside capacity reserved at start-up.

#include <algorithm>
#include <charconv>
#include <limits>
#include <numeric>
#include <string_view>

#include "app/station/input_message.h"
#include "app/station/telemetry.h"
#include "lcmtypes/channels.h"

namespace tautline {
namespace {

constexpr Duration kAuthorityPeriod = std::chrono::milliseconds(500);
constexpr Duration kFaultsPeriod = std::chrono::seconds(1);
constexpr Duration kSafetyPeriod = std::chrono::milliseconds(200);

/// Shortest text that reads back the same, as a TOML float or integer.
struct NumberText {
  std::array<char, 40> text{};
  std::size_t size{0};

  NumberText(double value, bool integer) noexcept {
    const auto end = std::to_chars(text.data(), text.data() + text.size() - 2, value).ptr;
    size = static_cast<std::size_t>(end - text.data());
    if (integer || view().find_first_not_of("-0123456789") != std::string_view::npos) return;
    text[size++] = '.';
    text[size++] = '0';
  }
  [[nodiscard]] std::string_view view() const noexcept { return {text.data(), size}; }
};

void appendOperator(std::string& text, const OperatorName& name, std::int64_t session) noexcept {
  if (name[0] != 0) {
    text.append(name.data());
    return;
  }
  std::array<char, 24> hex{};
  const auto end =
      std::to_chars(hex.data(), hex.data() + hex.size(), static_cast<std::uint64_t>(session), 16)
          .ptr;
  text.append("session ").append(hex.data(), static_cast<std::size_t>(end - hex.data()));
}

template <class T>
double age(const Sample<T>& sample, Time now) noexcept {
  return sample.sequence == 0 ? std::numeric_limits<double>::quiet_NaN()
                              : toSeconds(now - sample.time);
}

}  // namespace

void Telemetry::publishOperators(const StepInput& in, const StepOutput& out) noexcept {
  const OperatorDialogue& operators = *out.operators;
  const LeaseChange& lease = operators.authority().change();
  const FaultLog& faults = operators.faults();
  if (lease.event != LeaseEvent::kNone) sendLeaseChange(in.now, lease);
  if (operators.audit()) sendAudit(in.now, *operators.audit());
  if (operators.parameter())
    sendParameterChange(in.now, *operators.parameter(), operators.authority().lease().name);
  if (lease.event != LeaseEvent::kNone || in.now >= next_authority_) {
    next_authority_ = in.now + kAuthorityPeriod;
    sendAuthority(in.now, operators);
  }
  if (in.now >= next_faults_ || faults.latched() != fault_was_latched_ ||
      faults.count() != faults_told_) {
    next_faults_ = in.now + kFaultsPeriod;
    fault_was_latched_ = faults.latched();
    faults_told_ = faults.count();
    sendFaults(in.now, faults);
  }
  if (in.now >= next_safety_) {
    next_safety_ = in.now + kSafetyPeriod;
    sendSafety(in, out);
  }
}

void Telemetry::sendAudit(Time now, const AuditRecord& audit) noexcept {
  event_.text.clear();
  appendOperator(event_.text, audit.name, audit.session);
  event_.text.append(": ").append(audit.verb).append(": ");
  event_.text.append(nameOf(audit.result, kAckResultNames));
  sendText(now, audit.result == AckResult::kAccepted ? EventCode::kOperatorAccepted
                                                     : EventCode::kOperatorRefused);
}

void Telemetry::sendLeaseChange(Time now, const LeaseChange& change) noexcept {
  event_.text.assign(textOf(EventCode::kLeaseChanged).text);
  switch (change.event) {
    case LeaseEvent::kTaken:
      event_.text.append("taken by ").append(change.to.data());
      break;
    case LeaseEvent::kTakenOver:
      event_.text.append("taken over by ").append(change.to.data());
      event_.text.append(" from ").append(change.from.data());
      break;
    case LeaseEvent::kReleased:
      event_.text.append("released by ").append(change.from.data());
      break;
    case LeaseEvent::kExpired:
    case LeaseEvent::kNone:
      event_.text.append("of ").append(change.from.data()).append(" expired");
  }
  sendText(now, EventCode::kLeaseChanged);
}

void Telemetry::sendParameterChange(Time now, const ParameterChange& change,
                                    const OperatorName& name) noexcept {
  patchParams(change);
  event_.text.assign(change.key.view()).append(" changed from ");
  event_.text.append(NumberText(change.before, change.integer).view()).append(" to ");
  event_.text.append(NumberText(change.after, change.integer).view()).append(" by ");
  event_.text.append(name.data());
  sendText(now, EventCode::kParameterChanged);
  publishParams(now);
}

/// The same number in the text that PARAMS carries: "[section]", then "key = value  # …".
void Telemetry::patchParams(const ParameterChange& change) noexcept {
  const std::string_view whole = change.key.view();
  const std::size_t dot = whole.rfind('.');
  const std::string_view key = whole.substr(dot + 1);
  std::string& toml = params_.toml;
  const auto begin = toml.begin();
  const auto lineOf = [&](std::size_t from, char before, std::string_view text,
                          std::string_view after) {
    for (std::size_t at = toml.find(text, from); at != std::string::npos;
         at = toml.find(text, at + 1)) {
      if (at > 0 && toml[at - 1] == before &&
          toml.compare(at + text.size(), after.size(), after) == 0)
        return at;
    }
    return std::string::npos;
  };
  const std::size_t section = lineOf(0, '[', whole.substr(0, dot), "]");
  if (section == std::string::npos) return;
  const std::size_t line = lineOf(section, '\n', key, " = ");
  if (line == std::string::npos) return;
  const std::size_t value = line + key.size() + 3;
  const std::size_t end = std::min(toml.find("  #", value), toml.find('\n', value));
  const NumberText number(change.after, change.integer);
  if (end == std::string::npos || toml.size() + number.size > toml.capacity()) return;
  toml.replace(begin + static_cast<std::ptrdiff_t>(value), begin + static_cast<std::ptrdiff_t>(end),
               number.text.begin(), number.text.begin() + static_cast<std::ptrdiff_t>(number.size));
}

void Telemetry::sendAuthority(Time now, const OperatorDialogue& operators) noexcept {
  const Authority& authority = operators.authority();
  const Lease& lease = authority.lease();
  tautline::authority_t m{};
  m.session = lease.session;
  put(m.name, lease.name);
  if (lease.held()) {
    m.lease_age_s = toSeconds(now - lease.taken);
    m.heartbeat_age_s = toSeconds(now - lease.heard);
    m.lease_left_s = authority.secondsLeft(now);
  }
  m.sticks_fresh = authority.rates(now).has_value();
  const AckCounts& core = operators.counts();
  std::copy(core.begin(), core.end(), m.results);
  if (inbox_counts_ != nullptr) {
    constexpr std::size_t kFirstRefusal = 1;  // what passed the inbox is counted by the core
    for (std::size_t i = kFirstRefusal; i < core.size(); ++i) m.results[i] += (*inbox_counts_)[i];
  }
  refused_ = std::accumulate(m.results + 1, m.results + core.size(), std::int64_t{0});
  send(channel::kAuthority, m, now);
}

void Telemetry::sendFaults(Time now, const FaultLog& faults) noexcept {
  tautline::faults_t m{};
  m.latched = faults.latched();
  m.count = static_cast<std::int32_t>(faults.count());
  for (std::size_t i = 0; i < faults.count(); ++i) {
    m.fault_utime[i] = unixMicroseconds(faults[i].time);
    m.condition[i] = static_cast<std::int8_t>(faults[i].condition);
    m.mode[i] = static_cast<std::int8_t>(faults[i].mode);
  }
  send(channel::kFaults, m, now);
}

void Telemetry::sendSafety(const StepInput& in, const StepOutput& out) noexcept {
  constexpr ConditionSet kBlockers = conditionsOf(ConditionKind::kForbidsArming);
  tautline::safety_t m{};
  m.conditions = static_cast<std::int64_t>(out.conditions.bits());
  m.arming_blockers = static_cast<std::int64_t>((out.conditions & kBlockers).bits());
  std::fill(std::begin(m.value), std::end(m.value), std::numeric_limits<double>::quiet_NaN());
  std::fill(std::begin(m.limit), std::end(m.limit), std::numeric_limits<double>::quiet_NaN());
  const auto value = [&m](Condition c) -> double& { return m.value[static_cast<std::size_t>(c)]; };
  value(Condition::kReelStale) = age(in.sensors.reel, in.now);
  value(Condition::kAnglesStale) = age(in.sensors.angles, in.now);
  value(Condition::kAttitudeStale) = age(in.sensors.attitude, in.now);
  value(Condition::kVehicleStale) = age(in.sensors.vehicle, in.now);
  value(Condition::kTimeInMode) = toSeconds(out.supervision.time_in_mode);
  const Lease& lease = out.operators->authority().lease();
  if (lease.held()) value(Condition::kOperatorLost) = toSeconds(in.now - lease.heard);
  send(channel::kSafety, m, in.now);
}

}  // namespace tautline
