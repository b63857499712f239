#pragma once

/// @file
/// Runs experiments on all processors, resumable, and collects their findings. Not real-time safe.

#include <string>
#include <vector>

#include "app/experiments/experiment.h"

namespace tautline::experiments {

struct Chapter {
  const Experiment* experiment{nullptr};
  Findings findings;
};

struct RunOptions {
  std::vector<const Experiment*> chosen;
  int workers{0};
  std::string folder;  ///< Keeps the trials' results (bench::Batch); empty: nowhere.
};

/// Throws InputError (kFailed) for the first trial that could not be run.
[[nodiscard]] std::vector<Chapter> runExperiments(const Setup& setup, const RunOptions& options);

/// Rows of all chapters.
struct Tally {
  int passed{0};
  int short_of{0};  ///< Do not pass, and what limits them is known (Row::shortfall).
  int failed{0};    ///< The other ones.

  [[nodiscard]] int rows() const noexcept { return passed + short_of + failed; }
};
[[nodiscard]] Tally tally(const std::vector<Chapter>& chapters);

}  // namespace tautline::experiments
