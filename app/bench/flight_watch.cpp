#include "app/bench/flight_watch.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace tautline::bench {
namespace {

constexpr double kStalePeriods = 3.0;  // of a stream's own period
constexpr double kStaleAlways = 5.0;   // [s]
constexpr double kStaleMargin = 0.2;   // of the station's own count [s]
constexpr double kAtLimit = 0.05;      // of the tether's length [m]
constexpr double kOutward = 1e-3;      // [m/s]

bool moves(const VehicleCommand& c) noexcept {
  return c.length_rate != 0.0 || c.elevation_rate != 0.0 || c.azimuth_rate != 0.0 ||
         c.yaw_rate != 0.0;
}

}  // namespace

void FlightWatch::Stream::see(std::uint32_t now_sequence, Time now) noexcept {
  if (now_sequence == sequence) return;
  if (sequence != 0) gaps[next++ % gaps.size()] = toSeconds(now - arrived);
  sequence = now_sequence;
  arrived = now;
}

double FlightWatch::Stream::limit(double least) const noexcept {
  const double period = *std::max_element(gaps.begin(), gaps.end());
  return std::clamp(kStalePeriods * period + kStaleMargin, least, kStaleAlways + kStaleMargin);
}

std::optional<std::string> FlightWatch::check(const Rig& rig) {
  std::optional<std::string> problem = checkFinite(rig);
  if (!problem) problem = checkRates(rig);
  if (!problem) problem = checkMachine(rig);
  // Last, because it remembers the mode.
  std::optional<std::string> mode_problem = checkModes(rig);
  return problem ? problem : mode_problem;
}

std::optional<std::string> FlightWatch::checkFinite(const Rig& rig) const {
  const StepOutput& out = rig.output();
  const VehicleCommand& c = out.command;
  const Estimate& e = out.estimate;
  const bool command = std::isfinite(c.length_rate) && std::isfinite(c.elevation_rate) &&
                       std::isfinite(c.azimuth_rate) && std::isfinite(c.yaw_rate) &&
                       std::isfinite(c.gimbal_pitch_rate);
  if (!command) return "a commanded rate is not finite";
  const bool estimate = !e.valid || (e.p_WD.allFinite() && e.v_WD.allFinite() &&
                                     std::isfinite(e.T) && std::isfinite(e.L_free));
  if (!estimate) return "the estimate is valid and not finite";
  return {};
}

std::optional<std::string> FlightWatch::checkRates(const Rig& rig) {
  const StepOutput& out = rig.output();
  const SensorFrame& f = rig.sensors();
  reel_.see(f.reel.sequence, rig.now());
  angles_.see(f.angles.sequence, rig.now());
  if (!moves(out.command)) return {};
  const Mode mode = out.supervision.mode;
  if (mode == Mode::kStandby || mode == Mode::kArmed || mode == Mode::kEstop)
    return fmt::format("rates are commanded in {}", nameOf(mode, kModeNames));
  // A descent does not ask the tether where it is.
  if (mode == Mode::kDescend) return {};
  for (const auto& [stream, name] : {std::pair{&reel_, "tether length"}, {&angles_, "angles"}}) {
    const double age = toSeconds(rig.now() - stream->arrived);
    const double limit = stream->limit(limits_.stale_s);
    if (age > limit + toSeconds(rig.allowance()))
      return fmt::format("rates are commanded {:.2f} s after the last {} (limit {:.2f} s)", age,
                         name, limit);
  }
  const double all = rig.station().core.limits.tether_length_m;
  if (f.reel.valid && f.reel.value.length >= all - kAtLimit && out.command.length_rate > kOutward)
    return fmt::format("{:.3f} m/s are to be paid out with {:.2f} of {:.2f} m out",
                       out.command.length_rate, f.reel.value.length, all);
  return {};
}

std::optional<std::string> FlightWatch::checkModes(const Rig& rig) {
  const StepOutput& out = rig.output();
  const Mode before = mode_;
  mode_ = out.supervision.mode;
  if (mode_ == before) return {};
  if (mode_ == Mode::kAuto) {
    const bool asked = out.ack && out.ack->result == AckResult::kAccepted &&
                       navigate_sequences_.contains(out.ack->sequence);
    if (!asked) return "AUTO began without being asked for";
  }
  const auto row = std::find_if(limits_.sequence.begin(), limits_.sequence.end(),
                                [&](const ModeSequence& s) { return s.from == before; });
  if (limits_.sequence.empty() || (row != limits_.sequence.end() && row->to.has(mode_))) return {};
  return fmt::format("{} followed {}", nameOf(mode_, kModeNames), nameOf(before, kModeNames));
}

std::optional<std::string> FlightWatch::checkMachine(const Rig& rig) const {
  const sim::Truth& truth = rig.truth();
  if (truth.crashed && !limits_.may_crash)
    return fmt::format("crash: {}", nameOf(truth.crash_reason, sim::kCrashReasonNames));
  const double height = truth.p_WD.y() - rig.floor();
  if (height > limits_.max_height_m)
    return fmt::format("{:.2f} m above the floor (limit {:.2f} m)", height, limits_.max_height_m);
  return {};
}

}  // namespace tautline::bench
