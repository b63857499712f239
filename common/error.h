#pragma once

/// @file
/// The three tiers of errors (docs/architecture.md, "Errors"):
///  1. InputError: what a user gave us is wrong. Thrown at load time only, printed in one line by
///  reportAndExitCode().
///  2. TAUTLINE_CHECK: our own mistake, always on, aborts with file, line and condition.
///  3. Status in the returned struct: everything that can happen inside a cycle; nothing there
///  throws.

#include <stdexcept>
#include <string>
#include <utility>

namespace tautline {

/// Exit codes of every Tautline program.
enum class ExitCode : int {
  kOk = 0,
  kFailed = 1,   ///< The thing asked for was tried and failed.
  kUsage = 2,    ///< Wrong command line.
  kRefused = 3,  ///< Refused by safety (supervisor, arming check).
  kTimeout = 4,  ///< No answer in time, or no link.
  kConfig = 5,   ///< A config, mission, scene or map file is wrong or missing.
};

/// Where and what a user's input is wrong. Empty or zero members are left out of the text.
struct InputProblem {
  std::string file{};     ///< Path as the user gave it.
  int line{0};            ///< 1-based.
  std::string key{};      ///< Dotted key or row, e.g. "waypoints[3].position_m".
  std::string problem{};  ///< What is wrong, with the value that was found.
  std::string allowed{};  ///< What would be accepted.
  std::string remedy{};   ///< What to do about it.
};

/// One line: "file:line: key: problem; allowed: …; …remedy".
[[nodiscard]] std::string describe(const InputProblem& problem);

/// The one exception of load time. Not real-time safe: start-up only.
class InputError : public std::runtime_error {
 public:
  explicit InputError(InputProblem problem, ExitCode code = ExitCode::kConfig)
      : std::runtime_error(describe(problem)), problem_(std::move(problem)), code_(code) {}

  [[nodiscard]] const InputProblem& problem() const noexcept { return problem_; }
  [[nodiscard]] ExitCode code() const noexcept { return code_; }

 private:
  InputProblem problem_;
  ExitCode code_;
};

/// For a program's outermost catch (...): prints the exception in flight as one line "program:
/// error: …" on stderr and returns the exit code that belongs to it; kFailed for anything but an
/// InputError.
[[nodiscard]] int reportException(const char* program) noexcept;

/// Prints the condition to stderr and aborts. Behind TAUTLINE_CHECK.
[[noreturn]] void checkFailed(const char* condition, const char* file, int line) noexcept;

}  // namespace tautline

/// Always-on check of our own invariants. Real-time safe as long as the condition is.
#define TAUTLINE_CHECK(condition) \
  ((condition) ? static_cast<void>(0) : ::tautline::checkFailed(#condition, __FILE__, __LINE__))
