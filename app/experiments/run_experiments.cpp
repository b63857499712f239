#include "app/experiments/run_experiments.h"

#include <utility>

#include "app/bench/batch.h"
#include "common/error.h"

namespace tautline::experiments {

std::vector<Chapter> runExperiments(const Setup& setup, const RunOptions& options) {
  struct Job {
    std::size_t chapter;
    Trial trial;
  };
  std::vector<Job> jobs;
  bench::Batch batch;
  const std::string fingerprint = setup.fingerprint();
  for (std::size_t c = 0; c < options.chosen.size(); ++c) {
    for (Trial& trial : options.chosen[c]->trials(setup)) {
      batch.keys.push_back(fingerprint + " " + options.chosen[c]->name + " " + trial.name);
      jobs.push_back({c, std::move(trial)});
    }
  }
  batch.workers = options.workers;
  batch.folder = options.folder;
  batch.what = "trials";
  batch.run = [&](std::size_t i) { return jobs[i].trial.run().dump(); };
  const bench::BatchResult ran = bench::runBatch(batch);

  std::vector<std::map<std::string, nlohmann::json>> results(options.chosen.size());
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const bench::JobOutcome& outcome = ran.outcomes[i];
    if (!outcome.failure.empty()) {
      throw InputError({.key = batch.keys[i].substr(fingerprint.size() + 1),
                        .problem = "could not be run: " + outcome.failure},
                       ExitCode::kFailed);
    }
    results[jobs[i].chapter][jobs[i].trial.name] = nlohmann::json::parse(outcome.line);
  }
  std::vector<Chapter> chapters;
  for (std::size_t c = 0; c < options.chosen.size(); ++c) {
    const Experiment& experiment = *options.chosen[c];
    chapters.push_back({&experiment, experiment.judge(setup, Results(std::move(results[c])))});
  }
  return chapters;
}

Tally tally(const std::vector<Chapter>& chapters) {
  Tally t;
  for (const Chapter& chapter : chapters) {
    for (const Row& row : chapter.findings.rows) {
      ++(row.pass() ? t.passed : row.fallsShort() ? t.short_of : t.failed);
    }
  }
  return t;
}

}  // namespace tautline::experiments
