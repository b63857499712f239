#include <cmath>

#include <fmt/format.h>

#include "app/report/report_text.h"
#include "common/markup.h"

namespace tautline::report {
namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: light; }
body { font: 15px/1.45 system-ui, sans-serif; color: #222; background: #fff; margin: 0 auto; max-width: 960px; padding: 0 16px 48px; }
h1 { font-size: 1.5em; margin: 20px 0 4px; }
h2 { font-size: 1.15em; margin: 32px 0 8px; }
p.about { color: #666; margin: 0 0 12px; overflow-wrap: anywhere; }
.banner { border-left: 6px solid; border-radius: 4px; padding: 12px 16px; font-size: 1.1em; font-weight: 600; }
.good { background: #e6f4ee; border-color: #009e73; }
.bad { background: #fbeae0; border-color: #d55e00; }
.none { background: #f0f0f0; border-color: #808080; }
.key { display: grid; grid-template-columns: repeat(auto-fill, minmax(140px, 1fr)); gap: 10px; margin: 16px 0; }
.key div { background: #f6f7f8; border-radius: 4px; padding: 8px 12px; }
.key b { display: block; font-size: 1.35em; font-variant-numeric: tabular-nums; }
.key span { color: #666; font-size: 0.87em; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: right; padding: 4px 8px; border-bottom: 1px solid #e4e4e4; white-space: nowrap; }
th { color: #666; font-weight: 500; border-bottom-color: #bbb; }
td.text, th.text { text-align: left; white-space: normal; }
figure { margin: 16px 0; }
figure svg { width: 100%; height: auto; }
figcaption { color: #666; font-size: 0.9em; }
.error td, .critical td { background: #fbeae0; }
.warning td { background: #fdf5e0; }
)";

std::string show(const std::optional<double>& value, int digits, const char* unit,
                 double factor = 1.0) {
  return value && std::isfinite(*value) ? fmt::format("{:.{}f}{}", *value * factor, digits, unit)
                                        : "–";
}

using Member = double Summary::*;
std::optional<double> of(const std::optional<Summary>& s, Member member) {
  return s ? std::optional((*s).*member) : std::nullopt;
}

// A table row by row; columns that start with '<' hold text.
class Table {
 public:
  explicit Table(const std::vector<std::string>& columns) {
    for (const auto& column : columns) {
      is_text_.push_back(column.starts_with('<'));
      html_ += is_text_.back() ? "<th class=\"text\">" + escaped(column.substr(1))
                               : "<th>" + escaped(column);
      html_ += "</th>";
    }
    html_ = "<div class=\"scroll\"><table>\n<tr>" + html_ + "</tr>\n";
  }
  void add(const std::vector<std::string>& cells, const std::string& row_class = {}) {
    html_ += row_class.empty() ? "<tr>" : "<tr class=\"" + row_class + "\">";
    for (std::size_t i = 0; i < cells.size(); ++i)
      html_ += (is_text_[i] ? "<td class=\"text\">" : "<td>") + escaped(cells[i]) + "</td>";
    html_ += "</tr>\n";
  }
  [[nodiscard]] std::string html() const { return html_ + "</table></div>\n"; }

 private:
  std::vector<bool> is_text_;
  std::string html_;
};

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
  Table table({"to", "begin [s]", "duration [s]", "length [m]", "mean [m]", "max [m]", "RMS [m]",
               "closest [m]"});
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
  Table table({"begin [s]", "duration [s]", "<mode", "<reasons"});
  for (const auto& m : flight.modes) {
    table.add({show(m.time.begin, 1, ""), show(m.time.length(), 1, ""), nameOf(m.mode, kModeNames),
               describe(m.reasons)});
  }
  return "<h2>Modes</h2>\n" + table.html();
}

std::string eventTable(const FlightLog& log) {
  std::string out = "<h2>Events</h2>\n";
  if (log.events.empty()) return out + "<p>None.</p>\n";
  Table table(
      {"time [s]", "<severity", "<what happened", "<what the station did", "<what you can do"});
  for (const auto& e : log.events) {
    const std::string severity = nameOf(e.severity, kSeverityNames);
    table.add({show(e.t, 2, ""), severity, e.text, e.reaction, e.remedy}, severity);
  }
  return out + table.html();
}

std::string contactTable(const FlightAnalysis& flight) {
  if (flight.tether.contact_changes.empty()) return {};
  Table table({"time [s]", "<change", "active contact", "contacts", "x [m]", "y [m]", "z [m]"});
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
  Table table({"<loop", "value"});
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
  Table table({"<figure", "value"});
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
  Table table(
      {"<channel", "messages", "median period [s]", "longest gap [s]", "gaps", "undecodable"});
  for (const auto& c : flight.channels) {
    table.add({c.name, std::to_string(c.messages), show(c.period, 3, ""),
               show(c.longest_gap, 3, ""), std::to_string(c.gaps), std::to_string(c.undecodable)});
  }
  return "<h2>Telemetry</h2>\n" + table.html();
}

// The picture without what belongs to a file of its own; its ids made unique in the page.
std::string inlineSvg(const EmbeddedPicture& picture) {
  const std::size_t begin = picture.svg.find("<svg");
  std::string svg = begin == std::string::npos ? std::string() : picture.svg.substr(begin);
  for (const char* id : {"'gp", "#gp", "\"gnuplot_", "'gnuplot_", "#gnuplot_", "\"textbox",
                         "'textbox", "#textbox", "\"greybox", "'greybox", "#greybox"}) {
    for (std::size_t at = svg.find(id); at != std::string::npos;
         at = svg.find(id, at + picture.name.size() + 2)) {
      svg.insert(at + 1, picture.name + "_");
    }
  }
  return svg;
}

}  // namespace

std::string reportHtml(const FlightLog& log, const FlightAnalysis& flight,
                       const std::vector<EmbeddedPicture>& pictures) {
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>Flight "
      "report</title>\n<style>";
  out += std::string(kStyle) + "</style>\n</head>\n<body>\n<h1>Flight report – " +
         escaped(runModeName(flight)) + "</h1>\n";
  const std::string start = startTimeText(log);
  out += fmt::format("<p class=\"about\">{}{}{:.1f} s</p>\n", escaped(log.file),
                     start.empty() ? " · " : " · " + start + " · ", log.duration);
  out += banner(flight.outcome) + keyFigures(flight);
  for (const auto& note : flight.notes)
    out += "<p class=\"about\">Note: " + escaped(note) + "</p>\n";
  for (const auto& picture : pictures) {
    out += "<figure>\n" + inlineSvg(picture) + "<figcaption>" + escaped(picture.caption) +
           "</figcaption>\n</figure>\n";
  }
  out += segmentTable(flight) + contactTable(flight) + modeTable(flight) + eventTable(log) +
         qualityTable(flight) + loopTable(flight) + telemetryTable(flight);
  return out + "</body>\n</html>\n";
}

}  // namespace tautline::report
