#pragma once

/// @file
/// What `tautline doctor` finds, and the form of the checks that find it: each looks at one thing
/// and names the command that mends it. Not real-time safe.

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/fields.h"
#include "common/time.h"

namespace tautline::cli {

/// Where a check looks. A test gives it a folder of its own instead of the machine's root.
struct Machine {
  std::filesystem::path root{"/"};  ///< /proc, /sys and /etc are below it.
  /// Whether the kernel's wall clock is disciplined by somebody (NTP, PPS, GPS).
  std::function<bool()> clock_synchronized;
  /// How late a loop of that period wakes, over that time, with the loop's own pacing [ns].
  std::function<std::vector<Duration>(Duration period, Duration length)> lateness;
  double loop_rate_hz{100.0};  ///< Of the loop that the latency check imitates.
  double latency_s{10.0};      ///< How long it does.
};

/// This machine itself.
[[nodiscard]] Machine thisMachine();

enum class FindingStatus : std::uint8_t {
  kOk,
  kAdvice,   ///< The station works; this would make it better.
  kProblem,  ///< Not fit for flight before it is mended.
};
inline constexpr std::array<EnumName<FindingStatus>, 3> kFindingStatusNames{
    {{FindingStatus::kOk, "ok"},
     {FindingStatus::kAdvice, "advice"},
     {FindingStatus::kProblem, "problem"}}};

struct Finding {
  FindingStatus status{FindingStatus::kOk};
  std::string measured;   ///< What is the case, in words.
  std::string wanted{};   ///< What should be; empty if ok.
  std::string remedy{};   ///< The command that makes it so, ready to paste; empty if ok.
  std::string details{};  ///< More lines for people, e.g. a histogram.
};

/// Groups of checks that the command line can choose.
enum class CheckGroup : std::uint8_t { kRealTime };
inline constexpr std::array<EnumName<CheckGroup>, 1> kCheckGroupNames{
    {{CheckGroup::kRealTime, "rt"}}};

struct Check {
  const char* name;  ///< In capitals, as an arming check would be called.
  CheckGroup group;
  Finding (*run)(const Machine& machine);
};

/// All checks, in the order in which they are printed. A new one is one more row.
[[nodiscard]] const std::vector<Check>& allChecks();

/// First line of `root`/`path` without its line end; empty if it cannot be read.
[[nodiscard]] std::string firstLine(const Machine& machine, const std::string& path);

}  // namespace tautline::cli
