#include "app/experiments/real_logs.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "app/experiments/published_flights.h"
#include "app/experiments/replayed_flight.h"
#include "app/station/fence_scene.h"
#include "common/error.h"
#include "common/mission/mission_file.h"
#include "common/mission/scene.h"
#include "common/toml/toml_file.h"

namespace tautline::experiments {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kUnpacked = "build/published_logs";
constexpr double kAirborne = 20.0;  // shorter logs are no flights: their rates say nothing [s]

/// Logs without contact columns whose programs steered round contacts all the same: from some row
/// on positions follow from another point than the reel.
constexpr std::array<const char*, 3> kContactsNotLogged{"20180131190522", "20180201162009",
                                                        "20180205171205"};

/// By the content, too: another file is another trial.
struct Log {
  std::string name;   ///< Its date and time.
  std::string trial;  ///< Name of the trial.
  fs::path file;
};

std::vector<Log> logs() {
  const std::optional<fs::path> archive = publishedLogs();
  if (!archive)
    throw InputError({.key = "TAUTLINE_DATA", .problem = "has no flight logs"}, ExitCode::kFailed);
  std::vector<Log> all;
  for (const fs::path& file : unpackLogs(*archive, kUnpacked)) {
    const std::string name = file.stem().string();
    all.push_back({name, name + " " + hashText(fnv1a(readTextFile(file))), file});
  }
  return all;
}

bool contactsAreLogged(const std::string& name) {
  return std::find(kContactsNotLogged.begin(), kContactsNotLogged.end(), name) ==
         kContactsNotLogged.end();
}

json trackOf(const Recording& recording) {
  json track = json::array();
  std::uint32_t sample = 0;
  const std::vector<Eigen::Vector3d> contacts = contactsOf(recording);
  for (std::size_t i = 0; i < recording.cycles.size(); ++i) {
    const std::uint32_t sequence = recording.cycles[i].sensors.angles.sequence;
    if (sequence == sample) continue;
    sample = sequence;
    const FlightLogRow& row = recording.poses[i].row;
    int active = 0;
    for (std::size_t c = 0; c < contacts.size(); ++c)
      if ((contacts[c] - row.p_WA).norm() < 1e-5) active = static_cast<int>(c) + 1;
    track.push_back({row.p_WD.x(), row.p_WD.y(), row.p_WD.z(), active});
  }
  return track;
}

json jsonOf(const SupervisorVerdict& verdict) {
  json raised = json::array();
  for (const SupervisorVerdict::Raised& r : verdict.raised) {
    raised.push_back({{"condition", describe(ConditionSet{r.condition})},
                      {"first_s", r.first},
                      {"lasted_s", r.lasted}});
  }
  return {{"intervened_s", verdict.intervened ? json(*verdict.intervened) : json(nullptr)},
          {"mode", nameOf(verdict.mode, kModeNames)},
          {"last_mode", nameOf(verdict.last_mode, kModeNames)},
          {"reasons", describe(verdict.reasons)},
          {"raised", raised},
          {"usable", verdict.usable},
          {"reel_scale", verdict.reel_scale},
          {"sigma_reel_scale", verdict.sigma_reel_scale}};
}

/// A log in which nothing was ever out has no flight.
json replay(const Setup& setup, const Log& log) {
  Recording recording;
  try {
    recording = readRecording(log.file);
  } catch (const InputError&) {
    return {{"flight", false}};
  }
  const bool with_contacts =
      std::any_of(recording.poses.begin(), recording.poses.end(),
                  [](const RecordedPose& pose) { return !pose.row.p_WA.isZero(); });
  const LogAgreement same = agreement(recording, setup.as_published, with_contacts);
  const LogFigures figures = figuresOf(recording);
  StationConfig ours = setup.tautline;
  const std::vector<Eigen::Vector3d> contacts = contactsOf(recording);
  if (!contacts.empty()) {
    ours.core.fence.obstacles = fenceObstaclesOf(
        sceneInWorld(readScene(setup.folder / "../scenes/dissertation/shaft.scene.toml")));
  }
  json result = {{"flight", true},
                 {"columns", with_contacts ? 22 : 19},
                 {"rows", same.rows},
                 {"skipped", recording.skipped},
                 {"uninitialized", recording.uninitialized},
                 {"position_m", same.position},
                 {"position_off", same.position_off},
                 {"targets", same.targets},
                 {"other_target", same.other_target},
                 {"target_length_m", same.target_length},
                 {"target_elevation_rad", same.target_elevation},
                 {"target_azimuth_rad", same.target_azimuth},
                 {"contacts", contacts.size()},
                 {"duration_s", figures.duration},
                 {"lengths", figures.lengths},
                 {"quantum_m", figures.quantum ? json(*figures.quantum) : json(nullptr)},
                 {"new_samples_per_s", figures.new_samples},
                 {"fullest_second", figures.fullest_second},
                 {"supervisor", jsonOf(verdictOn(recording, ours))}};
  if (!contacts.empty()) {
    result["track"] = trackOf(recording);
    result["contact_points"] = json::array();
    for (const Eigen::Vector3d& c : contacts)
      result["contact_points"].push_back({c.x(), c.y(), c.z()});
  }
  return result;
}

std::vector<Trial> trials(const Setup& setup) {
  std::vector<Trial> all;
  for (const Log& log : logs())
    all.push_back({log.trial, [&setup, log] { return replay(setup, log); }});
  return all;
}

/// A log with what came of it.
struct Flight {
  std::string name;
  json result;

  [[nodiscard]] double number(const char* key) const { return result.at(key).get<double>(); }
  [[nodiscard]] bool hasContacts() const { return number("contacts") > 0; }
};

template <class Chosen>
double largest(const std::vector<Flight>& flights, const char* key, Chosen chosen) {
  double value = 0.0;
  for (const Flight& f : flights)
    if (chosen(f)) value = std::max(value, f.number(key));
  return value;
}

template <class Chosen>
double sum(const std::vector<Flight>& flights, const char* key, Chosen chosen) {
  double value = 0.0;
  for (const Flight& f : flights)
    if (chosen(f)) value += f.number(key);
  return value;
}

void judgeAgreement(const std::vector<Flight>& flights, std::vector<Row>& rows) {
  constexpr Band kPosition{.min = 0.0, .max = 2e-3};  // [m]
  constexpr Band kTarget{.min = 0.0, .max = 2e-5};    // [m], [rad]
  const auto with_contacts = [](const Flight& f) { return f.hasContacts(); };
  const auto logged = [](const Flight& f) { return contactsAreLogged(f.name); };
  const auto unlogged = [](const Flight& f) { return !contactsAreLogged(f.name); };
  rows.push_back({.figure = "logs with a flight in them",
                  .published = 57,
                  .as_published = static_cast<double>(flights.size()),
                  .as_published_band = Band{53, 57}});
  rows.push_back({.figure = "flights with contacts",
                  .published = 5,
                  .as_published = static_cast<double>(
                      std::count_if(flights.begin(), flights.end(), with_contacts)),
                  .as_published_band = Band{5, 5}});
  rows.push_back({.figure = "position from length, angles and contact, largest difference",
                  .unit = "m",
                  .as_published = largest(flights, "position_m", logged),
                  .as_published_band = kPosition,
                  .note = fmt::format("{:.0f} rows; three flights steered round contacts that are "
                                      "not in their logs and are not in it",
                                      sum(flights, "rows", logged))});
  rows.push_back({.figure = "rows that do not follow, in the three flights",
                  .as_published = sum(flights, "position_off", unlogged),
                  .note = fmt::format("of {:.0f}", sum(flights, "rows", unlogged))});
  rows.push_back(
      {.figure = "rows left out for numbers that were never set",
       .as_published = sum(flights, "uninitialized", [](const Flight&) { return true; })});
  rows.push_back({.figure = "executor's target length, flights with contacts, largest difference",
                  .unit = "m",
                  .as_published = largest(flights, "target_length_m", with_contacts),
                  .as_published_band = kTarget,
                  .note = fmt::format("{:.0f} rows", sum(flights, "targets", with_contacts))});
  rows.push_back({.figure = "its target elevation",
                  .unit = "rad",
                  .as_published = largest(flights, "target_elevation_rad", with_contacts),
                  .as_published_band = kTarget});
  rows.push_back({.figure = "its target azimuth",
                  .unit = "rad",
                  .as_published = largest(flights, "target_azimuth_rad", with_contacts),
                  .as_published_band = kTarget});
  rows.push_back({.figure = "rows in which the executor was at another waypoint than the log",
                  .as_published = sum(flights, "other_target", with_contacts),
                  .as_published_band = Band{0, 0}});
}

void judgeMachine(const std::vector<Flight>& flights, std::vector<Row>& rows) {
  constexpr double kMillimetre = 1e3;
  const auto airborne = [](const Flight& f) { return f.number("duration_s") > kAirborne; };
  double least = std::numeric_limits<double>::infinity();
  double most = 0.0;
  double samples = 0.0;
  for (const Flight& f : flights) {
    if (!f.result.at("quantum_m").is_null()) {
      least = std::min(least, f.number("quantum_m"));
      most = std::max(most, f.number("quantum_m"));
    }
    if (airborne(f)) samples += f.number("new_samples_per_s") * f.number("duration_s");
  }
  constexpr Band kQuantum{4.055, 4.065};  // [mm]: the three digits of the published figure
  for (const auto& [figure, value] :
       {std::pair("length of a count, least of all flights", least),
        std::pair("length of a count, largest of all flights", most)}) {
    rows.push_back({.figure = figure,
                    .unit = "mm",
                    .published = kLoggedMetresPerCount * kMillimetre,
                    .as_published = value * kMillimetre,
                    .as_published_band = kQuantum,
                    .note =
                        "the device's calibration of April is 2.85 mm: these flights read their "
                        "tether 42 % too long"});
  }
  rows.push_back({.figure = "new lengths and directions",
                  .unit = "1/s",
                  .published = 1.9,
                  .as_published = samples / sum(flights, "duration_s", airborne),
                  .as_published_band = Band{1.71, 2.09},
                  .note = fmt::format("flights of more than {:g} s", kAirborne)});
  rows.push_back(
      {.figure = "cycles of the loop",
       .unit = "1/s",
       .published = 260,
       .as_published = largest(flights, "fullest_second", [](const Flight&) { return true; }),
       .as_published_band = Band{247, 273},
       .note = "rows of the fullest second: repeated rows are not in the logs, so only a "
               "second in which every cycle changes something shows the loop"});
}

void judgeSupervisor(const std::vector<Flight>& flights, std::vector<Row>& rows) {
  double flown = 0.0;
  double intervened = 0.0;
  double usable = 0.0;
  for (const Flight& f : flights) {
    if (f.number("duration_s") <= kAirborne) continue;
    const json& s = f.result.at("supervisor");
    flown += 1.0;
    intervened += s.at("intervened_s").is_null() ? 0.0 : 1.0;
    usable += s.at("usable").get<double>();
  }
  rows.push_back(
      {.figure = "flights that our supervisor would have broken off",
       .tautline = intervened,
       .note = fmt::format("of {:g} of more than {:g} s; when and why: table", flown, kAirborne)});
  rows.push_back({.figure = "time with a usable estimate, ours",
                  .unit = "%",
                  .tautline = flown > 0.0 ? 100.0 * usable / flown : 0.0});
}

std::string supervisorText(const json& s) {
  if (s.at("intervened_s").is_null()) return "–";
  return fmt::format("{} after {:.1f} s: {}", s.at("mode").get<std::string>(),
                     s.at("intervened_s").get<double>(), s.at("reasons").get<std::string>());
}

std::string raisedText(const json& s) {
  std::string text;
  for (const json& r : s.at("raised")) {
    text += fmt::format("{}{} {:.0f} s", text.empty() ? "" : ", ",
                        r.at("condition").get<std::string>(), r.at("lasted_s").get<double>());
  }
  return text.empty() ? "–" : text;
}

Sheet tableOf(const std::vector<Flight>& flights) {
  Sheet sheet{.name = "flights",
              .columns = {"<flight", "columns", "rows", "left out", "never set", "duration [s]",
                          "position off by at most [m]", "rows off by more than 2 mm", "contacts",
                          "count [mm]", "new samples [1/s]", "rows in the fullest second",
                          "<supervisor", "<what it would have seen", "reel scale, ours"},
              .rows = {},
              .caption =
                  "All flights. The supervisor's words are about sensors alone: the logs have "
                  "no attitude, no voltages and no commands."};
  for (const Flight& f : flights) {
    const json& r = f.result;
    const json& s = r.at("supervisor");
    sheet.rows.push_back(
        {f.name, fmt::format("{}", r.at("columns").get<int>()),
         fmt::format("{}", r.at("rows").get<int>()), fmt::format("{}", r.at("skipped").get<int>()),
         fmt::format("{}", r.at("uninitialized").get<int>()),
         fmt::format("{:.1f}", f.number("duration_s")),
         fmt::format("{:.2g}", f.number("position_m")),
         fmt::format("{}", r.at("position_off").get<int>()),
         fmt::format("{}", r.at("contacts").get<int>()),
         r.at("quantum_m").is_null() ? "–" : fmt::format("{:.4f}", 1e3 * f.number("quantum_m")),
         fmt::format("{:.2f}", f.number("new_samples_per_s")),
         fmt::format("{}", r.at("fullest_second").get<int>()), supervisorText(s), raisedText(s),
         fmt::format("{:.2f} ± {:.2f}", s.at("reel_scale").get<double>(),
                     s.at("sigma_reel_scale").get<double>())});
  }
  return sheet;
}

plot::Panel trackPanel(const Flight& flight) {
  constexpr std::array kColours{plot::Colour::kBlue, plot::Colour::kOrange,
                                plot::Colour::kVermilion};
  plot::Panel panel;
  panel.title = flight.name;
  panel.x = {.label = "x [m]"};
  panel.y = {.label = "z [m]"};
  panel.equal_aspect = true;
  panel.polygons.push_back(
      {.outline = {{1.32, 1.32}, {1.65, 1.32}, {1.65, 1.65}, {1.32, 1.65}}, .name = "shaft"});
  for (std::size_t contacts = 0; contacts < kColours.size(); ++contacts) {
    plot::Series series;
    series.name = contacts == 0 ? "no contact" : fmt::format("{} contacts", contacts);
    if (contacts == 1) series.name = "1 contact";
    series.colour = kColours[contacts];
    series.style = plot::Style::kPoints;
    series.width = 0.6;
    for (const json& point : flight.result.at("track"))
      if (point.at(3).get<std::size_t>() == contacts)
        series.points.push_back({point.at(0).get<double>(), point.at(2).get<double>()});
    if (!series.points.empty()) panel.series.push_back(series);
  }
  panel.markers.push_back(
      {.at = {0.0033, 0.0033}, .label = "reel", .symbol = plot::Symbol::kSquare});
  for (const json& c : flight.result.at("contact_points"))
    panel.markers.push_back(
        {.at = {c.at(0).get<double>(), c.at(2).get<double>()}, .symbol = plot::Symbol::kCross});
  return panel;
}

Findings judge(const Setup& /*setup*/, const Results& results) {
  std::vector<Flight> flights;
  for (const Log& log : logs()) {
    const json& result = results.at(log.trial);
    if (result.at("flight").get<bool>()) flights.push_back({log.name, result});
  }
  Findings findings;
  judgeAgreement(flights, findings.rows);
  judgeMachine(flights, findings.rows);
  judgeSupervisor(flights, findings.rows);
  findings.sheets.push_back(tableOf(flights));
  Picture tracks{.name = "tracks",
                 .caption =
                     "The flights with contacts from above, where their program thought the "
                     "drone was, by the contacts that it worked with (crosses).",
                 .figure = {.rows = 2, .columns = 3, .width_px = 1200, .height_px = 800}};
  for (const Flight& flight : flights)
    if (flight.hasContacts()) tracks.figure.panels.push_back(trackPanel(flight));
  findings.pictures.push_back(tracks);
  return findings;
}

}  // namespace

const Experiment kRealLogs{
    "real_logs", "Real flights",
    "57 text logs of the dissertation's own flights, January and February 2018, five of them with "
    "tether contacts: each row's length and angles as the device's telegrams, through our driver, "
    "the published estimator and executor, held against what the log says; then through our "
    "estimator, detectors and supervisor.",
    trials, judge};

}  // namespace tautline::experiments
