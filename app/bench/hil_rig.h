#pragma once

/// @file
/// The hil rung of the bench: tautline-station and tautline-sim as processes on the wall clock,
/// between them a real pseudo terminal and real LCM on a port of its own (docs/fault_campaign.md,
/// *On the wall clock*). A step is a cycle of the station, as its messages tell it.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include <lcm/lcm-cpp.hpp>

#include "app/bench/bench_faults.h"
#include "app/bench/case_runner.h"
#include "app/bench/child_program.h"
#include "app/bench/heard_flight.h"
#include "app/bench/hil_operator.h"
#include "app/bench/lockstep.h"
#include "app/bench/rig.h"

namespace tautline::bench {

/// A new folder for temporary files, gone with its object: in $TMPDIR, or else in memory, as a
/// black box on a busy disk makes the station wait.
class TemporaryFolder {
 public:
  /// Throws InputError if there can be none.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

/// Not real-time safe.
class HilRig final : public Rig {
 public:
  /// Starts both programs, which stand beside this one, and waits for their first words. `sink`
  /// gets every message that is heard, and outlives the rig; null: none. Throws InputError if they
  /// do not come up, or if LCM does not work here; as does step() once one of them has ended, or
  /// this process has been asked to.
  HilRig(const LockstepConfig& config, TelemetrySink* sink);

  const StepOutput& step(const std::optional<OperatorCommand>& command,
                         const tautline::mission_chunk_t* chunk) override;
  void inject(const sim::Fault& fault) override;
  void holdSticks(const std::optional<Sticks>& sticks) override { operator_.holdSticks(sticks); }

  [[nodiscard]] Time now() const noexcept override { return now_; }
  [[nodiscard]] const StationConfig& station() const noexcept override { return config_; }
  [[nodiscard]] const StepOutput& output() const noexcept override { return heard_.output(); }
  [[nodiscard]] const sim::Truth& truth() const noexcept override { return heard_.truth(); }
  [[nodiscard]] const SensorFrame& sensors() const noexcept override { return heard_.sensors(); }
  [[nodiscard]] double floor() const noexcept override { return floor_; }
  [[nodiscard]] Duration allowance() const noexcept override;

  /// Ends both programs. What they had to say of it.
  struct End {
    std::string failure;   ///< One that did not end well; empty: both did.
    std::string slowness;  ///< What the machine did not give them time for; empty: nothing.
  };
  [[nodiscard]] End end();

 private:
  void onMessage(const lcm::ReceiveBuffer* buffer, const std::string& channel);
  void checkPrograms();
  /// Listens until `done()`; false if it is not within `patience`.
  template <class Done>
  bool listenUntil(const Done& done, Duration patience);
  void tell(const sim::Fault& fault);
  [[nodiscard]] Duration sinceStart() const noexcept;

  StationConfig config_;
  sim::SimDevice sim_device_;
  double floor_;
  TelemetrySink* sink_;
  TemporaryFolder folder_;
  std::string lcm_url_;
  lcm::LCM lcm_;
  HilOperator operator_;
  HeardFlight heard_;
  BenchFaults faults_;
  std::optional<ChildProgram> simulator_;
  std::optional<ChildProgram> station_program_;
  Time start_{};  ///< Of the run, on the machine's clock.
  Time now_{};
  Time last_cycle_{};         ///< The last one that was heard.
  Duration longest_stall_{};  ///< Of the station, which nobody made.
  std::int64_t last_fault_utime_{0};
};

/// Why a flight cannot be flown so; empty: it can.
[[nodiscard]] std::string whyOnlyInLockstep(const FlightCase& flight);

/// runCase() on a HilRig; a program that dies is a failed case. A flight that failed while the
/// machine could not keep up says nothing: it is flown again, three times at most. `sink` as there.
[[nodiscard]] CaseResult runCaseInHil(const FlightCase& flight, TelemetrySink* sink);

}  // namespace tautline::bench
