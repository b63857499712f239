#pragma once

/// @file
/// The machine that the loop runs on: its timing, its clocks, the recorder, and whether a run is
/// what it says it is.

#include <array>
#include <cstdint>
#include <optional>

#include "common/fields.h"
#include "common/time.h"
#include "common/vehicle.h"
#include "supervision/detect/findings.h"

namespace tautline {

/// In which runs a check forbids arming.
enum class Required : std::uint8_t { kNever, kReal, kAlways };
inline constexpr std::array<EnumName<Required>, 3> kRequiredNames{
    {{Required::kNever, "never"}, {Required::kReal, "real"}, {Required::kAlways, "always"}}};

struct HostWatchConfig {
  Required real_time{Required::kReal};
  Required log{Required::kReal};
  Required synchronized_clock{Required::kNever};
  double log_silence_s{3.0};
  double max_lateness_s{0.005};
  double lateness_time_s{1.0};
  double max_cycle_s{0.5};
  double clock_step_s{0.5};

  template <class Visitor>
  void fields(Visitor& v) {
    v.choice("real_time", real_time, kRequiredNames, "runs that need real-time priority to arm");
    v.choice("log", log, kRequiredNames, "runs that need a recorder to arm");
    v.choice("synchronized_clock", synchronized_clock, kRequiredNames,
             "runs that need the machine's clock synchronized to arm");
    v.field("log_silence_s", log_silence_s, Range{0.5, 60},
            "without word of the recorder: nobody records");
    v.field("max_lateness_s", max_lateness_s, Range{1e-5, 10}, "mean lateness of the loop ...");
    v.field("lateness_time_s", lateness_time_s, Range{0.1, 60}, "... over this time");
    v.field("max_cycle_s", max_cycle_s, Range{0.01, 60},
            "between two cycles; longer is a clock jump");
    v.field("clock_step_s", clock_step_s, Range{0.001, 1e6},
            "of the wall clock from one cycle to the next; more is a clock jump");
  }
};

/// What the recorder said last (LOG_STATUS).
struct RecorderStatus {
  Time heard{};  ///< On the loop's clock.
  bool recording{false};
  std::int64_t disk_free{0};   ///< [byte]
  std::int64_t disk_limit{0};  ///< [byte]
};

/// Whether what is plugged in can move.
enum class DeviceReality : std::uint8_t { kUnknown, kReal, kEmulated };

/// What the program around the core knows of its machine.
struct HostFacts {
  RunMode run_mode{RunMode::kSim};
  DeviceReality device{DeviceReality::kUnknown};
  bool real_time{false};                     ///< The loop has a real-time priority.
  bool clock_synchronized{false};            ///< The kernel says so.
  Duration lateness{};                       ///< Of this cycle behind its tick.
  Duration unix_offset{};                    ///< Wall clock minus the loop's clock.
  std::optional<RecorderStatus> recorder{};  ///< Nothing heard yet: absent.
};

/// kLoopJitter, kClockJump, kRealTimeMissing, kLogOff, kDiskLow, kSimMismatch. Real-time safe: no
/// allocation, no locks, no exceptions.
class HostWatch {
 public:
  explicit HostWatch(const HostWatchConfig& config) noexcept : config_(config) {}

  /// @param on_ground an unsynchronized clock is told there only: it ends no flight.
  void update(Time now, bool on_ground, const HostFacts& facts, Findings& out) noexcept;

 private:
  HostWatchConfig config_;
  std::optional<Time> last_;
  std::optional<Time> first_;
  Duration unix_offset_{};
  double lateness_{0.0};  ///< Low-passed [s].
};

}  // namespace tautline
