#include "app/experiments/contact_watching.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include <fmt/format.h>

#include "app/report/series_math.h"
#include "common/mission/mission_file.h"
#include "common/mission/scene.h"
#include "sim_hil/fault.h"

namespace tautline::experiments {
namespace {

constexpr double kTelemetryRate = 100.0;  // [Hz] what a Fotokite sends when asked
constexpr std::array kPulls{0.5, 1.0};    // [N] by turns: what a user of contacts would set
constexpr double kSlip = 0.2;             // [m] along the edge; what is promised
constexpr double kPromised = 1.0;         // [s] and alarms an hour
constexpr Duration kLimit = std::chrono::seconds(150);

/// Conditions that say that the tether is not where the executor has it.
constexpr ConditionSet kTells{Condition::kContactLost, Condition::kContactNotFormed,
                              Condition::kUnplannedContact, Condition::kTetherSnagged};
/// The same with what it says of a tether that slides where it is.
constexpr ConditionSet kTellsSlips = kTells | ConditionSet{Condition::kContactSlipped};

constexpr const char* kWaits = "it is told when the azimuth rate changes next, not before";
constexpr const char* kSmall = "a slip that is hardly more than promised takes longer";
constexpr double kWorst = 60.0;  // of a delay that waits for a change [s]

/// What is wrong, and when it begins in the plant's truth.
struct Kind {
  const char* name;
  const char* scene;
  const char* mission;
  const char* fault;  ///< Of the tether; null: what is wrong is in mission or scene.
  double value;       ///< Of the fault, where it has one.
  double at;          ///< Of the fault [s] after the tether has all contacts of the mission;
                      ///< seeds spread it over the next 1.5 s.
  bool contacts;      ///< The mission has them.
  bool obstacles;     ///< The scene has them.
  bool map_known;
  const char* note;
  double climb{0.0};  ///< The mission's points at a contact are so much higher [m]: a tether that
                      ///< is pulled along the edge slides if it can.
};
constexpr std::array kKinds{
    Kind{"lost, one contact", "one_contact", "one_contact", "contact_off", 0.0, 0.8, true, true,
         true, ""},
    Kind{"lost, two contacts", "two_contacts", "two_contacts", "contact_off", 0.0, 0.8, true, true,
         true, ""},
    Kind{"slipped", "one_contact", "one_contact", "contact_slip", 0.0, 3.0, true, true, true,
         "a contact counts that moves by more than 0.2 m; the friction that is left is none", 0.6},
    Kind{"held half way", "open", "square", "snag", 0.5, 4.0, false, true, true, ""},
    Kind{"unplanned, mapped", "one_contact", "one_contact", nullptr, 0.0, 0.0, false, true, true,
         ""},
    Kind{"unplanned, not mapped", "one_contact", "one_contact", nullptr, 0.0, 0.0, false, true,
         false, ""},
    Kind{"not formed", "one_contact", "one_contact", nullptr, 0.0, 0.0, true, false, false, ""},
};

bool isSlip(const Kind& kind) {
  return kind.fault != nullptr && std::string_view(kind.fault) == "contact_slip";
}

struct Clean {
  const char* scene;
  const char* mission;
};
constexpr std::array kClean{Clean{"open", "square"},
                            Clean{"open", "path1_0.5"},
                            Clean{"open", "path1_1.5"},
                            Clean{"open", "path2_1"},
                            Clean{"one_contact", "one_contact"},
                            Clean{"two_contacts", "two_contacts"}};

int seedCount(const Setup& setup) { return setup.quick ? 2 : 20; }
int cleanCount(const Setup& setup) { return setup.quick ? 1 : 40; }

std::string trialName(const Kind& kind, int seed) { return fmt::format("{} {}", kind.name, seed); }
std::string trialName(const Clean& clean, int seed) {
  return fmt::format("clean {} {}", clean.mission, seed);
}

bench::LockstepConfig configOf(const Setup& setup, const char* scene, int seed) {
  StationConfig station = setup.tautline;
  station.fotokite.telemetry_rate_hz = kTelemetryRate;
  bench::LockstepConfig config = setup.flight(
      station,
      sceneInWorld(readScene(setup.folder / "../scenes" / (std::string(scene) + ".scene.toml"))),
      static_cast<std::uint64_t>(seed));
  pullWith(config, kPulls[static_cast<std::size_t>(seed) % kPulls.size()]);
  return config;
}

std::unique_ptr<MissionPlan> planOf(const Setup& setup, const char* mission, bool contacts) {
  std::unique_ptr<MissionPlan> plan = std::move(
      readMission(setup.folder / "../missions" / (std::string(mission) + ".mission.toml")).plan);
  if (contacts) return plan;
  plan->contact_count = 0;
  for (int i = 0; i < plan->waypoint_count; ++i)
    plan->waypoints[static_cast<std::size_t>(i)].contact = kReelContact;
  return plan;
}

/// The first of the conditions that there is.
const char* nameOfFirst(ConditionSet conditions) {
  for (const ConditionInfo& info : kConditionInfos)
    if (conditions.has(info.condition)) return info.name;
  return "";
}

nlohmann::json flyWrong(const Setup& setup, const Kind& kind, int seed) {
  bench::LockstepConfig config = configOf(setup, kind.scene, seed);
  config.map_known = kind.map_known;
  if (!kind.obstacles) config.world.boxes.clear();
  const std::unique_ptr<MissionPlan> plan = planOf(setup, kind.mission, kind.contacts);
  for (Waypoint& waypoint :
       std::span(plan->waypoints).first(static_cast<std::size_t>(plan->waypoint_count)))
    if (waypoint.contact != kReelContact) waypoint.p_WD.y() += kind.climb;
  bench::Lockstep bench(config, nullptr);
  const double at = kind.at + 1.5 * seed / seedCount(setup);
  const int wanted = plan->contact_count;
  const bool slides = isSlip(kind);
  const ConditionSet tells = slides ? kTellsSlips : kTells;
  std::optional<Time> began, formed, event, told;
  std::string by;
  bool injected = false;
  Eigen::Vector3d p_WA = Eigen::Vector3d::Zero();
  double moved = 0.0;
  static_cast<void>(bench::flyMission(bench, *plan, kLimit, [&](const bench::Lockstep& b) {
    const StepOutput& out = b.output();
    const sim::Truth& truth = b.truth();
    if (!began && out.supervision.mode == Mode::kAuto) began = b.now();
    if (!began || told) return;
    if (kind.fault != nullptr) {
      const bool all = truth.contact_count >= wanted && out.anchor.contact_count >= wanted;
      if (!formed && all) formed = b.now();
      if (!injected && formed && toSeconds(b.now() - *formed) >= at) {
        sim::Fault fault = sim::makeFault("tether", kind.fault);
        fault.at = b.now();
        fault.value = kind.value;
        bench.inject(fault);
        injected = true;
        if (!slides) event = b.now();
        p_WA = truth.p_WA;
      }
      if (injected && all) moved = std::max(moved, (truth.p_WA - p_WA).norm());
      if (slides && !event && moved > kSlip) event = b.now();
    } else if (!event && kind.contacts) {
      if (out.anchor.contact_count > truth.contact_count) event = b.now();
    } else if (!event && truth.contact_count > out.anchor.contact_count) {
      event = b.now();
    }
    if (out.conditions.any(tells)) {
      told = b.now();
      by = nameOfFirst(out.conditions & tells);
    }
  }));
  nlohmann::json result{{"event", event.has_value()},
                        {"told", told.has_value()},
                        {"by", by},
                        {"moved", moved},
                        {"crash", nameOf(bench.truth().crash_reason, sim::kCrashReasonNames)}};
  if (event && told) result["delay"] = toSeconds(*told - *event);
  return result;
}

nlohmann::json flyClean(const Setup& setup, const Clean& clean, int seed) {
  const bench::LockstepConfig config = configOf(setup, clean.scene, seed);
  const std::unique_ptr<MissionPlan> plan = planOf(setup, clean.mission, true);
  bench::Lockstep bench(config, nullptr);
  int alarms = 0;
  std::string by;
  ConditionSet before;
  Eigen::Vector3d p_WA = Eigen::Vector3d::Zero(), made_at = Eigen::Vector3d::Zero();
  bool slid = false;
  double flown = 0.0;
  const double period = 1.0 / config.station.loop_rate_hz;
  static_cast<void>(
      bench::flyMission(bench, *plan, std::chrono::seconds(300), [&](const bench::Lockstep& b) {
        const Anchor& anchor = b.output().anchor;
        if (anchor.p_WA != p_WA || b.truth().contact_count != anchor.contact_count) {
          p_WA = anchor.p_WA;
          made_at = b.truth().p_WA;
          slid = false;
        }
        slid = slid || (b.truth().p_WA - made_at).norm() > 0.5 * kSlip;
        const ConditionSet now = b.output().conditions & kTellsSlips;
        if (!b.truth().on_ground) flown += period;
        ConditionSet came = now.without(before);
        // Friction gives way in an undisturbed flight, too: that is no false alarm.
        if (slid) came = came.without(ConditionSet{Condition::kContactSlipped});
        before = now;
        if (came.empty()) return;
        ++alarms;
        by += std::string(nameOfFirst(came)) + " ";
      }));
  return {{"alarms", alarms}, {"by", by}, {"flown", flown}};
}

std::vector<Trial> trials(const Setup& setup) {
  std::vector<Trial> all;
  for (const Kind& kind : kKinds) {
    for (int seed = 0; seed < seedCount(setup); ++seed)
      all.push_back(
          {trialName(kind, seed), [&setup, &kind, seed] { return flyWrong(setup, kind, seed); }});
  }
  for (const Clean& clean : kClean) {
    for (int seed = 0; seed < cleanCount(setup); ++seed)
      all.push_back({trialName(clean, seed),
                     [&setup, &clean, seed] { return flyClean(setup, clean, seed); }});
  }
  return all;
}

struct Tally {
  int flights{0};
  int happened{0};
  int missed{0};
  double moved{0.0};  ///< Farthest [m].
  int crashed{0};
  int early{0};  ///< Told before it had happened.
  std::vector<double> delays;
  std::map<std::string, int> by;
};

Tally tallyOf(const Setup& setup, const Results& results, const Kind& kind, Sheet& sheet) {
  Tally t;
  for (int seed = 0; seed < seedCount(setup); ++seed) {
    const nlohmann::json& r = results.at(trialName(kind, seed));
    ++t.flights;
    const bool happened = r.at("event");
    const bool told = r.at("told");
    t.happened += happened ? 1 : 0;
    t.early += told && !happened ? 1 : 0;
    t.missed += happened && !told ? 1 : 0;
    t.moved = std::max(t.moved, r.at("moved").get<double>());
    t.crashed += r.at("crash") != "none" ? 1 : 0;
    if (r.contains("delay")) t.delays.push_back(r.at("delay"));
    if (told) ++t.by[r.at("by")];
    sheet.rows.push_back(
        {kind.name, std::to_string(seed), happened ? "1" : "0",
         told ? r.at("by").get<std::string>() : "",
         r.contains("delay") ? fmt::format("{:.2f}", r.at("delay").get<double>()) : "",
         fmt::format("{:.2f}", r.at("moved").get<double>()), r.at("crash").get<std::string>()});
  }
  std::sort(t.delays.begin(), t.delays.end());
  return t;
}

std::string tell(const Tally& t, const Kind& kind) {
  std::string text = fmt::format("{} of {} flights", t.happened, t.flights);
  for (const auto& [name, count] : t.by) text += fmt::format("; {} in {}", name, count);
  if (t.early > 0) text += fmt::format("; told without the event in {}", t.early);
  if (t.moved > 0.0) text += fmt::format("; contact moved by up to {:.2f} m", t.moved);
  if (t.crashed > 0) text += fmt::format("; touched an obstacle in {}", t.crashed);
  if (*kind.note != '\0') text += std::string("; ") + kind.note;
  return text;
}

void judgeKind(const Tally& t, const Kind& kind, Findings& findings) {
  const std::optional<report::Summary> summary = report::summarize(t.delays);
  std::optional<double> median;
  if (!t.delays.empty()) median = t.delays[t.delays.size() / 2];
  const std::string which = kind.name;
  findings.rows.push_back({.figure = "delay, median: " + which, .unit = "s", .tautline = median});
  Row p95{.figure = "delay, 95 %: " + which,
          .unit = "s",
          .tautline_band = Band{.max = kPromised},
          .note = tell(t, kind),
          .shortfall = isSlip(kind) ? kSmall : kWaits,
          .shortfall_limit = Band{.max = kWorst}};
  if (summary) p95.tautline = summary->p95;
  // How far the contact slides without friction is chance; everything else is made to happen.
  const bool by_chance = t.happened == 0 && isSlip(kind);
  if (by_chance) p95.tautline_band.reset();
  findings.rows.push_back(p95);
  findings.rows.push_back(
      {.figure = "missed: " + which,
       .unit = "%",
       .tautline = t.happened > 0 ? std::optional(100.0 * t.missed / t.happened) : std::nullopt,
       .tautline_band = by_chance ? std::nullopt : std::optional(Band{.max = 0.0}),
       .shortfall = isSlip(kind) ? kSmall : kWaits,
       .shortfall_limit = Band{.max = 20.0}});
}

Findings judge(const Setup& setup, const Results& results) {
  Findings findings;
  Sheet sheet{.name = "events",
              .columns = {"kind", "seed", "happened", "told as", "delay_s", "moved_m", "crash"},
              .rows = {}};
  for (const Kind& kind : kKinds) judgeKind(tallyOf(setup, results, kind, sheet), kind, findings);
  double hours = 0.0;
  int alarms = 0;
  std::string by;
  for (const Clean& clean : kClean) {
    for (int seed = 0; seed < cleanCount(setup); ++seed) {
      const nlohmann::json& r = results.at(trialName(clean, seed));
      hours += r.at("flown").get<double>() / 3600.0;
      alarms += r.at("alarms").get<int>();
      by += r.at("by").get<std::string>();
    }
  }
  findings.rows.push_back(
      {.figure = "false alarms",
       .unit = "1/h",
       .tautline = hours > 0.0 ? std::optional(alarms / hours) : std::nullopt,
       .tautline_band = Band{.max = kPromised},
       .note =
           fmt::format("{} in {:.1f} h of flights in which nothing happens {}", alarms, hours, by),
       .shortfall = "as many as promised, within the scatter of so few",
       .shortfall_limit = Band{.max = 2.0 * kPromised}});
  findings.sheets.push_back(std::move(sheet));
  return findings;
}

}  // namespace

const Experiment kContactWatching{
    "observer", "Contact observer",
    "Flights in which a contact comes off, slides, does not form or was not planned, and flights "
    "in "
    "which nothing happens. The delay counts from the event in the plant's truth to the condition "
    "that counts in the station. Half of the flights pull with 0.5 N, half with 1 N; angles and "
    "length come "
    "100 times a second, quantized as a Fotokite does.",
    trials, judge};

}  // namespace tautline::experiments
