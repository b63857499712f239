#include <cmath>

#include <fmt/format.h>

#include "app/report/html.h"
#include "app/report/report_text.h"
#include "common/markup.h"

namespace tautline::report {
namespace {

std::string show(const std::optional<double>& value, int digits, const char* unit,
                 double factor = 1.0) {
  return value && std::isfinite(*value) ? fmt::format("{:.{}f}{}", *value * factor, digits, unit)
                                        : "–";
}

using Member = double Summary::*;
std::optional<double> of(const std::optional<Summary>& s, Member member) {
  return s ? std::optional((*s).*member) : std::nullopt;
}

std::string banner(const Outcome& o) {
  const bool no_mission = o.mission_state == MissionState::kIdle && !o.crashed;
  const char* kind = no_mission ? "none" : o.mission_completed && o.landed ? "good" : "bad";
  return fmt::format("<div class=\"banner {}\">{}</div>\n", kind, escaped(o.text));
}

std::string keyFigures(const FlightAnalysis& flight) {
  std::string out = "<div class=\"key\">\n";
  const auto add = [&out](const std::string& value, const char* what) {
    out += fmt::format("<div><b>{}</b><span>{}</span></div>\n", escaped(value), what);
  };
  const auto length = [](const std::optional<TimeSpan>& s) {
    return s ? std::optional(s->length()) : std::nullopt;
  };
  add(show(of(flight.cross_track.all, &Summary::mean), 3, " m"), "cross-track error, mean");
  add(show(of(flight.cross_track.all, &Summary::max), 3, " m"), "cross-track error, max");
  if (flight.has_truth) {
    add(show(of(flight.localization.all, &Summary::mean), 3, " m"), "localization error, mean");
    add(show(of(flight.localization.all, &Summary::p95), 3, " m"), "localization error, 95 %");
  }
  add(fmt::format("{} / {}", flight.outcome.waypoints_reached, flight.outcome.waypoint_count),
      "waypoints reached");
  add(show(length(flight.mission), 1, " s"), "mission time");
  add(show(length(flight.airborne), 1, " s"), "time in the air");
  add(std::to_string(flight.tether.contacts_formed), "tether contacts formed");
  add(show(flight.tether.length_max, 2, " m"), "longest tether");
  add(show(flight.tether.tension_max, 2, " N"), "largest tension");
  add(show(flight.smoothness.path_length_ratio, 3, ""), "flown / planned length");
  add(flight.loop.last ? std::to_string(flight.loop.last->overruns) : "–", "loop overruns");
  return out + "</div>\n";
}

std::string segmentTable(const FlightAnalysis& flight) {
  if (flight.cross_track.segments.empty()) return {};
  HtmlTable table({"to", "begin [s]", "duration [s]", "length [m]", "mean [m]", "max [m]",
                   "RMS [m]", "closest [m]"});
  for (const auto& s : flight.cross_track.segments) {
    table.add({std::to_string(s.waypoint), show(s.time.begin, 1, ""), show(s.time.length(), 1, ""),
               show((s.target - s.start).norm(), 2, ""),
               show(of(s.cross_track, &Summary::mean), 3, ""),
               show(of(s.cross_track, &Summary::max), 3, ""),
               show(of(s.cross_track, &Summary::rms), 3, ""), show(s.closest_approach, 3, "")});
  }
  return "<h2>Cross-track error by segment</h2>\n" + table.html();
}

std::string modeTable(const FlightAnalysis& flight) {
  if (flight.modes.empty()) return {};
  HtmlTable table({"begin [s]", "duration [s]", "<mode", "<reasons"});
  for (const auto& m : flight.modes) {
    table.add({show(m.time.begin, 1, ""), show(m.time.length(), 1, ""), nameOf(m.mode, kModeNames),
               describe(m.reasons)});
  }
  return "<h2>Modes</h2>\n" + table.html();
}

std::string eventTable(const FlightLog& log) {
  std::string out = "<h2>Events</h2>\n";
  if (log.events.empty()) return out + "<p>None.</p>\n";
  HtmlTable table(
      {"time [s]", "<severity", "<what happened", "<what the station did", "<what you can do"});
  for (const auto& e : log.events) {
    const std::string severity = nameOf(e.severity, kSeverityNames);
    table.add({show(e.t, 2, ""), severity, e.text, e.reaction, e.remedy}, severity);
  }
  return out + table.html();
}

std::string contactTable(const FlightAnalysis& flight) {
  if (flight.tether.contact_changes.empty()) return {};
  HtmlTable table({"time [s]", "<change", "active contact", "contacts", "x [m]", "y [m]", "z [m]"});
  for (const auto& c : flight.tether.contact_changes) {
    table.add({show(c.t, 2, ""), c.formed ? "formed" : "relaxed",
               c.id == 0 ? "reel" : std::to_string(c.id), std::to_string(c.count),
               show(c.p_WA.x(), 2, ""), show(c.p_WA.y(), 2, ""), show(c.p_WA.z(), 2, "")});
  }
  return "<h2>Tether contacts</h2>\n" + table.html();
}

std::string loopTable(const FlightAnalysis& flight) {
  if (!flight.loop.last) return {};
  const LoopSample& last = *flight.loop.last;
  HtmlTable table({"<loop", "value"});
  table.add({"period", show(last.period, 2, " ms", 1e3)});
  table.add({"cycles", std::to_string(last.cycles)});
  table.add({"overruns", std::to_string(last.overruns)});
  table.add({"skipped periods", std::to_string(last.skipped)});
  table.add({"lateness, mean", show(flight.loop.lateness_mean, 1, " µs", 1e6)});
  table.add({"lateness, max", show(flight.loop.lateness_max, 1, " µs", 1e6)});
  table.add({"work, mean", show(flight.loop.work_mean, 1, " µs", 1e6)});
  table.add({"work, max", show(last.work_max_ever, 1, " µs", 1e6)});
  table.add({"publish errors", std::to_string(last.publish_errors)});
  table.add({"commands refused", std::to_string(last.commands_refused)});
  return "<h2>Loop</h2>\n" + table.html();
}

std::string qualityTable(const FlightAnalysis& flight) {
  HtmlTable table({"<figure", "value"});
  const LocalizationReport& l = flight.localization;
  const SmoothnessReport& s = flight.smoothness;
  if (flight.has_truth) {
    table.add({"localization error, max", show(of(l.all, &Summary::max), 3, " m")});
    table.add(
        {"localization error, growth with tether length", show(l.slope_over_length, 4, " m/m")});
    table.add({"reel scale at the end, estimated / true",
               show(l.final_reel_scale, 4, "") + " / " + show(l.true_reel_scale, 4, "")});
    table.add({"touch-down speed", show(flight.outcome.touchdown_speed, 2, " m/s")});
  }
  table.add({"acceleration, RMS", show(s.rms_acceleration, 3, " m/s²")});
  table.add({"jerk, RMS", show(s.rms_jerk, 3, " m/s³")});
  table.add({"path flown / planned",
             show(s.flown_length, 2, " m") + " / " + show(s.planned_length, 2, " m")});
  if (s.sign_changes_hz) {
    constexpr std::array<const char*, 3> kNames{"length", "elevation", "azimuth"};
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      table.add({std::string("sign changes of the ") + kNames[i] + " command",
                 show((*s.sign_changes_hz)[i], 2, " /s")});
    }
  }
  return "<h2>Localization and smoothness</h2>\n" + table.html();
}

std::string telemetryTable(const FlightAnalysis& flight) {
  HtmlTable table(
      {"<channel", "messages", "median period [s]", "longest gap [s]", "gaps", "undecodable"});
  for (const auto& c : flight.channels) {
    table.add({c.name, std::to_string(c.messages), show(c.period, 3, ""),
               show(c.longest_gap, 3, ""), std::to_string(c.gaps), std::to_string(c.undecodable)});
  }
  return "<h2>Telemetry</h2>\n" + table.html();
}

}  // namespace

std::string reportHtml(const FlightLog& log, const FlightAnalysis& flight,
                       const std::vector<EmbeddedPicture>& pictures) {
  std::string out = "<h1>Flight report – " + escaped(runModeName(flight)) + "</h1>\n";
  const std::string start = startTimeText(log);
  out += fmt::format("<p class=\"about\">{}{}{:.1f} s</p>\n", escaped(log.file),
                     start.empty() ? " · " : " · " + start + " · ", log.duration);
  out += banner(flight.outcome) + keyFigures(flight);
  for (const auto& note : flight.notes)
    out += "<p class=\"about\">Note: " + escaped(note) + "</p>\n";
  for (const auto& picture : pictures) out += htmlFigure(picture);
  out += segmentTable(flight) + contactTable(flight) + modeTable(flight) + eventTable(log) +
         qualityTable(flight) + loopTable(flight) + telemetryTable(flight);
  return htmlPage("Flight report", out);
}

}  // namespace tautline::report
