#pragma once

/// @file
/// A batch of jobs that takes long: on all processors, with progress, and resumable. What came of
/// each job is kept in a file as it comes; a batch that was interrupted goes on where it was, and
/// shards of one batch can share the folder of a cluster's job array. Not real-time safe.

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "app/bench/worker_pool.h"

namespace tautline::bench {

struct Batch {
  std::vector<std::string>
      keys;                  ///< One a job; what is to be run, completely: same key, same line.
  int workers{0};            ///< 0: one for each processor.
  std::string folder;        ///< Keeps results in results.txt of this folder; empty: nowhere.
  std::string what{"jobs"};  ///< In the progress: "12 of 40 flights".
  std::function<std::string(std::size_t)> run;  ///< In a worker process; one line.
  /// Does this outcome count as failed in the progress? May be empty.
  std::function<bool(const JobOutcome&)> failed;
  /// In the calling process, as they come; not for what the folder knows. May be empty.
  std::function<void(std::size_t, const JobOutcome&)> each;
};

struct BatchResult {
  std::vector<JobOutcome> outcomes;  ///< In the order of the keys.
  std::size_t known{0};              ///< Of them found in the folder.
  double wall_s{0.0};
};

/// Runs what the folder does not know yet. Jobs that failed are not kept: they are run again next
/// time. Throws InputError if the folder cannot be written.
[[nodiscard]] BatchResult runBatch(const Batch& batch);

/// A part of a batch.
struct Shard {
  std::size_t index{1};  ///< 1 … count
  std::size_t count{1};

  [[nodiscard]] bool has(std::size_t job) const noexcept { return job % count == index - 1; }
};

/// "I/N". Throws InputError (kUsage).
[[nodiscard]] Shard parseShard(const std::string& text);

}  // namespace tautline::bench
