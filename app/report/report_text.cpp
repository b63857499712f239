#include "app/report/report_text.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>

namespace tautline::report {
namespace {

std::string field(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? fmt::format(",{:.6g}", *value) : std::string(",");
}

std::string fields(const std::optional<Eigen::Vector3d>& v) {
  if (!v) return ",,,";
  return field(v->x()) + field(v->y()) + field(v->z());
}

// Last sample at or before t, not older than a second.
template <class Sample>
const Sample* latest(const std::vector<Sample>& samples, double t) {
  constexpr double kTooOld = 1.0;  // [s]
  const auto after = std::upper_bound(samples.begin(), samples.end(), t,
                                      [](double time, const Sample& s) { return time < s.t; });
  if (after == samples.begin() || t - (after - 1)->t > kTooOld) return nullptr;
  return &*(after - 1);
}

std::string metres(const std::optional<Summary>& s) {
  return s ? fmt::format("mean {:.3f} m, max {:.3f} m, RMS {:.3f} m", s->mean, s->max, s->rms)
           : "–";
}

std::string seconds(const std::optional<TimeSpan>& span) {
  return span ? fmt::format("{:.1f} s", span->length()) : "–";
}

}  // namespace

std::string runModeName(const FlightAnalysis& flight) {
  return flight.run_mode ? nameOf(*flight.run_mode, kRunModeNames) : "unknown";
}

std::string startTimeText(const FlightLog& log) {
  constexpr std::int64_t kYear2000 = 946684800LL * 1000000;
  if (log.start_utime < kYear2000) return {};
  return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC",
                     fmt::gmtime(static_cast<std::time_t>(log.start_utime / 1000000)));
}

std::string seriesCsv(const FlightLog& log, const FlightAnalysis& flight) {
  std::string out =
      "t_s,mode,mission_state,waypoint,estimate_x_m,estimate_y_m,estimate_z_m,truth_x_m,truth_y_m,"
      "truth_z_m,target_x_m,target_y_m,"
      "target_z_m,cross_track_m,localization_error_m,tether_length_m,true_length_m,elevation_rad,"
      "azimuth_rad,tension_n,true_tension_n,"
      "contact_count\n";
  std::vector<double> times;
  for (const auto& e : log.estimates) times.push_back(e.t);
  if (times.empty()) {
    for (const auto& s : log.truth) times.push_back(s.t);
  }
  for (const double t : times) {
    const auto* state = latest(log.states, t);
    const auto* mission = latest(log.mission, t);
    const auto* estimate = latest(log.estimates, t);
    const auto* truth = latest(log.truth, t);
    const auto* tether = latest(log.tether, t);
    const auto* cross_track = latest(flight.cross_track.series, t);
    const auto* localization = latest(flight.localization.series, t);
    const bool under_way = mission != nullptr && (mission->state == MissionState::kRunning ||
                                                  mission->state == MissionState::kHolding);
    const bool running = under_way && mission->state == MissionState::kRunning;
    using Vector = std::optional<Eigen::Vector3d>;
    using Number = std::optional<double>;
    out += fmt::format("{:.6f},{},{},", t, state != nullptr ? nameOf(state->mode, kModeNames) : "",
                       mission != nullptr ? nameOf(mission->state, kMissionStateNames) : "");
    if (under_way) out += std::to_string(mission->waypoint);
    out += fields(estimate != nullptr && estimate->valid ? Vector(estimate->p_WD) : Vector());
    out += fields(truth != nullptr ? Vector(truth->p_WD) : Vector());
    out += fields(under_way ? Vector(mission->target) : Vector());
    out += field(running && cross_track != nullptr ? Number(cross_track->value) : Number());
    out += field(localization != nullptr ? Number(localization->value) : Number());
    out += field(tether != nullptr ? Number(tether->L_static + tether->L_free) : Number());
    out += field(truth != nullptr ? Number(truth->L_total) : Number());
    out += field(tether != nullptr ? Number(tether->theta) : Number());
    out += field(tether != nullptr ? Number(tether->phi) : Number());
    out += field(tether != nullptr ? Number(tether->T) : Number());
    out += field(truth != nullptr ? Number(truth->T) : Number());
    out += field(tether != nullptr ? Number(tether->contact_count) : Number());
    out += '\n';
  }
  return out;
}

std::string summaryText(const FlightLog& log, const FlightAnalysis& flight) {
  std::string out = flight.outcome.text + "\n";
  const auto line = [&out](const char* name, const std::string& value) {
    out += fmt::format("  {:<15} {}\n", name, value);
  };
  line("mode", runModeName(flight));
  line("duration", fmt::format("log {:.1f} s, airborne {}, mission {}", log.duration,
                               seconds(flight.airborne), seconds(flight.mission)));
  line("cross-track", metres(flight.cross_track.all));
  line("localization", metres(flight.localization.all));
  if (flight.tether.length_max) {
    line("tether", fmt::format("{:.2f} to {:.2f} m, tension {:.2f} to {:.2f} N, contacts formed {}",
                               *flight.tether.length_min, *flight.tether.length_max,
                               *flight.tether.tension_min, *flight.tether.tension_max,
                               flight.tether.contacts_formed));
  }
  if (flight.loop.last) {
    line("loop", fmt::format("{} cycles, {} overruns, {} skipped", flight.loop.last->cycles,
                             flight.loop.last->overruns, flight.loop.last->skipped));
  }
  const auto serious = std::count_if(log.events.begin(), log.events.end(),
                                     [](const auto& e) { return e.severity >= Severity::kError; });
  line("events", fmt::format("{}, {} of them errors", log.events.size(), serious));
  for (const auto& note : flight.notes) line("note", note);
  return out;
}

}  // namespace tautline::report
