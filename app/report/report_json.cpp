#include <cmath>

#include <nlohmann/json.hpp>

#include "app/report/report_text.h"

namespace tautline::report {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json number(const std::optional<double>& value) { return value ? number(*value) : Json(nullptr); }

// Whole microseconds, as in the log: no rounding noise of the subtraction.
Json seconds(double value) { return number(std::round(value * 1e6) / 1e6); }

Json seconds(const std::optional<double>& value) { return value ? seconds(*value) : Json(nullptr); }

Json vector3(const Eigen::Vector3d& v) {
  return Json::array({number(v.x()), number(v.y()), number(v.z())});
}

Json summary(const std::optional<Summary>& s) {
  const auto get = [&s](double Summary::*member) {
    return s ? number((*s).*member) : Json(nullptr);
  };
  return {{"mean_m", get(&Summary::mean)},
          {"max_m", get(&Summary::max)},
          {"rms_m", get(&Summary::rms)},
          {"p95_m", get(&Summary::p95)},
          {"samples", s ? s->count : 0}};
}

Json meanOf(const std::optional<Summary>& s) { return s ? number(s->mean) : Json(nullptr); }
Json maxOf(const std::optional<Summary>& s) { return s ? number(s->max) : Json(nullptr); }

Json lengthOf(const std::optional<TimeSpan>& span) {
  return span ? seconds(span->length()) : Json(nullptr);
}

Json missionJson(const FlightAnalysis& flight) {
  const Outcome& o = flight.outcome;
  return {{"state", nameOf(o.mission_state, kMissionStateNames)},
          {"failure", nameOf(o.mission_failure, kMissionFailureNames)},
          {"interruption", o.interruption},
          {"waypoints_reached", o.waypoints_reached},
          {"waypoint_count", o.waypoint_count},
          {"plan_in_log", flight.plan && flight.plan->complete()}};
}

Json crossTrackJson(const FlightAnalysis& flight) {
  Json out = summary(flight.cross_track.all);
  out["position_from"] = flight.has_truth ? "truth" : "estimate";
  out["segments"] = Json::array();
  for (const auto& s : flight.cross_track.segments) {
    Json row = {{"waypoint", s.waypoint},
                {"start_m", vector3(s.start)},
                {"target_m", vector3(s.target)},
                {"begin_s", seconds(s.time.begin)},
                {"duration_s", seconds(s.time.length())}};
    row.update(summary(s.cross_track));
    row["closest_approach_m"] = number(s.closest_approach);
    out["segments"].push_back(row);
  }
  return out;
}

Json localizationJson(const LocalizationReport& r) {
  Json out = summary(r.all);
  out["slope_over_length_m_per_m"] = number(r.slope_over_length);
  out["final_reel_scale"] = number(r.final_reel_scale);
  out["true_reel_scale"] = number(r.true_reel_scale);
  return out;
}

Json smoothnessJson(const SmoothnessReport& r) {
  Json changes = nullptr;
  if (r.sign_changes_hz) {
    changes = {{"length", (*r.sign_changes_hz)[0]},
               {"elevation", (*r.sign_changes_hz)[1]},
               {"azimuth", (*r.sign_changes_hz)[2]}};
  }
  return {{"rms_acceleration_mps2", number(r.rms_acceleration)},
          {"rms_jerk_mps3", number(r.rms_jerk)},
          {"flown_length_m", number(r.flown_length)},
          {"planned_length_m", number(r.planned_length)},
          {"path_length_ratio", number(r.path_length_ratio)},
          {"command_sign_changes_hz", changes}};
}

Json loopJson(const LoopReport& r) {
  if (!r.last) return nullptr;
  return {{"period_s", number(r.last->period)},
          {"cycles", r.last->cycles},
          {"overruns", r.last->overruns},
          {"skipped_periods", r.last->skipped},
          {"lateness_mean_s", number(r.lateness_mean)},
          {"lateness_max_s", number(r.lateness_max)},
          {"work_mean_s", number(r.work_mean)},
          {"work_max_s", number(r.work_max)},
          {"work_max_ever_s", number(r.last->work_max_ever)},
          {"publish_errors", r.last->publish_errors},
          {"commands_refused", r.last->commands_refused}};
}

Json tetherJson(const TetherReport& r) {
  Json out = {{"length_min_m", number(r.length_min)},   {"length_max_m", number(r.length_max)},
              {"tension_min_n", number(r.tension_min)}, {"tension_max_n", number(r.tension_max)},
              {"contacts_formed", r.contacts_formed},   {"contact_changes", Json::array()}};
  for (const auto& c : r.contact_changes) {
    out["contact_changes"].push_back({{"t_s", seconds(c.t)},
                                      {"change", c.formed ? "formed" : "relaxed"},
                                      {"active_contact", c.id},
                                      {"contact_count", c.count},
                                      {"position_m", vector3(c.p_WA)}});
  }
  return out;
}

Json channelsJson(const std::vector<ChannelReport>& channels) {
  Json out = Json::array();
  for (const auto& c : channels) {
    out.push_back({{"channel", c.name},
                   {"messages", c.messages},
                   {"undecodable", c.undecodable},
                   {"median_period_s", seconds(c.period)},
                   {"longest_gap_s", seconds(c.longest_gap)},
                   {"gaps", c.gaps}});
  }
  return out;
}

Json modesJson(const std::vector<ModeSpan>& modes) {
  Json out = Json::array();
  for (const auto& m : modes) {
    out.push_back({{"mode", nameOf(m.mode, kModeNames)},
                   {"begin_s", seconds(m.time.begin)},
                   {"duration_s", seconds(m.time.length())},
                   {"reasons", describe(m.reasons)}});
  }
  return out;
}

Json eventsJson(const std::vector<LoggedEvent>& events) {
  Json out = Json::array();
  for (const auto& e : events) {
    out.push_back({{"t_s", seconds(e.t)},
                   {"severity", nameOf(e.severity, kSeverityNames)},
                   {"code", e.code},
                   {"text", e.text},
                   {"reaction", e.reaction},
                   {"remedy", e.remedy}});
  }
  return out;
}

}  // namespace

std::string reportJson(const FlightLog& log, const FlightAnalysis& flight) {
  Json out;
  out["log"] = log.file;
  out["mode"] = flight.run_mode ? Json(nameOf(*flight.run_mode, kRunModeNames)) : Json(nullptr);
  out["outcome"] = flight.outcome.text;
  out["mission_completed"] = flight.outcome.mission_completed;
  out["landed"] = flight.outcome.landed;
  out["flew"] = flight.outcome.flew;
  out["crashed"] = flight.has_truth ? Json(flight.outcome.crashed) : Json(nullptr);
  out["touchdown_speed_mps"] = number(flight.outcome.touchdown_speed);
  out["cross_track_mean_m"] = meanOf(flight.cross_track.all);
  out["cross_track_max_m"] = maxOf(flight.cross_track.all);
  out["localization_mean_m"] = meanOf(flight.localization.all);
  out["localization_max_m"] = maxOf(flight.localization.all);
  out["overruns"] = flight.loop.last ? Json(flight.loop.last->overruns) : Json(nullptr);
  out["durations"] = {{"log_s", seconds(log.duration)},
                      {"airborne_s", lengthOf(flight.airborne)},
                      {"mission_s", lengthOf(flight.mission)}};
  out["start_utime_us"] = log.start_utime;
  out["programs"] = log.programs;
  out["mission"] = missionJson(flight);
  out["cross_track"] = crossTrackJson(flight);
  out["localization"] = localizationJson(flight.localization);
  out["smoothness"] = smoothnessJson(flight.smoothness);
  out["tether"] = tetherJson(flight.tether);
  out["loop"] = loopJson(flight.loop);
  out["modes"] = modesJson(flight.modes);
  out["events"] = eventsJson(log.events);
  out["telemetry"] = channelsJson(flight.channels);
  out["notes"] = flight.notes;
  // Text from the log may be no UTF-8: such bytes are replaced, not fatal.
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace tautline::report
