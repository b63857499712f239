#pragma once

/// @file
/// A flight as its messages tell it: the other side of app/station/telemetry.h, and of SIM_TRUTH.
/// Each cycle of the station begins with its STATION_INPUT; what it says after that, up to the
/// next, is of that cycle. Rates and estimate come at the telemetry's rate and hold until then; all
/// else is told in its own cycle.

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "app/station/station.h"
#include "sim_hil/truth.h"

namespace tautline::bench {

/// Not real-time safe.
class HeardFlight {
 public:
  /// Messages that say nothing of these, or are damaged, change nothing.
  void take(std::string_view channel, std::span<const std::uint8_t> bytes);

  /// Station and machine have both been heard.
  [[nodiscard]] bool begun() const noexcept { return state_heard_ && truth_heard_ && next_; }

  /// When the next cycle was, if it has begun; all of the present one has then been heard. On the
  /// station's clock.
  [[nodiscard]] std::optional<Time> next() const noexcept {
    return next_ ? std::optional(next_->now) : std::nullopt;
  }
  /// Goes on to the next cycle, or, if that has not begun, waits for more of this one: what was
  /// said once is forgotten.
  void goOn() noexcept;

  /// The station says nothing any more, so it commands nothing.
  void fallSilent() noexcept { output_.command = {}; }

  /// Mode, conditions, events, answer, rates and estimate.
  [[nodiscard]] const StepOutput& output() const noexcept { return output_; }
  [[nodiscard]] const SensorFrame& sensors() const noexcept { return sensors_; }
  [[nodiscard]] const sim::Truth& truth() const noexcept { return truth_; }

 private:
  void enter(Mode mode) noexcept;
  void add(const StationEvent& event) noexcept;

  StepOutput output_;
  SensorFrame sensors_;
  sim::Truth truth_;
  std::optional<StepInput> next_;
  bool rates_heard_{false};  ///< In this cycle.
  bool state_heard_{false};
  bool truth_heard_{false};
};

}  // namespace tautline::bench
