#include "app/bench/campaign.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "common/mission/mission_file.h"

namespace tautline::bench {
namespace {

constexpr Duration kAskAgain = std::chrono::seconds(5);   // for so long, while refused
constexpr Duration kPairDelay = std::chrono::seconds(1);  // the second fault after the first

Duration seconds(TomlTable& table, const char* key, double value) {
  table.read(key, value, Range{0, 1e5});
  return fromSeconds(value);
}

FlightCase readFlight(TomlTable& table, const std::string& file) {
  FlightCase flight;
  table.require("name", flight.name);
  readSurroundings(table, file, flight);
  table.finish();
  return flight;
}

CampaignPhase readPhase(TomlTable& table) {
  CampaignPhase phase;
  std::string name;
  table.require("mode", name);
  const Phase parsed = parsePhase(table, name);
  if (parsed.kind != Phase::Kind::kMode) throw table.error("mode", "\"" + name + "\" is no mode");
  phase.mode = parsed.mode;
  phase.at = seconds(table, "at_s", 1.0);
  phase.limit = seconds(table, "limit_s", 120.0);
  table.read("pairs", phase.pairs);
  phase.ask = readRequest(table, "ask");
  phase.ask_at = seconds(table, "ask_at_s", 0.0);
  table.finish();
  return phase;
}

std::vector<std::string> readWords(TomlTable& table, const char* key) {
  std::string text;
  table.read(key, text);
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

Failsafe readFailsafe(TomlTable& table) {
  Failsafe f;
  table.require("name", f.name);
  f.detect = readConditions(table, "detect");
  f.detect_in = seconds(table, "detect_s", 5.0);
  f.detect_phases = readModes(table, "detect_in");
  f.react = readModes(table, "react");
  f.react_in = seconds(table, "react_s", 5.0);
  f.react_phases = readModes(table, "react_in");
  f.end = readModes(table, "end");
  table.finish();
  if (f.detect.empty() != f.detect_phases.empty() || f.react.empty() != f.react_phases.empty())
    throw table.error("detect_in", "or react_in does not go with detect or react", {},
                      "say in which phases it is owed");
  return f;
}

/// Anything but a landing has to be explained in the table.
void requireWhy(TomlTable& table, const CampaignRow& row) {
  ModeSet landing;
  landing.add(Mode::kStandby);
  std::string why;
  table.read("why", why);
  if (why.empty() == (row.landed && !row.may_crash && row.owed.end == landing)) return;
  throw table.error("why", why.empty() ? "is missing" : "explains nothing", {},
                    "with `crash`, `landed = false` or another `end` than STANDBY say what really "
                    "happens and why that is acceptable; without leave it out");
}

CampaignRow readRow(TomlTable& table, const std::vector<Failsafe>& failsafes) {
  CampaignRow row;
  row.fault = sim::readFault(table).fault;
  row.label = describe(row.fault);
  if (row.fault.lasting != sim::Fault::kForEver)
    row.label += fmt::format(" {:g} s", toSeconds(row.fault.lasting));
  table.read("label", row.label);
  row.flights = readWords(table, "flights");
  row.phases = readModes(table, "phases");
  table.read("pairs", row.pairs);
  table.read("crash", row.may_crash);
  table.read("landed", row.landed);
  std::string name;
  table.require("failsafe", name);
  const auto owed = std::find_if(failsafes.begin(), failsafes.end(),
                                 [&](const Failsafe& f) { return f.name == name; });
  if (owed == failsafes.end())
    throw table.error("failsafe", "\"" + name + "\" is none", "the names in `failsafe`");
  row.owed = *owed;
  if (table.has("end")) row.owed.end = readModes(table, "end");
  requireWhy(table, row);
  table.finish();
  return row;
}

bool canHave(const FlightCase& flight, const CampaignRow& row) {
  if (!row.flights.empty() &&
      std::find(row.flights.begin(), row.flights.end(), flight.name) == row.flights.end())
    return false;
  try {
    sim::checkFault(row.fault, Lockstep::simDevice(flight.bench), true);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

/// What one row alone expects, beside how the flight ends.
void addExpectations(const Failsafe& owed, Mode mode, FlightCase& flight) {
  Expectation e;
  e.phase = {Phase::Kind::kFault, {}, {}};
  if (owed.react_phases.has(mode)) {
    e.within = owed.react_in;
    e.modes = owed.react;
    flight.expectations.push_back(e);
  }
  if (owed.detect_phases.has(mode)) {
    e.within = owed.detect_in;
    e.kind = Expectation::Kind::kCondition;
    e.conditions = owed.detect;
    flight.expectations.push_back(e);
  }
}

}  // namespace

Campaign readCampaign(const std::string& file) {
  TomlTable root = TomlFile::load(file).root();
  Campaign campaign;
  int version = 0;
  int seed = 1;
  root.require("version", version, Range{1, 1});
  root.read("seed", seed, Range{0, 2e9});
  campaign.seed = static_cast<std::uint64_t>(seed);
  const std::vector<OperatorEntry> script = readScript(root);
  const std::vector<ModeSequence> sequence = readSequence(root);
  for (TomlTable& table : root.tables("flight")) {
    campaign.flights.push_back(readFlight(table, file));
    campaign.flights.back().script = script;
    campaign.flights.back().limits.sequence = sequence;
  }
  for (TomlTable& table : root.tables("phase")) campaign.phases.push_back(readPhase(table));
  std::vector<Failsafe> failsafes;
  for (TomlTable& table : root.tables("failsafe")) failsafes.push_back(readFailsafe(table));
  std::set<std::string> labels;
  for (TomlTable& table : root.tables("fault")) {
    campaign.rows.push_back(readRow(table, failsafes));
    if (!labels.insert(campaign.rows.back().label).second)
      throw table.error("label", "\"" + campaign.rows.back().label + "\" is there twice", {},
                        "give the row a label of its own");
  }
  root.finish();
  return campaign;
}

std::vector<CampaignCase> campaignCases(const Campaign& campaign) {
  std::vector<CampaignCase> cases;
  const std::vector<CampaignRow>& rows = campaign.rows;
  for (std::size_t f = 0; f < campaign.flights.size(); ++f) {
    for (std::size_t p = 0; p < campaign.phases.size(); ++p) {
      const Mode mode = campaign.phases[p].mode;
      const std::string place = campaign.flights[f].name + "/" + nameOf(mode, kModeNames) + "/";
      const auto has = [&](std::size_t row) {
        return (rows[row].phases.empty() || rows[row].phases.has(mode)) &&
               canHave(campaign.flights[f], rows[row]);
      };
      for (std::size_t a = 0; a < rows.size(); ++a) {
        if (!has(a)) continue;
        cases.push_back({place + rows[a].label, f, p, a, {}});
        if (!campaign.phases[p].pairs || !rows[a].pairs) continue;
        for (std::size_t b = a + 1; b < rows.size(); ++b) {
          if (rows[b].pairs && has(b))
            cases.push_back({place + rows[a].label + " + " + rows[b].label, f, p, a, b});
        }
      }
    }
  }
  return cases;
}

FlightCase flightOf(const Campaign& campaign, const CampaignCase& c) {
  FlightCase flight = campaign.flights[c.flight];
  const CampaignPhase& phase = campaign.phases[c.phase];
  const CampaignRow& first = campaign.rows[c.first];
  flight.name = c.name;
  flight.bench.seed = fnv1a(c.name) ^ campaign.seed;
  flight.limit = phase.limit;
  flight.limits.may_crash = first.may_crash;
  flight.limits.end = first.owed.end;
  flight.limits.landed = first.landed;
  if (phase.ask != Request::kNone)
    flight.script.push_back(
        {{Phase::Kind::kMode, Mode::kAuto, {}}, false, phase.ask_at, phase.ask, kAskAgain, {}});
  const auto add = [&](const CampaignRow& row, Duration at) {
    FaultPlan plan{{Phase::Kind::kMode, phase.mode, {}}, row.fault};
    plan.fault.at = Time{} + at;
    flight.faults.push_back(plan);
  };
  add(first, phase.at);
  if (!c.second) {
    addExpectations(first.owed, phase.mode, flight);
    return flight;
  }
  const CampaignRow& second = campaign.rows[*c.second];
  add(second, phase.at + kPairDelay);
  flight.limits.may_crash = first.may_crash || second.may_crash;
  flight.limits.end = first.owed.end | second.owed.end;
  flight.limits.landed = first.landed && second.landed;
  return flight;
}

}  // namespace tautline::bench
