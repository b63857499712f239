#include "app/bench/scenario_command.h"

#include <fnmatch.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>

#include "app/bench/case_batch.h"
#include "app/bench/case_report.h"
#include "app/bench/hil_rig.h"
#include "app/bench/log_sink.h"
#include "app/cli/termination.h"
#include "lcmtypes/lcm_access.h"

namespace tautline::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSuffix = ".scenario.toml";

struct Options {
  std::string path;
  std::string glob{"*"};
  int iterations{1};
  int jobs{0};
  std::optional<std::uint64_t> seed;
  std::string junit;
  std::string log;
  bool json{false};
  bool hil{false};
};

/// A scenario file flown with one seed.
struct Run {
  std::string file;
  FlightCase flight;
};

std::vector<std::string> filesOf(const std::string& path) {
  if (!fs::is_directory(path)) return {path};
  std::vector<std::string> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
    if (entry.path().string().ends_with(kSuffix)) files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<Run> select(const Options& o) {
  std::vector<Run> runs;
  std::string names;
  for (const std::string& file : filesOf(o.path)) {
    const FlightCase flight = readScenario(file);
    names += (names.empty() ? "" : ", ") + flight.name;
    if (::fnmatch(o.glob.c_str(), flight.name.c_str(), 0) != 0) continue;
    for (int i = 0; i < o.iterations; ++i) {
      runs.push_back({file, flight});
      runs.back().flight.bench.seed =
          o.seed.value_or(flight.bench.seed) + static_cast<std::uint64_t>(i);
    }
  }
  if (runs.empty()) {
    throw InputError({.file = o.path,
                      .problem = names.empty() ? std::string("holds no *") + kSuffix
                                               : "no scenario is named \"" + o.glob + "\"",
                      .allowed = names,
                      .remedy = "choose others with --case"},
                     ExitCode::kFailed);
  }
  return runs;
}

std::string logName(const FlightCase& flight) {
  std::string name = flight.name;
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return fmt::format("{}_{}.lcm", name, flight.bench.seed);
}

/// A flight for each of two processors: they need little of one, and are disturbed by each other.
int hilJobs() {
  constexpr unsigned kMost = 2;
  return static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, kMost));
}

CaseBatch batchOf(const std::vector<Run>& runs, const Options& o) {
  CaseBatch batch;
  batch.count = runs.size();
  batch.workers = o.jobs == 0 && o.hil ? hilJobs() : o.jobs;
  batch.flight = [&runs](std::size_t i) { return runs[i].flight; };
  if (!o.log.empty()) {
    fs::create_directories(o.log);
    batch.sink = [&o](const FlightCase& flight) {
      return std::make_unique<LogSink>(fs::path(o.log) / logName(flight));
    };
  }
  if (o.hil) {
    batch.fly = [](const FlightCase& flight, TelemetrySink* sink) {
      cli::endOnSignals();  // after which there is time to end the programs
      return runCaseInHil(flight, sink);
    };
  }
  return batch;
}

void show(const CaseResult& r, const std::string& file, const Options& o) {
  const char* crash = nameOf(r.crash, sim::kCrashReasonNames);
  if (o.json) {
    fmt::print("{}\n", toJson(r));
  } else if (!r.skipped.empty()) {
    fmt::print("only in lock-step {} seed {}: {}\n", r.name, r.seed, r.skipped);
  } else if (!r.passed()) {
    fmt::print("{}\n", failureLine(r, fmt::format("tautline-bench scenario {} --seed {}{}", file,
                                                  r.seed, o.hil ? " --hil" : "")));
  } else {
    fmt::print("passed {} seed {}: {:.1f} s, ended in {}{}{}\n", r.name, r.seed, r.flight_s,
               nameOf(r.end, kModeNames),
               r.crash == sim::CrashReason::kNone ? "" : fmt::format(", crash: {}", crash),
               r.flights == 1 ? "" : fmt::format(", in flight {}", r.flights));
  }
  std::fflush(stdout);
}

ExitCode flyScenarios(const Options& o) {
  std::vector<Run> runs;
  std::vector<CaseResult> results;
  if (o.hil) reachable(kDefaultLcmUrl);
  for (Run& run : select(o)) {
    const std::string why = o.hil ? whyOnlyInLockstep(run.flight) : std::string();
    if (why.empty()) {
      runs.push_back(std::move(run));
      continue;
    }
    results.push_back(resultOf(run.flight));
    results.back().skipped = why;
    show(results.back(), run.file, o);
  }
  CaseBatch batch = batchOf(runs, o);
  const auto show_run = [&](std::size_t i, const CaseResult& r) { show(r, runs[i].file, o); };
  if (o.hil) batch.each = show_run;  // each takes its minute
  const CaseBatchResult flown = flyCases(batch);
  for (std::size_t i = 0; i < flown.cases.size(); ++i) {
    if (!o.hil) show_run(i, flown.cases[i]);
    results.push_back(flown.cases[i]);
  }
  if (!o.json) fmt::print("{}\n", summary(results, flown.wall_s));
  if (!o.junit.empty()) writeJunit(o.junit, "scenarios", results);
  return allPassed(results) ? ExitCode::kOk : ExitCode::kFailed;
}

}  // namespace

void addScenarioCommand(CLI::App& app, ExitCode& result) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "scenario", "Fly scenario files, faults and all; exit code 0 only if all passed");
  verb->add_option("path", options->path, "a scenario file, or a folder of *.scenario.toml")
      ->required();
  verb->add_option("--case", options->glob, "only those whose name fits, e.g. 'enc*'")
      ->capture_default_str();
  verb->add_option("--iterations", options->iterations, "fly each with this many seeds in a row")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  verb->add_option("--seed", options->seed, "first seed (default: the file's)");
  verb->add_flag("--hil", options->hil,
                 "fly with tautline-station and tautline-sim as processes on the wall clock; needs "
                 "a multicast route");
  verb->add_option("--jobs", options->jobs,
                   "processes; 0: one for each processor, with --hil two flights at most")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  verb->add_option("--junit", options->junit, "write JUnit's XML");
  verb->add_option("--log", options->log, "write an LCM log of each flight into this folder");
  verb->add_flag("--json", options->json, "one JSON object a flight instead of words");
  verb->footer("Example: tautline-bench scenario config/scenarios --case 'enc*' --iterations 20");
  verb->callback([options, &result] { result = flyScenarios(*options); });
}

}  // namespace tautline::bench
