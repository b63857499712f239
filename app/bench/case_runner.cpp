#include "app/bench/case_runner.h"

#include <algorithm>
#include <array>
#include <deque>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "app/bench/flight_watch.h"
#include "app/station/mission_upload.h"
#include "common/clock.h"

namespace tautline::bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Duration kRetryPeriod = milliseconds(500);
constexpr Duration kSettled = seconds(3);  // on the ground after the flight, or after a crash
constexpr std::int64_t kSession = 1;

/// When each phase began.
class Phases {
 public:
  void update(const Rig& rig) {
    const Time now = rig.now();
    const StepOutput& out = rig.output();
    if (out.supervision.changed || !entered_) entered_ = now;
    note(modes_[static_cast<std::size_t>(out.supervision.mode)], now);
    for (std::size_t i = 0; i < conditions_.size(); ++i) {
      if (out.conditions.has(kConditionNames[i].value)) note(conditions_[i], now);
    }
  }
  void faultBegan(Time at) { note(fault_, at); }

  [[nodiscard]] std::optional<Time> begin(const Phase& phase) const {
    switch (phase.kind) {
      case Phase::Kind::kMode:
        return modes_[static_cast<std::size_t>(phase.mode)];
      case Phase::Kind::kCondition:
        for (std::size_t i = 0; i < conditions_.size(); ++i) {
          if (kConditionNames[i].value == phase.condition) return conditions_[i];
        }
        return {};
      case Phase::Kind::kFault:
        return fault_;
      case Phase::Kind::kStart:
        break;
    }
    return Time{};
  }
  [[nodiscard]] bool over(const Phase& phase, Duration after, Time now) const {
    const std::optional<Time> began = begin(phase);
    return began && now >= *began + after;
  }
  [[nodiscard]] Time entered() const { return *entered_; }

 private:
  static void note(std::optional<Time>& time, Time now) {
    if (!time) time = now;
  }
  std::array<std::optional<Time>, kModeNames.size()> modes_{};
  std::array<std::optional<Time>, kConditionNames.size()> conditions_{};
  std::optional<Time> fault_;
  std::optional<Time> entered_;
};

/// The operator of a script.
class Operator {
 public:
  explicit Operator(const FlightCase& flight) : flight_(flight), states_(flight.script.size()) {}

  /// What is said in the next cycle.
  struct Said {
    std::optional<OperatorCommand> command;
    std::optional<tautline::mission_chunk_t> chunk;
    std::optional<TeleopRates> sticks;
  };
  Said next(const Rig& rig, const Phases& phases) {
    Said said;
    if (queue_.empty() && rig.now() > Time{}) think(rig, phases);
    if (queue_.empty()) return said;
    said = queue_.front();
    queue_.pop_front();
    return said;
  }
  /// After each cycle; retries what was refused.
  void hear(const StepOutput& out) {
    if (!out.ack || out.ack->result != AckResult::kAccepted) return;
    for (State& s : states_) s.taken = s.taken || s.sequence == out.ack->sequence;
  }
  [[nodiscard]] const std::vector<std::int32_t>& navigates() const { return navigates_; }

 private:
  struct State {
    std::optional<Time> first;
    Time last{};
    Time mode_entered{};
    std::int32_t sequence{-1};
    bool taken{false};
  };

  void think(const Rig& rig, const Phases& phases) {
    const Time now = rig.now();
    for (std::size_t i = 0; i < states_.size(); ++i) {
      const OperatorEntry& entry = flight_.script[i];
      State& state = states_[i];
      if (entry.in_mode) {
        const bool there = rig.output().supervision.mode == entry.phase.mode;
        if (!there || now < phases.entered() + entry.at) continue;
        if (state.first && state.mode_entered == phases.entered()) continue;
      } else if (!phases.over(entry.phase, entry.at, now)) {
        continue;
      } else if (state.first) {
        const bool again = !state.taken && now < *state.first + entry.retry;
        if (!again || now < state.last + kRetryPeriod) continue;
      }
      if (!state.first) state.first = now;
      state.last = now;
      state.mode_entered = phases.entered();
      if (entry.sticks) {
        state.taken = true;
        queue_.push_back({{}, {}, entry.sticks});
      } else {
        say(entry.verb, state);
      }
      return;
    }
  }

  void say(Request verb, State& state) {
    std::uint64_t hash = 0;
    if (verb == Request::kNavigate && flight_.mission) {
      hash = flight_.mission->hash;
      forEachChunk(*flight_.mission, [&](tautline::mission_chunk_t& chunk) {
        chunk.session = kSession;
        chunk.sequence = ++sequence_;
        queue_.push_back({{}, chunk, {}});
        return true;
      });
    }
    queue_.push_back({OperatorCommand{kSession, ++sequence_, verb, hash}, {}, {}});
    state.sequence = sequence_;
    if (verb == Request::kNavigate) navigates_.push_back(sequence_);
  }

  const FlightCase& flight_;
  std::vector<State> states_;
  std::deque<Said> queue_;
  std::vector<std::int32_t> navigates_;
  std::int32_t sequence_{0};
};

/// What is expected, and whether it has been seen.
class Expectations {
 public:
  explicit Expectations(const std::vector<Expectation>& all) : all_(all), met_(all.size(), false) {}

  /// What is now certain to be wrong.
  std::optional<std::string> check(const Rig& rig, const Phases& phases) {
    for (std::size_t i = 0; i < all_.size(); ++i) {
      const Expectation& e = all_[i];
      const std::optional<Time> began = phases.begin(e.phase);
      if (!began || met_[i] || rig.now() < *began + e.after) continue;
      if (e.kind == Expectation::Kind::kBound) {
        const Duration settle = std::min(rig.allowance(), e.within);
        if (rig.now() < *began + e.after + settle) continue;
        const double value = e.quantity->of(rig);
        if (!e.range.contains(value)) return failure(e, fmt::format("it was {:.3f}", value));
        met_[i] = rig.now() >= *began + e.after + e.within;
        continue;
      }
      met_[i] = seen(e, rig.output());
      if (!met_[i] && rig.now() > *began + e.after + e.within + rig.allowance())
        return failure(
            e, fmt::format("in {} with {}", nameOf(rig.output().supervision.mode, kModeNames),
                           describe(rig.output().conditions)));
    }
    return {};
  }

  /// At the end: what never had its time.
  [[nodiscard]] std::optional<std::string> missing(const Rig& rig) const {
    for (std::size_t i = 0; i < all_.size(); ++i) {
      if (!met_[i])
        return failure(all_[i], fmt::format("the flight ended before, in {}",
                                            nameOf(rig.output().supervision.mode, kModeNames)));
    }
    return {};
  }

 private:
  static std::string failure(const Expectation& e, const std::string& what) {
    return fmt::format("expected {} within {:g} s: {}", e.text(), toSeconds(e.within), what);
  }
  static bool seen(const Expectation& e, const StepOutput& out) {
    if (e.kind == Expectation::Kind::kMode) return e.modes.has(out.supervision.mode);
    if (e.kind == Expectation::Kind::kCondition) return out.conditions.any(e.conditions);
    if (e.kind == Expectation::Kind::kClear) return !out.conditions.any(e.conditions);
    return std::any_of(out.events.begin(), out.events.begin() + out.event_count,
                       [&](const StationEvent& event) { return event.code == e.event; });
  }

  const std::vector<Expectation>& all_;
  std::vector<bool> met_;
};

/// Schedules faults whose phase has begun.
class FaultPlans {
 public:
  explicit FaultPlans(const std::vector<FaultPlan>& plans) : waiting_(plans) {}

  void update(Rig& rig, Phases& phases) {
    for (std::size_t i = 0; i < waiting_.size();) {
      const std::optional<Time> began = phases.begin(waiting_[i].phase);
      if (!began) {
        ++i;
        continue;
      }
      sim::Fault fault = waiting_[i].fault;
      fault.at = *began + (fault.at - Time{});
      rig.inject(fault);
      begins_.push_back(fault.at);
      waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(i));
    }
    for (const Time at : begins_) {
      if (rig.now() >= at) phases.faultBegan(at);
    }
  }

 private:
  std::vector<FaultPlan> waiting_;
  std::vector<Time> begins_;
};

bool atRest(const sim::Truth& truth) { return truth.on_ground && !truth.motors_on; }

}  // namespace

CaseResult resultOf(const FlightCase& flight) {
  CaseResult result;
  result.name = flight.name;
  result.seed = flight.bench.seed;
  return result;
}

CaseResult runCase(const FlightCase& flight, TelemetrySink* sink) {
  Lockstep bench(flight.bench, sink);
  return runCase(flight, bench);
}

CaseResult runCase(const FlightCase& flight, Rig& rig) {
  const Time began = monotonicNow();
  CaseResult result = resultOf(flight);
  FlightWatch watch(flight.limits);
  Phases phases;
  Operator pilot(flight);
  Expectations expectations(flight.expectations);
  FaultPlans faults(flight.faults);
  bool flown = false;
  Time busy{};  // last time that the flight was not over

  while (result.failure.empty() && rig.now() < Time{} + flight.limit &&
         rig.now() < busy + kSettled) {
    const Operator::Said said = pilot.next(rig, phases);
    if (said.sticks) rig.holdSticks(Sticks{kSession, true, *said.sticks});
    const StepOutput& out = rig.step(said.command, said.chunk ? &*said.chunk : nullptr);
    for (const std::int32_t sequence : pilot.navigates()) watch.navigateAsked(sequence);
    pilot.hear(out);
    phases.update(rig);
    faults.update(rig, phases);
    flown = flown || !rig.truth().on_ground;
    const Mode mode = out.supervision.mode;
    const bool over = mode == Mode::kStandby || mode == Mode::kEstop;
    if (!rig.truth().crashed && !(flown && over)) busy = rig.now();
    result.height_max_m = std::max(result.height_max_m, rig.truth().p_WD.y() - rig.floor());
    std::optional<std::string> problem = watch.check(rig);
    if (!problem) problem = expectations.check(rig, phases);
    if (problem)
      result.failure = fmt::format("at {:.2f} s: {}", toSeconds(rig.now() - Time{}), *problem);
  }

  result.end = rig.output().supervision.mode;
  result.crash = rig.truth().crash_reason;
  result.faulted = phases.begin({Phase::Kind::kFault, {}, {}}).has_value();
  result.flight_s = toSeconds(rig.now() - Time{});
  if (result.failure.empty()) {
    const CaseLimits& limits = flight.limits;
    if (!flight.faults.empty() && !result.faulted) {
      result.failure = fmt::format(
          "the flight never got as far as its fault: after {:.1f} s in {} with {}", result.flight_s,
          nameOf(result.end, kModeNames), describe(rig.output().conditions));
    } else if (!limits.end.empty() && !limits.end.has(result.end) && !rig.truth().crashed) {
      result.failure = fmt::format(
          "expected to end in {}: after {:.1f} s in {} with {}", limits.end.text(), result.flight_s,
          nameOf(result.end, kModeNames), describe(rig.output().conditions));
    } else if (limits.landed && !rig.truth().crashed && !atRest(rig.truth())) {
      result.failure = fmt::format(
          "expected on the ground with motors off: {:.2f} m above the floor{}",
          rig.truth().p_WD.y() - rig.floor(), rig.truth().motors_on ? ", motors on" : "");
    } else if (const auto missing = expectations.missing(rig)) {
      result.failure = *missing;
    }
  }
  result.wall_s = toSeconds(monotonicNow() - began);
  return result;
}

}  // namespace tautline::bench
