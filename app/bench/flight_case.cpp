#include "app/bench/flight_case.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <sstream>

#include <fmt/format.h>

#include "common/toml/config_file.h"

namespace tautline::bench {
namespace {

namespace fs = std::filesystem;

constexpr Duration kDefaultWithin = std::chrono::seconds(5);

double heightOf(const Rig& rig) { return rig.truth().p_WD.y() - rig.floor(); }

/// Speed that the station asks for, as far as tether length and elevation say [m/s].
double commandedSpeedOf(const Rig& rig) {
  const VehicleCommand& c = rig.output().command;
  const double L = rig.truth().length;
  return std::hypot(c.length_rate, std::hypot(L * c.elevation_rate, L * c.azimuth_rate));
}

constexpr std::array kQuantities{
    Quantity{"height_m", heightOf},
    Quantity{"speed_mps", [](const Rig& rig) { return rig.truth().v_WD.norm(); }},
    Quantity{"tension_n", [](const Rig& rig) { return rig.truth().tension; }},
    Quantity{"tether_length_m", [](const Rig& rig) { return rig.truth().length; }},
    Quantity{"commanded_speed_mps", commandedSpeedOf},
    Quantity{"localization_error_m",
             [](const Rig& rig) { return (rig.output().estimate.p_WD - rig.truth().p_WD).norm(); }},
};

/// The entry of that name; throws with the names there are.
template <class Entries>
const auto& named(const TomlTable& table, const char* key, const std::string& name,
                  const Entries& entries) {
  const auto found =
      std::find_if(entries.begin(), entries.end(), [&](const auto& e) { return name == e.name; });
  if (found != entries.end()) return *found;
  std::string allowed;
  for (const auto& e : entries) allowed += (allowed.empty() ? "" : ", ") + std::string(e.name);
  throw table.error(key, "\"" + name + "\" is none", allowed);
}

EventCode eventNamed(const TomlTable& table, const std::string& text) {
  std::string allowed;
  for (const EventText& e : kEventTexts) {
    if (text == e.text) return e.code;
    allowed += (allowed.empty() ? "" : ", ") + std::string(e.text);
  }
  throw table.error("event", "\"" + text + "\" is none", allowed);
}

Duration readSeconds(TomlTable& table, const char* key, Duration value = {}) {
  double seconds = toSeconds(value);
  table.read(key, seconds, Range{0, 1e5});
  return fromSeconds(seconds);
}

Phase readPhase(TomlTable& table) {
  std::string text;
  table.read("phase", text);
  return parsePhase(table, text);
}

template <class Config>
void readConfig(TomlTable& table, const char* key, const fs::path& folder, Config& config) {
  if (std::string path; table.read(std::string(key) + "_config", path))
    config = loadConfig<Config>(folder / path);
  for (TomlTable& changes : table.table(key)) ConfigReader::readStruct(std::move(changes), config);
}

/// What an operator does who flies the mission and lands.
std::vector<OperatorEntry> missionScript() {
  using namespace std::chrono_literals;
  const auto after = [](Mode mode) { return Phase{Phase::Kind::kMode, mode, {}}; };
  return {{{}, false, 1s, Request::kArm, 5s, {}},
          {after(Mode::kArmed), false, 1s, Request::kTakeoff, {}, {}},
          {after(Mode::kHold), false, 3s, Request::kNavigate, {}, {}},
          {after(Mode::kHold), true, 8s, Request::kLand, {}, {}}};
}

}  // namespace

std::string ModeSet::text() const {
  std::string list;
  for (const auto& entry : kModeNames) {
    if (has(entry.value)) list += (list.empty() ? "" : " or ") + std::string(entry.name);
  }
  return list;
}

std::string Expectation::text() const {
  switch (kind) {
    case Kind::kMode:
      return modes.text();
    case Kind::kCondition:
      return describe(conditions);
    case Kind::kClear:
      return "no " + describe(conditions);
    case Kind::kEvent:
      return fmt::format("\"{}\"", textOf(event).text);
    case Kind::kBound:
      return fmt::format("{} from {:g} to {:g}", quantity->name, range.min, range.max);
  }
  return {};
}

ModeSet readModes(TomlTable& table, const char* key) {
  ModeSet set;
  std::string text;
  table.read(key, text);
  std::istringstream words(text);
  for (std::string word; words >> word;) set.add(named(table, key, word, kModeNames).value);
  return set;
}

Request readRequest(TomlTable& table, const char* key) {
  std::string verb = nameOf(Request::kNone, kRequestNames);
  table.read(key, verb);
  return named(table, key, verb, kRequestNames).value;
}

ConditionSet readConditions(TomlTable& table, const char* key) {
  ConditionSet set;
  std::string text;
  table.read(key, text);
  std::istringstream words(text);
  for (std::string word; words >> word;) set.set(named(table, key, word, kConditionNames).value);
  return set;
}

Phase parsePhase(const TomlTable& table, const std::string& text) {
  if (text.empty()) return {};
  if (text == "FAULT") return {Phase::Kind::kFault, {}, {}};
  for (const auto& entry : kModeNames) {
    if (text == entry.name) return {Phase::Kind::kMode, entry.value, {}};
  }
  for (const auto& entry : kConditionNames) {
    if (text == entry.name) return {Phase::Kind::kCondition, {}, entry.value};
  }
  std::string allowed = "FAULT";
  for (const auto& entry : kModeNames) allowed += std::string(", ") + entry.name;
  for (const auto& entry : kConditionNames) allowed += std::string(", ") + entry.name;
  throw table.error("phase", "\"" + text + "\" is none", allowed);
}

std::vector<OperatorEntry> readScript(TomlTable& root) {
  std::vector<OperatorEntry> script;
  for (TomlTable& table : root.tables("operator")) {
    OperatorEntry entry;
    entry.phase = readPhase(table);
    if (std::string mode; table.read("in", mode)) {
      entry.phase = {Phase::Kind::kMode, named(table, "in", mode, kModeNames).value, {}};
      entry.in_mode = true;
    }
    entry.at = readSeconds(table, "at_s");
    entry.retry = readSeconds(table, "retry_s");
    std::vector<double> sticks;
    if (table.read("sticks", sticks, Range{-2, 2})) {
      if (sticks.size() != 3)
        throw table.error("sticks", "has " + std::to_string(sticks.size()) + " rates",
                          "[length m/s, elevation rad/s, azimuth rad/s]");
      entry.sticks = TeleopRates{.length = sticks[0], .elevation = sticks[1], .azimuth = sticks[2]};
    } else {
      if (!table.has("verb")) throw table.error("verb", "is missing", "a verb, or sticks");
      entry.verb = readRequest(table, "verb");
    }
    table.finish();
    script.push_back(entry);
  }
  return script;
}

std::vector<ModeSequence> readSequence(TomlTable& root) {
  std::vector<ModeSequence> sequence;
  for (TomlTable& table : root.tables("sequence")) {
    std::string from;
    table.require("from", from);
    sequence.push_back({named(table, "from", from, kModeNames).value, readModes(table, "to")});
    table.finish();
  }
  return sequence;
}

FaultPlan planFault(const TomlTable& table, const sim::FaultEntry& entry) {
  return {parsePhase(table, entry.phase), entry.fault};
}

Expectation readExpectation(TomlTable& table) {
  Expectation e;
  e.phase = readPhase(table);
  e.after = readSeconds(table, "after_s");
  e.within = readSeconds(table, "within_s", kDefaultWithin);
  const int count = static_cast<int>(table.has("mode")) + static_cast<int>(table.has("condition")) +
                    static_cast<int>(table.has("clear")) + static_cast<int>(table.has("event")) +
                    static_cast<int>(table.has("bound"));
  if (count != 1)
    throw table.error("", "expects " + std::to_string(count) + " things",
                      "one of mode, condition, clear, event, bound");
  std::string text;
  e.modes = readModes(table, "mode");
  if (table.has("condition") || table.has("clear")) {
    const bool clear = table.has("clear");
    e.kind = clear ? Expectation::Kind::kClear : Expectation::Kind::kCondition;
    e.conditions = readConditions(table, clear ? "clear" : "condition");
  } else if (table.read("event", text)) {
    e.kind = Expectation::Kind::kEvent;
    e.event = eventNamed(table, text);
  } else if (table.read("bound", text)) {
    e.kind = Expectation::Kind::kBound;
    e.quantity = &named(table, "bound", text, kQuantities);
    table.read("min", e.range.min);
    table.read("max", e.range.max);
  }
  return e;
}

void readSurroundings(TomlTable& table, const std::string& file, FlightCase& flight) {
  const fs::path folder = fs::path(file).parent_path();
  std::string scene_file;
  table.require("scene", scene_file);
  const Scene scene = readScene(folder / scene_file);
  for (TomlTable& obstacle : table.tables("obstacle")) {
    Box box;
    box.name = "obstacle that no map has";
    obstacle.require("min_m", box.min, Range{-1000, 1000});
    obstacle.require("max_m", box.max, Range{-1000, 1000});
    obstacle.finish();
    if (!(box.min.array() < box.max.array()).all())
      throw obstacle.error("max_m", "is not above min_m", "min_m < max_m in every component");
    box.min -= scene.reel;
    box.max -= scene.reel;
    flight.bench.unmapped.push_back(box);
  }
  flight.bench.world = sceneInWorld(scene);
  if (std::string mission; table.read("mission", mission))
    flight.mission =
        std::shared_ptr<const MissionPlan>(readMission(folder / mission).plan.release());
  readConfig(table, "station", folder, flight.bench.station);
  readConfig(table, "sim", folder, flight.bench.sim);
}

FlightCase readScenario(const std::string& file) {
  TomlTable root = TomlFile::load(file).root();
  FlightCase flight;
  int version = 0;
  int seed = 1;
  std::string description;
  root.require("version", version, Range{1, 1});
  root.require("name", flight.name);
  root.read("description", description);
  root.read("seed", seed, Range{0, 2e9});
  flight.bench.seed = static_cast<std::uint64_t>(seed);
  readSurroundings(root, file, flight);
  flight.limit = readSeconds(root, "limit_s", std::chrono::seconds(300));
  flight.script = readScript(root);
  if (flight.script.empty()) flight.script = missionScript();
  std::size_t i = 0;
  const std::vector<sim::FaultEntry> faults = sim::readFaults(root);
  for (TomlTable& table : root.tables("fault"))
    flight.faults.push_back(planFault(table, faults[i++]));
  for (TomlTable& table : root.tables("expect")) {
    flight.expectations.push_back(readExpectation(table));
    table.finish();
  }
  for (TomlTable& table : root.table("limits")) {
    table.read("crash", flight.limits.may_crash);
    table.read("max_height_m", flight.limits.max_height_m, Range{0, 1000});
    table.read("stale_s", flight.limits.stale_s, Range{0.01, 60});
    flight.limits.end = readModes(table, "end_mode");
    table.read("landed", flight.limits.landed);
    table.finish();
  }
  flight.limits.sequence = readSequence(root);
  root.finish();
  return flight;
}

}  // namespace tautline::bench
