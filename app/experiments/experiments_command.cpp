#include "app/experiments/experiments_command.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>

#include "app/experiments/experiments_report.h"
#include "app/experiments/published_flights.h"
#include "app/experiments/run_experiments.h"

namespace tautline::experiments {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string config{"config/experiments"};
  std::string out;
  std::vector<std::string> only;
  std::uint64_t seed{1};
  int jobs{0};
  bool quick{false};
  bool list{false};
  bool real{false};
};

std::vector<const Experiment*> choose(const std::vector<Experiment>& all,
                                      const std::vector<std::string>& names) {
  std::vector<const Experiment*> chosen;
  std::string allowed;
  for (const Experiment& e : all) {
    allowed += (allowed.empty() ? "" : ", ") + std::string(e.name);
    if (names.empty() || std::find(names.begin(), names.end(), e.name) != names.end())
      chosen.push_back(&e);
  }
  for (const std::string& name : names) {
    const auto has = [&](const Experiment* e) { return name == e->name; };
    if (std::none_of(chosen.begin(), chosen.end(), has)) {
      throw InputError({.key = "--only", .problem = "\"" + name + "\" is none", .allowed = allowed},
                       ExitCode::kUsage);
    }
  }
  return chosen;
}

ExitCode run(const Options& o) {
  const std::vector<const Experiment*> chosen =
      choose(o.real ? realExperiments() : experiments(), o.only);
  if (o.list) {
    for (const Experiment* e : chosen) fmt::print("{:<18} {}\n", e->name, e->title);
    return ExitCode::kOk;
  }
  if (o.real && !publishedLogs()) {
    fmt::print(stderr, "SKIPPED: no {}; set TAUTLINE_DATA to the folder of the published data\n",
               "fotokite_flight_logs/2018-01_02.tar.xz");
    return ExitCode::kOk;
  }
  const fs::path out = !o.out.empty() ? o.out
                       : o.real       ? "build/experiments_real"
                                      : "build/experiments";
  const Setup setup = loadSetup(o.config, o.quick, o.seed);
  const std::vector<Chapter> chapters =
      runExperiments(setup, {chosen, o.jobs, (out / "trials").string()});
  const fs::path page = writeReport(setup, chapters, out);
  fmt::print("{}report: {}\n", reportText(chapters), page.string());
  return tally(chapters).failed == 0 ? ExitCode::kOk : ExitCode::kFailed;
}

}  // namespace

void addExperimentsCommand(CLI::App& app, ExitCode& result) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "experiments",
      "Reproduce the dissertation's experiments, then fly ours on the same plant; exit code 0 only "
      "if every figure is in its band, or falls short of it for a known reason");
  verb->add_option("--only", options->only, "only these experiments, e.g. localization,servoing")
      ->delimiter(',');
  verb->add_flag("--real", options->real,
                 "instead of these: the real flights of TAUTLINE_DATA, if they are there");
  verb->add_flag("--quick", options->quick, "fewer trials");
  verb->add_option("--seed", options->seed, "of the first trial")->capture_default_str();
  verb->add_option("--jobs", options->jobs, "processes; 0: one for each processor")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  verb->add_option("--out", options->out,
                   "folder of the report, trials are kept in it, resumable; default: "
                   "build/experiments, with --real build/experiments_real");
  verb->add_option("--config", options->config, "folder of the set-up")->capture_default_str();
  verb->add_flag("--list", options->list, "print the experiments' names, then stop");
  verb->footer("Example: tautline-bench experiments --only localization --out build/localization");
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace tautline::experiments
