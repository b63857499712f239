#include "app/bench/case_report.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/error.h"
#include "common/markup.h"
#include "common/toml/toml_writer.h"

namespace tautline::bench {
namespace {

template <class Enum, class Names>
Enum valueOf(const std::string& name, const Names& names) {
  const auto found =
      std::find_if(names.begin(), names.end(), [&](const auto& n) { return name == n.name; });
  return found == names.end() ? Enum{} : found->value;
}

std::ptrdiff_t failedOf(const std::vector<CaseResult>& results) {
  return std::count_if(results.begin(), results.end(),
                       [](const CaseResult& r) { return !r.failure.empty(); });
}

std::ptrdiff_t skippedOf(const std::vector<CaseResult>& results) {
  return std::count_if(results.begin(), results.end(),
                       [](const CaseResult& r) { return !r.skipped.empty(); });
}

double flightSeconds(const std::vector<CaseResult>& results) {
  double sum = 0.0;
  for (const CaseResult& r : results) sum += r.flight_s;
  return sum;
}

}  // namespace

std::string toJson(const CaseResult& r) {
  return nlohmann::json{{"name", r.name},
                        {"seed", r.seed},
                        {"passed", r.passed()},
                        {"failure", r.failure},
                        {"skipped", r.skipped},
                        {"end", nameOf(r.end, kModeNames)},
                        {"crash", nameOf(r.crash, sim::kCrashReasonNames)},
                        {"faulted", r.faulted},
                        {"flight_s", r.flight_s},
                        {"wall_s", r.wall_s},
                        {"flights", r.flights},
                        {"height_max_m", r.height_max_m}}
      .dump();
}

CaseResult caseFromJson(const std::string& line) {
  CaseResult r;
  try {
    const nlohmann::json j = nlohmann::json::parse(line);
    r.name = j.at("name");
    r.seed = j.at("seed");
    r.failure = j.at("failure");
    r.skipped = j.value("skipped", "");
    r.end = valueOf<Mode>(j.at("end"), kModeNames);
    r.crash = valueOf<sim::CrashReason>(j.at("crash"), sim::kCrashReasonNames);
    r.faulted = j.at("faulted");
    r.flight_s = j.at("flight_s");
    r.wall_s = j.at("wall_s");
    r.flights = j.value("flights", 1);
    r.height_max_m = j.at("height_max_m");
  } catch (const nlohmann::json::exception&) {
    throw InputError({.problem = "\"" + line.substr(0, 60) + "\" is no result of a case"},
                     ExitCode::kFailed);
  }
  return r;
}

std::string failureLine(const CaseResult& r, const std::string& repeat) {
  return fmt::format("FAILED {}: {}; again: {}", r.name, r.failure, repeat);
}

std::string summary(const std::vector<CaseResult>& results, double wall_s) {
  const double flown = flightSeconds(results);
  const std::ptrdiff_t skipped = skippedOf(results);
  const std::ptrdiff_t cases = std::ssize(results) - skipped;
  return fmt::format(
             "{:.0f} s of flight in {:.1f} s, {:.0f} times real time, {:.1f} cases a second\n"
             "{} passed, {} failed",
             flown, wall_s, flown / wall_s, static_cast<double>(cases) / wall_s,
             cases - failedOf(results), failedOf(results)) +
         (skipped > 0 ? fmt::format(", {} only in lock-step", skipped) : std::string());
}

void writeJunit(const std::string& path, const std::string& suite,
                const std::vector<CaseResult>& results) {
  std::string xml = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" skipped=\"{}\">\n",
      escaped(suite), results.size(), failedOf(results), skippedOf(results));
  for (const CaseResult& r : results) {
    xml += fmt::format("  <testcase classname=\"{}\" name=\"{}\" time=\"{:.3f}\"", escaped(suite),
                       escaped(fmt::format("{} seed {}", r.name, r.seed)), r.wall_s);
    const bool flown = r.skipped.empty();
    xml += r.passed()
               ? "/>\n"
               : fmt::format(">\n    <{} message=\"{}\"/>\n  </testcase>\n",
                             flown ? "failure" : "skipped", escaped(flown ? r.failure : r.skipped));
  }
  writeFileAtomically(path, xml + "</testsuite>\n");
}

void writeJson(const std::string& path, const std::vector<CaseResult>& results) {
  std::string text = "[";
  for (const CaseResult& r : results) text += (text.size() > 1 ? ",\n " : "\n ") + toJson(r);
  writeFileAtomically(path, text + "\n]\n");
}

bool allPassed(const std::vector<CaseResult>& results) {
  return failedOf(results) == 0 && skippedOf(results) < std::ssize(results);
}

}  // namespace tautline::bench
