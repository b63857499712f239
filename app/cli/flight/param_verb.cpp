/// @file
/// `tautline param get|diff|set|help`: the configuration of a running station.

#include <cstdlib>
#include <memory>

#include <fmt/format.h>

#include "app/cli/flight/param_fields.h"
#include "app/cli/flight/verbs.h"
#include "app/station/station_config.h"
#include "common/toml/config_file.h"

namespace tautline::cli::flight {
namespace {

constexpr const char* kName = "param";
constexpr const char* kNotLive =
    "change it in the station's file and restart: live are the numbers of core.guidance, "
    "localizer, supervisor, authority, executor, limits, gate, reel_dead_zone and of core itself";

struct Arguments {
  Options options;
  std::string key;
  std::string value;
};

/// Suffixes of keys and what they mean; the longest that fits wins.
struct Unit {
  std::string_view suffix;
  const char* text;
};
constexpr Unit kUnits[] = {
    {"_mps", "m/s"}, {"_mps2", "m/s²"}, {"_radps", "rad/s"}, {"_radps2", "rad/s²"}, {"_rad", "rad"},
    {"_hz", "Hz"},   {"_m", "m"},       {"_s", "s"},         {"_n", "N"},           {"_v", "V"},
    {"_kg", "kg"},   {"_npm", "N/m"},   {"_per_s", "1/s"},   {"_m2", "m²"}};

const char* unitOf(const std::string& key) {
  const char* unit = "";
  std::size_t longest = 0;
  for (const Unit& u : kUnits) {
    if (key.size() <= u.suffix.size() || u.suffix.size() <= longest) continue;
    if (key.compare(key.size() - u.suffix.size(), u.suffix.size(), u.suffix) != 0) continue;
    unit = u.text;
    longest = u.suffix.size();
  }
  return unit;
}

/// The station's effective configuration; empty: no station. It is sent every 10 s.
std::vector<ParamField> fieldsOfStation(const Options& options) {
  StationClient client(options.lcm_url, Role::kListener);
  const auto& v = client.view();
  if (!client.waitUntil([&] { return v.params.has_value(); },
                        limitOf(options, std::chrono::seconds(15))))
    return {};
  return fieldsOf(parseConfig<StationConfig>(v.params->toml, "the station's PARAMS"));
}

/// @throws InputError with keys that look like it.
const ParamField& fieldNamed(const std::vector<ParamField>& fields, const std::string& key) {
  std::string near;
  for (const ParamField& f : fields) {
    if (f.key == key) return f;
    const std::string last = f.key.substr(f.key.rfind('.') + 1);
    if (key.find(last) != std::string::npos || f.key.find(key) != std::string::npos)
      near += (near.empty() ? "" : ", ") + f.key;
  }
  throw InputError({.key = key,
                    .problem = "is no parameter of the station",
                    .allowed = near.empty() ? "see `tautline param help`" : near},
                   ExitCode::kUsage);
}

nlohmann::json jsonOf(const ParamField& f) {
  return {{"key", f.key},          {"value", f.value}, {"allowed", f.allowed},
          {"unit", unitOf(f.key)}, {"text", f.doc},    {"live", f.live}};
}

void print(const Options& options, const std::vector<ParamField>& fields,
           const std::vector<std::string>& lines) {
  if (options.json) {
    nlohmann::json rows = nlohmann::json::array();
    for (const ParamField& f : fields) rows.push_back(jsonOf(f));
    fmt::print("{}\n", rows.dump());
    return;
  }
  for (const std::string& line : lines) fmt::print("{}\n", line);
}

ExitCode get(const Arguments& a) {
  const std::vector<ParamField> all = fieldsOfStation(a.options);
  if (all.empty()) return noStation(a.options, kName);
  const std::vector<ParamField> shown =
      a.key.empty() ? all : std::vector<ParamField>{fieldNamed(all, a.key)};
  std::vector<std::string> lines;
  for (const ParamField& f : shown)
    lines.push_back(a.key.empty() ? f.key + " = " + f.value : f.value);
  print(a.options, shown, lines);
  return ExitCode::kOk;
}

ExitCode diff(const Arguments& a) {
  const std::vector<ParamField> all = fieldsOfStation(a.options);
  if (all.empty()) return noStation(a.options, kName);
  const std::vector<ParamField> defaults = fieldsOf(StationConfig{});
  std::vector<ParamField> changed;
  std::vector<std::string> lines;
  for (const ParamField& f : all) {
    const auto same = std::find_if(defaults.begin(), defaults.end(),
                                   [&f](const ParamField& d) { return d.key == f.key; });
    if (same != defaults.end() && same->value == f.value) continue;
    changed.push_back(f);
    lines.push_back(fmt::format("{} = {}  # default {}", f.key, f.value,
                                same == defaults.end() ? "unknown" : same->value));
  }
  print(a.options, changed, lines);
  return ExitCode::kOk;
}

/// Needs no station: text, range and default are the program's.
ExitCode help(const Arguments& a) {
  const std::vector<ParamField> all = fieldsOf(StationConfig{});
  const std::vector<ParamField> shown =
      a.key.empty() ? all : std::vector<ParamField>{fieldNamed(all, a.key)};
  std::vector<std::string> lines;
  for (const ParamField& f : shown) {
    if (a.key.empty()) {
      lines.push_back(fmt::format("{:<48} {}", f.key, f.doc));
      continue;
    }
    lines = {
        f.key + ": " + f.doc, std::string("unit     ") + unitOf(f.key), "allowed  " + f.allowed,
        "default  " + f.value,
        std::string("live     ") + (f.live ? "yes, in STANDBY" : std::string("no; ") + kNotLive)};
  }
  print(a.options, shown, lines);
  return ExitCode::kOk;
}

double numberIn(const std::string& text, const ParamField& field) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const bool whole = end != text.c_str() && *end == '\0';
  if (whole && field.range->contains(value) && (!field.integer || value == std::floor(value)))
    return value;
  throw InputError({.key = field.key,
                    .problem = "'" + text + "' does not fit",
                    .allowed = field.allowed + (field.integer ? ", whole numbers" : "")},
                   ExitCode::kUsage);
}

ExitCode set(const Arguments& a) {
  const std::vector<ParamField> all = fieldsOf(StationConfig{});
  const ParamField& field = fieldNamed(all, a.key);
  if (!field.live)
    return finish(a.options, kName, ExitCode::kRefused, a.key + " cannot be set live; " + kNotLive);
  const double value = numberIn(a.value, field);
  StationClient client(a.options.lcm_url, Role::kOperator);
  const ExitCode code =
      ask(client, a.options, kName,
          {.service = Service::kSetParameter, .parameter = parameterHash(a.key), .value = value});
  if (code != ExitCode::kOk) return code;
  return finish(a.options, kName, code, a.key + " is " + a.value + " until the station restarts");
}

}  // namespace

void addParamVerb(CLI::App& root, ExitCode& result) {
  CLI::App* param = root.add_subcommand(kName, "The configuration of a running station");
  param->require_subcommand(1);
  param->footer(
      "Example: tautline param set core.guidance.takeoff_height_m 1.2\nset works in STANDBY only, "
      "for the numbers that `tautline param help KEY` calls live;\neach change is in the log and "
      "ends with the station's next start.");
  const auto arguments = std::make_shared<Arguments>();
  const auto add = [&](const char* name, const char* text, const char* example,
                       ExitCode (*run)(const Arguments&)) {
    CLI::App* verb = addVerb(*param, name, text, example, arguments->options);
    addTimeout(*verb, arguments->options);
    verb->callback([arguments, run, &result] { result = run(*arguments); });
    return verb;
  };
  const auto withKey = [&](CLI::App* verb) {
    return verb->add_option("key", arguments->key, "dotted key");
  };
  withKey(add("get", "Effective value of a parameter, or all",
              "tautline param get core.guidance.takeoff_height_m", get));
  add("diff", "What differs from the defaults", "tautline param diff", diff);
  withKey(add("help",
              "Unit, range, default and text of a parameter, or all texts; needs no station",
              "tautline param help core.guidance.takeoff_height_m", help));
  CLI::App* setter = add("set", "Change a number while disarmed",
                         "tautline param set core.guidance.takeoff_height_m 1.2", set);
  withKey(setter)->required();
  setter->add_option("value", arguments->value, "the new number")->required();
}

}  // namespace tautline::cli::flight
