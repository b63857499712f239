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
  void update(const Lockstep& bench) {
    const Time now = bench.now();
    const StepOutput& out = bench.output();
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
  Said next(const Lockstep& bench, const Phases& phases) {
    Said said;
    if (queue_.empty() && bench.now() > Time{}) think(bench, phases);
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

  void think(const Lockstep& bench, const Phases& phases) {
    const Time now = bench.now();
    for (std::size_t i = 0; i < states_.size(); ++i) {
      const OperatorEntry& entry = flight_.script[i];
      State& state = states_[i];
      if (entry.in_mode) {
        const bool there = bench.output().supervision.mode == entry.phase.mode;
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
  std::optional<std::string> check(const Lockstep& bench, const Phases& phases) {
    for (std::size_t i = 0; i < all_.size(); ++i) {
      const Expectation& e = all_[i];
      const std::optional<Time> began = phases.begin(e.phase);
      if (!began || met_[i] || bench.now() < *began + e.after) continue;
      if (e.kind == Expectation::Kind::kBound) {
        const double value = e.quantity->of(bench);
        if (!e.range.contains(value)) return failure(e, fmt::format("it was {:.3f}", value));
        met_[i] = bench.now() >= *began + e.after + e.within;
        continue;
      }
      met_[i] = seen(e, bench.output());
      if (!met_[i] && bench.now() > *began + e.after + e.within)
        return failure(
            e, fmt::format("in {} with {}", nameOf(bench.output().supervision.mode, kModeNames),
                           describe(bench.output().conditions)));
    }
    return {};
  }

  /// At the end: what never had its time.
  [[nodiscard]] std::optional<std::string> missing(const Lockstep& bench) const {
    for (std::size_t i = 0; i < all_.size(); ++i) {
      if (!met_[i])
        return failure(all_[i], fmt::format("the flight ended before, in {}",
                                            nameOf(bench.output().supervision.mode, kModeNames)));
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

  void update(Lockstep& bench, Phases& phases) {
    for (std::size_t i = 0; i < waiting_.size();) {
      const std::optional<Time> began = phases.begin(waiting_[i].phase);
      if (!began) {
        ++i;
        continue;
      }
      sim::Fault fault = waiting_[i].fault;
      fault.at = *began + (fault.at - Time{});
      bench.inject(fault);
      begins_.push_back(fault.at);
      waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(i));
    }
    for (const Time at : begins_) {
      if (bench.now() >= at) phases.faultBegan(at);
    }
  }

 private:
  std::vector<FaultPlan> waiting_;
  std::vector<Time> begins_;
};

bool atRest(const sim::Truth& truth) { return truth.on_ground && !truth.motors_on; }

}  // namespace

CaseResult runCase(const FlightCase& flight, TelemetrySink* sink) {
  const Time began = monotonicNow();
  CaseResult result;
  result.name = flight.name;
  result.seed = flight.bench.seed;
  Lockstep bench(flight.bench, sink);
  FlightWatch watch(flight.limits);
  Phases phases;
  Operator pilot(flight);
  Expectations expectations(flight.expectations);
  FaultPlans faults(flight.faults);
  bool flown = false;
  Time busy{};  // last time that the flight was not over

  while (result.failure.empty() && bench.now() < Time{} + flight.limit &&
         bench.now() < busy + kSettled) {
    const Operator::Said said = pilot.next(bench, phases);
    if (said.sticks) bench.holdSticks(Sticks{kSession, true, *said.sticks});
    const StepOutput& out = bench.step(said.command, said.chunk ? &*said.chunk : nullptr);
    for (const std::int32_t sequence : pilot.navigates()) watch.navigateAsked(sequence);
    pilot.hear(out);
    phases.update(bench);
    faults.update(bench, phases);
    flown = flown || !bench.truth().on_ground;
    const Mode mode = out.supervision.mode;
    const bool over = mode == Mode::kStandby || mode == Mode::kEstop;
    if (!bench.truth().crashed && !(flown && over)) busy = bench.now();
    result.height_max_m = std::max(result.height_max_m, bench.truth().p_WD.y() - bench.floor());
    std::optional<std::string> problem = watch.check(bench);
    if (!problem) problem = expectations.check(bench, phases);
    if (problem)
      result.failure = fmt::format("at {:.2f} s: {}", toSeconds(bench.now() - Time{}), *problem);
  }

  result.end = bench.output().supervision.mode;
  result.crash = bench.truth().crash_reason;
  result.faulted = phases.begin({Phase::Kind::kFault, {}, {}}).has_value();
  result.flight_s = toSeconds(bench.now() - Time{});
  if (result.failure.empty()) {
    const CaseLimits& limits = flight.limits;
    if (!flight.faults.empty() && !result.faulted) {
      result.failure = fmt::format(
          "the flight never got as far as its fault: after {:.1f} s in {} with {}", result.flight_s,
          nameOf(result.end, kModeNames), describe(bench.output().conditions));
    } else if (!limits.end.empty() && !limits.end.has(result.end) && !bench.truth().crashed) {
      result.failure = fmt::format(
          "expected to end in {}: after {:.1f} s in {} with {}", limits.end.text(), result.flight_s,
          nameOf(result.end, kModeNames), describe(bench.output().conditions));
    } else if (limits.landed && !bench.truth().crashed && !atRest(bench.truth())) {
      result.failure = fmt::format(
          "expected on the ground with motors off: {:.2f} m above the floor{}",
          bench.truth().p_WD.y() - bench.floor(), bench.truth().motors_on ? ", motors on" : "");
    } else if (const auto missing = expectations.missing(bench)) {
      result.failure = *missing;
    }
  }
  result.wall_s = toSeconds(monotonicNow() - began);
  return result;
}

}  // namespace tautline::bench
