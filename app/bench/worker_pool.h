#pragma once

/// @file
/// Flies many cases on all processors, each worker a process of its own: a case that kills its
/// process is a failed case, and the others go on.

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "app/bench/case_runner.h"

namespace tautline::bench {

struct PoolJob {
  std::size_t count{0};                                ///< Cases 0 … count - 1.
  int workers{0};                                      ///< 0: one for each processor.
  std::function<CaseResult(std::size_t)> fly;          ///< In a worker.
  std::function<std::string(std::size_t)> name;        ///< Of a case that has killed its worker.
  std::function<void(const CaseResult&)> each_result;  ///< As they come; may be empty.
};

/// Results in the order of the cases. Throws std::system_error if processes cannot be made.
[[nodiscard]] std::vector<CaseResult> flyAll(const PoolJob& job);

}  // namespace tautline::bench
