#pragma once

/// @file
/// What `tautline doctor` finds, and the form of the checks that find it: each looks at one thing
/// and names the command that mends it. Not real-time safe.

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/fields.h"
#include "common/time.h"

namespace tautline {
struct StationConfig;
}

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

  std::filesystem::path config_file;  ///< Of the station; empty: there is none to look at.
  std::shared_ptr<const StationConfig> config;  ///< What is in it; nullptr if it cannot be read,
  std::string config_problem;                   ///< and then the one line that says why.
  std::string lcm_url;
  std::filesystem::path log_folder;
};

/// This machine itself.
[[nodiscard]] Machine thisMachine();

/// Reads `file` into the machine's config, or notes why it cannot be read.
void readStationConfig(Machine& machine, const std::filesystem::path& file);

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
enum class CheckGroup : std::uint8_t {
  kStation,   ///< Its config and its device.
  kNetwork,   ///< LCM.
  kDisk,      ///< Room for logs and the black box.
  kRealTime,  ///< What the loop needs.
};
inline constexpr std::array<EnumName<CheckGroup>, 4> kCheckGroupNames{
    {{CheckGroup::kStation, "station"},
     {CheckGroup::kNetwork, "network"},
     {CheckGroup::kDisk, "disk"},
     {CheckGroup::kRealTime, "rt"}}};

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
