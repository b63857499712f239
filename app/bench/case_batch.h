#pragma once

/// @file
/// A batch of flight cases: scenario files and the safety campaign fly this way.

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/bench/case_runner.h"

namespace tautline::bench {

struct CaseBatch {
  std::size_t count{0};
  int workers{0};      ///< 0: one for each processor.
  std::string folder;  ///< Keeps results by name and seed; empty: nowhere.
  std::function<FlightCase(std::size_t)> flight;
  /// Where a flight's messages go. May be empty.
  std::function<std::unique_ptr<TelemetrySink>(const FlightCase&)> sink;
  /// Flies one, in a worker process; empty: in lock-step.
  std::function<CaseResult(const FlightCase&, TelemetrySink*)> fly;
  /// In the calling process, as they come; not for what the folder knows. May be empty.
  std::function<void(std::size_t, const CaseResult&)> each;
};

struct CaseBatchResult {
  std::vector<CaseResult> cases;  ///< In order.
  std::size_t known{0};           ///< Of them found in the folder.
  double wall_s{0.0};
};

/// A case that kills its process, or cannot be flown, is a failed case. Throws InputError if the
/// folder cannot be written.
[[nodiscard]] CaseBatchResult flyCases(const CaseBatch& batch);

}  // namespace tautline::bench
