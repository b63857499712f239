#pragma once

/// @file
/// What came of many cases, for people and for machines.

#include <string>
#include <vector>

#include "app/bench/case_runner.h"

namespace tautline::bench {

/// One line of JSON, and back. parse throws InputError (kFailed) for what is none.
[[nodiscard]] std::string toJson(const CaseResult& result);
[[nodiscard]] CaseResult caseFromJson(const std::string& line);

/// One line for a failed case: name, what was expected, what happened, and `repeat`, the command
/// that flies it again.
[[nodiscard]] std::string failureLine(const CaseResult& result, const std::string& repeat);

/// "… times real time, … cases a second", then "N passed, N failed" and, with some that were not
/// flown, "N only in lock-step".
[[nodiscard]] std::string summary(const std::vector<CaseResult>& results, double wall_s);

/// Writes JUnit's XML. Throws InputError if the file cannot be written.
void writeJunit(const std::string& path, const std::string& suite,
                const std::vector<CaseResult>& results);

/// Writes one JSON array. Throws InputError if the file cannot be written.
void writeJson(const std::string& path, const std::vector<CaseResult>& results);

/// None has failed, and one at least was flown.
[[nodiscard]] bool allPassed(const std::vector<CaseResult>& results);

}  // namespace tautline::bench
