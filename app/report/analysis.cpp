#include "app/report/analysis.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "app/report/outcome.h"
#include "lcmtypes/channels.h"

namespace tautline::report {
namespace {

constexpr double kMaxPositionGap = 1.0;  // [s] Longer holes in the position are not bridged.

std::optional<double> median(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<double> intervals(const std::vector<double>& times) {
  std::vector<double> out;
  for (std::size_t i = 1; i < times.size(); ++i) out.push_back(times[i] - times[i - 1]);
  return out;
}

std::vector<double> valuesOf(const std::vector<TimedValue>& series) {
  std::vector<double> out;
  out.reserve(series.size());
  for (const auto& sample : series) out.push_back(sample.value);
  return out;
}

bool contains(const TimeSpan& span, double t) { return t >= span.begin && t <= span.end; }

void extend(std::optional<TimeSpan>& span, double t) {
  if (!span) span = TimeSpan{t, t};
  span->end = t;
}

// The simulator's truth rules where there is one: a vehicle may believe that it still flies.
std::optional<TimeSpan> airborneSpan(const FlightLog& log) {
  std::optional<TimeSpan> span;
  for (const auto& s : log.truth) {
    if (!s.on_ground) extend(span, s.t);
  }
  if (!log.truth.empty()) return span;
  for (const auto& v : log.vehicle) {
    if (isAirborne(v.phase)) extend(span, v.t);
  }
  return span;
}

void findMission(const FlightLog& log, const std::vector<MissionSample>& mission,
                 FlightAnalysis& out) {
  for (std::size_t i = 0; i < mission.size(); ++i) {
    const MissionSample& m = mission[i];
    if (m.state != MissionState::kRunning) continue;
    const double end = i + 1 < mission.size() ? mission[i + 1].t : m.t;
    extend(out.mission, m.t);
    out.mission->end = end;
  }
  if (mission.empty()) return;
  const auto plan = log.missions.find(mission.back().hash);
  if (plan != log.missions.end()) out.plan = plan->second;
}

CrossTrackReport crossTrack(const std::vector<MissionSample>& mission,
                            const std::vector<PositionSample>& position) {
  CrossTrackReport out;
  std::vector<double> of_segment;
  const auto finishSegment = [&] {
    if (!out.segments.empty()) out.segments.back().cross_track = summarize(of_segment);
    of_segment.clear();
  };
  for (const auto& m : mission) {
    const bool under_way = m.state == MissionState::kRunning || m.state == MissionState::kHolding;
    if (!under_way) continue;
    if (m.state == MissionState::kRunning &&
        (out.segments.empty() || out.segments.back().waypoint != m.waypoint)) {
      finishSegment();
      out.segments.push_back({.waypoint = m.waypoint,
                              .start = m.segment_start,
                              .target = m.target,
                              .time = {m.t, m.t},
                              .cross_track = {},
                              .closest_approach = {}});
    }
    const auto p = interpolate(position, m.t, kMaxPositionGap);
    if (out.segments.empty() || out.segments.back().waypoint != m.waypoint || !p) continue;
    SegmentReport& segment = out.segments.back();
    const double distance = (m.target - *p).norm();
    segment.closest_approach = std::min(segment.closest_approach.value_or(distance), distance);
    if (m.state != MissionState::kRunning) continue;
    segment.time.end = m.t;
    const double error = distanceToSegment(*p, m.segment_start, m.target);
    out.series.push_back({m.t, error});
    of_segment.push_back(error);
  }
  finishSegment();
  out.all = summarize(valuesOf(out.series));
  return out;
}

LocalizationReport localization(const FlightLog& log, const std::optional<TimeSpan>& airborne) {
  LocalizationReport out;
  if (log.truth.empty() || !airborne) return out;
  std::vector<PositionSample> truth;
  truth.reserve(log.truth.size());
  for (const auto& s : log.truth) truth.push_back({s.t, s.p_WD});
  std::vector<double> lengths;
  for (const auto& e : log.estimates) {
    if (!e.valid || !contains(*airborne, e.t)) continue;
    const auto p = interpolate(truth, e.t, kMaxPositionGap);
    if (!p) continue;
    const auto near = std::lower_bound(log.truth.begin(), log.truth.end(), e.t,
                                       [](const TruthSample& s, double t) { return s.t < t; });
    out.series.push_back({e.t, (e.p_WD - *p).norm()});
    lengths.push_back(near->L_total);
    out.final_reel_scale = e.reel_scale;
    out.true_reel_scale = near->reel_scale;
  }
  const std::vector<double> errors = valuesOf(out.series);
  out.all = summarize(errors);
  out.slope_over_length = slope(lengths, errors);
  return out;
}

// Positions on an even grid; holes are left out, so neighbours are told apart by their index.
struct GridPosition {
  int index{};
  Eigen::Vector3d p;
};

std::vector<GridPosition> resample(const std::vector<PositionSample>& position,
                                   const TimeSpan& span, double step) {
  std::vector<GridPosition> grid;
  const int count = static_cast<int>(std::floor(span.length() / step)) + 1;
  for (int i = 0; i < count; ++i) {
    if (const auto p = interpolate(position, span.begin + i * step, kMaxPositionGap))
      grid.push_back({i, *p});
  }
  return grid;
}

SmoothnessReport smoothness(const FlightLog& log, const FlightAnalysis& flight) {
  SmoothnessReport out;
  if (!flight.mission || flight.mission->length() <= 0.0) return out;

  std::vector<double> times;
  for (const auto& s : flight.position) times.push_back(s.t);
  constexpr double kGridStep = 0.1;  // [s]
  const double h = std::max(kGridStep, median(intervals(times)).value_or(kGridStep));
  const auto grid = resample(flight.position, *flight.mission, h);
  std::vector<double> accelerations;
  std::vector<double> jerks;
  double flown = 0.0;
  for (std::size_t i = 1; i < grid.size(); ++i) {
    flown += (grid[i].p - grid[i - 1].p).norm();
    if (i < 2 || grid[i].index - grid[i - 2].index != 2) continue;
    accelerations.push_back((grid[i].p - 2.0 * grid[i - 1].p + grid[i - 2].p).norm() / (h * h));
    if (i < 3 || grid[i].index - grid[i - 3].index != 3) continue;
    jerks.push_back((grid[i].p - 3.0 * grid[i - 1].p + 3.0 * grid[i - 2].p - grid[i - 3].p).norm() /
                    (h * h * h));
  }
  if (const auto summary = summarize(accelerations)) out.rms_acceleration = summary->rms;
  if (const auto summary = summarize(jerks)) out.rms_jerk = summary->rms;
  if (grid.size() > 1) out.flown_length = flown;

  double planned = 0.0;
  for (const auto& segment : flight.cross_track.segments)
    planned += (segment.target - segment.start).norm();
  if (planned > 0.0) out.planned_length = planned;
  if (out.flown_length && out.planned_length)
    out.path_length_ratio = *out.flown_length / *out.planned_length;

  std::array<std::vector<double>, 3> rates;
  for (const auto& c : log.commands) {
    if (!c.engaged || !contains(*flight.mission, c.t)) continue;
    rates[0].push_back(c.length_rate);
    rates[1].push_back(c.elevation_rate);
    rates[2].push_back(c.azimuth_rate);
  }
  constexpr double kDeadBand = 1e-3;  // [m/s], [rad/s]
  if (!rates[0].empty()) {
    const auto per_second = [&](const std::vector<double>& r) {
      return countSignChanges(r, kDeadBand) / flight.mission->length();
    };
    out.sign_changes_hz = {per_second(rates[0]), per_second(rates[1]), per_second(rates[2])};
  }
  return out;
}

LoopReport loopReport(const std::vector<LoopSample>& loop) {
  LoopReport out;
  if (loop.empty()) return out;
  out.last = loop.back();
  const auto column = [&loop](double LoopSample::*member) {
    std::vector<double> values;
    for (const auto& s : loop) values.push_back(s.*member);
    return summarize(values);
  };
  if (const auto s = column(&LoopSample::lateness_mean)) out.lateness_mean = s->mean;
  if (const auto s = column(&LoopSample::lateness_max)) out.lateness_max = s->max;
  if (const auto s = column(&LoopSample::work_mean)) out.work_mean = s->mean;
  if (const auto s = column(&LoopSample::work_max)) out.work_max = s->max;
  return out;
}

bool isPeriodic(std::string_view name) {
  return name != channel::kEvent && name != channel::kMissionChunk && name != channel::kParams;
}

std::vector<ChannelReport> channelReports(const FlightLog& log) {
  std::vector<ChannelReport> out;
  for (const auto& [name, stats] : log.channels) {
    ChannelReport row{.name = name,
                      .messages = stats.messages,
                      .undecodable = stats.undecodable,
                      .period = {},
                      .longest_gap = {}};
    const auto steps = intervals(stats.times);
    if (isPeriodic(name) && !steps.empty()) {
      row.period = median(steps);
      row.longest_gap = *std::max_element(steps.begin(), steps.end());
      constexpr double kGapPeriods = 3.0;
      row.gaps = static_cast<int>(std::count_if(
          steps.begin(), steps.end(), [&](double s) { return s > kGapPeriods * *row.period; }));
    }
    out.push_back(row);
  }
  return out;
}

std::vector<ModeSpan> modeSpans(const std::vector<StateSample>& states) {
  std::vector<ModeSpan> out;
  for (const auto& s : states) {
    if (!out.empty()) out.back().time.end = s.t;
    if (out.empty() || out.back().mode != s.mode) out.push_back({{s.t, s.t}, s.mode, s.reasons});
  }
  return out;
}

TetherReport tetherReport(const FlightLog& log, const std::optional<TimeSpan>& airborne) {
  TetherReport out;
  const auto add = [&](double t, double length, double tension) {
    if (!airborne || !contains(*airborne, t) || !std::isfinite(length) || !std::isfinite(tension))
      return;
    out.length_min = std::min(out.length_min.value_or(length), length);
    out.length_max = std::max(out.length_max.value_or(length), length);
    out.tension_min = std::min(out.tension_min.value_or(tension), tension);
    out.tension_max = std::max(out.tension_max.value_or(tension), tension);
  };
  if (log.truth.empty()) {
    for (const auto& s : log.tether) add(s.t, s.L_free + s.L_static, s.T);
  } else {
    for (const auto& s : log.truth) add(s.t, s.L_total, s.T);
  }
  for (std::size_t i = 1; i < log.tether.size(); ++i) {
    const TetherSample& now = log.tether[i];
    const TetherSample& before = log.tether[i - 1];
    if (now.contact_count == before.contact_count && now.contact_id == before.contact_id) continue;
    const bool formed = now.contact_count >= before.contact_count;
    out.contact_changes.push_back(
        {now.t, formed, now.contact_id, now.contact_count, formed ? now.p_WA : before.p_WA});
    out.contacts_formed += formed ? 1 : 0;
  }
  return out;
}

std::vector<std::string> notesOn(const FlightLog& log, const FlightAnalysis& flight) {
  std::vector<std::string> notes;
  if (log.truth_on_other_clock) {
    notes.emplace_back(
        "The simulator's truth is on another clock than the station's messages and was not used.");
  }
  std::int64_t undecodable = 0;
  for (const auto& [name, stats] : log.channels) undecodable += stats.undecodable;
  if (undecodable > 0)
    notes.push_back(std::to_string(undecodable) +
                    " messages could not be decoded and were left out.");
  if (!log.damage.empty())
    notes.push_back("The log is " + log.damage + "; `tautline log check` says where.");
  if (log.states.empty())
    notes.emplace_back("The log has no STATION_STATE: run mode and modes are unknown.");
  if (flight.position.empty()) notes.emplace_back("The log has no valid position.");
  if (flight.outcome.mission_state != MissionState::kIdle &&
      (!flight.plan || !flight.plan->complete())) {
    notes.emplace_back(
        "The log does not hold the whole mission (MISSION_CHUNK): the planned path is drawn from "
        "the flown segments.");
  }
  if (!flight.has_truth)
    notes.emplace_back(
        "Cross-track error is measured with the estimate: there is no truth in this log.");
  return notes;
}

}  // namespace

FlightAnalysis analyze(const FlightLog& log) {
  FlightAnalysis out;
  if (!log.states.empty()) out.run_mode = log.states.back().run_mode;
  for (const auto& e : log.estimates) {
    if (e.valid) out.estimate.push_back({e.t, e.p_WD});
  }
  for (const auto& s : log.truth) out.position.push_back({s.t, s.p_WD});
  out.has_truth = !log.truth.empty();
  if (!out.has_truth) out.position = out.estimate;

  out.airborne = airborneSpan(log);
  const std::vector<MissionSample> mission = ofLastMission(log);
  findMission(log, mission, out);
  out.modes = modeSpans(log.states);
  out.outcome = findOutcome(log, mission, out.modes);
  out.cross_track = crossTrack(mission, out.position);
  out.localization = localization(log, out.airborne);
  out.smoothness = smoothness(log, out);
  out.loop = loopReport(log.loop);
  out.channels = channelReports(log);
  out.tether = tetherReport(log, out.airborne);
  out.notes = notesOn(log, out);
  return out;
}

}  // namespace tautline::report
