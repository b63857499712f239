#pragma once

/// @file
/// Faults of what the bench is besides the machine: the operator's link, LCM, and the station's
/// loop and clock.

#include <array>
#include <cstdint>
#include <optional>

#include "app/station/telemetry.h"
#include "common/time.h"
#include "sim_hil/fault_schedule.h"
#include "supervision/operator_command.h"

namespace tautline::bench {

/// Whose fault it is: the bench's, the machine's, or, as `ok` heals whatever is there, both.
struct FaultOwner {
  bool bench{false};
  bool machine{false};
};
[[nodiscard]] FaultOwner ownerOf(const sim::Fault& fault) noexcept;

/// Everything in it is real-time safe: no allocation, no locks, no exceptions.
class BenchFaults {
 public:
  explicit BenchFaults(std::uint64_t seed) noexcept : faults_(seed) {}

  [[nodiscard]] bool add(const sim::Fault& fault) noexcept { return faults_.add(fault); }

  /// At the start of a cycle.
  void update(Time now) noexcept;

  [[nodiscard]] bool operatorCut() const noexcept { return operator_cut_; }
  [[nodiscard]] bool lcmCut() const noexcept { return lcm_cut_; }
  /// By how much this cycle comes too late.
  [[nodiscard]] Duration lateness() const noexcept;
  /// How far the station's clock is ahead.
  [[nodiscard]] Duration clockAhead() const noexcept { return clock_ahead_; }

  /// What the station hears now of an operator who says `command` now.
  [[nodiscard]] std::optional<OperatorCommand> hear(
      const std::optional<OperatorCommand>& command) noexcept;

 private:
  struct Late {
    Time due{};
    OperatorCommand command;
  };
  static constexpr std::size_t kLate = 16;

  sim::FaultSchedule faults_;
  sim::LooseContact operator_contact_;
  sim::LooseContact lcm_contact_;
  bool operator_cut_{false};
  bool lcm_cut_{false};
  Duration clock_ahead_{};
  bool jumped_{false};
  std::array<Late, kLate> late_{};
  std::size_t head_{0};
  std::size_t tail_{0};
};

/// A sink that loses everything while LCM is cut.
class FaultySink final : public TelemetrySink {
 public:
  FaultySink(TelemetrySink& sink, const BenchFaults& faults) noexcept
      : sink_(sink), faults_(faults) {}

  bool publish(const char* channel, std::int64_t utime,
               std::span<const std::uint8_t> bytes) noexcept override {
    return !faults_.lcmCut() && sink_.publish(channel, utime, bytes);
  }

 private:
  TelemetrySink& sink_;
  const BenchFaults& faults_;
};

}  // namespace tautline::bench
