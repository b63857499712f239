#pragma once

/// @file
/// Many independent jobs on all processors, each worker a process of its own: a job that kills its
/// process is a failed job, and the others go on. A worker whose pool is gone gets SIGTERM. Not
/// real-time safe.

#include <cstddef>
#include <functional>
#include <string>

namespace tautline::bench {

/// What came of a job: the line that it returned, or why there is none.
struct JobOutcome {
  std::string line;
  std::string failure;  ///< Its exception's text, or how its process ended; empty: none.
};

struct PoolJob {
  std::size_t count{0};  ///< Jobs 0 … count - 1.
  int workers{0};        ///< 0: one for each processor.
  /// In a worker process. One line: line feeds become blanks.
  std::function<std::string(std::size_t)> run;
  /// In the calling process, as they come.
  std::function<void(std::size_t, const JobOutcome&)> each;
};

/// Returns when all jobs are done. Throws std::system_error if processes cannot be made.
void runAll(const PoolJob& job);

}  // namespace tautline::bench
