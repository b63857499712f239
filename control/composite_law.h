#pragma once

/// @file
/// The default law: follows the segment itself, not its end. Look-ahead point on the path, velocity
/// towards it, tether rates through the inverse Jacobian, scaled together into the limits; round or
/// over the pole without a trap. Eqs. (C3)-(C7) of docs/control.md.

#include <array>
#include <cstdint>

#include "control/controller.h"
#include "control/pole.h"
#include "control/tether_target.h"
#include "control/unwrapped_chart.h"

namespace tautline {

enum class PoleStrategy : std::uint8_t {
  kDetour,     ///< Round the axis: for vehicles whose elevation set-point stops at 90 deg.
  kUnwrapped,  ///< Over it: for vehicles that accept more.
};
inline constexpr std::array<EnumName<PoleStrategy>, 2> kPoleStrategyNames{
    {{PoleStrategy::kDetour, "detour"}, {PoleStrategy::kUnwrapped, "unwrapped"}}};

struct CompositeLawConfig {
  double look_ahead_s{1.2};
  double look_ahead_min_m{0.15};
  double stop_gain_per_s{0.6};
  double vehicle_lag_s{0.3};
  PoleStrategy pole_strategy{PoleStrategy::kDetour};
  double chart_damping_m{0.1};
  PoleConfig pole;
  TetherModelConfig feed_forward;

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("look_ahead_s", look_ahead_s, Range{0.1, 10.0}, "look-ahead distance over speed");
    v.field("look_ahead_min_m", look_ahead_min_m, Range{0.01, 2.0}, "least look-ahead distance");
    v.field("stop_gain_per_s", stop_gain_per_s, Range{0.05, 5.0},
            "speed over distance when coming to a stop");
    v.field("vehicle_lag_s", vehicle_lag_s, Range{0.0, 2.0},
            "time until commanded rates work: their Jacobian is taken that far ahead");
    v.choice("pole_strategy", pole_strategy, kPoleStrategyNames, "what to do at 90 deg elevation");
    v.field("chart_damping_m", chart_damping_m, Range{0.01, 1.0},
            "unwrapped: distance from the axis below which azimuth is given up, at least");
    v.section("pole", pole);
    v.section("feed_forward", feed_forward);
  }
};

class CompositeLaw final : public Controller {
 public:
  explicit CompositeLaw(const CompositeLawConfig& config) noexcept
      : config_(config), detour_(config.pole) {}

  [[nodiscard]] RateCommand update(Duration dt, const ControlInput& in) noexcept override;
  void reset() noexcept override;
  [[nodiscard]] const char* name() const noexcept override { return "composite"; }

 private:
  CompositeLawConfig config_;
  PoleDetour detour_;
  UnwrappedChart chart_;
  RateCommand last_;  ///< What the chart is reckoned on with.
};

}  // namespace tautline
