#pragma once

/// @file
/// The ground station's reel: a drum with an encoder, driven at a rate or holding a tension.

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "common/error.h"
#include "common/fields.h"

namespace tautline::sim {

/// What the drum does with a commanded rate.
enum class ReelMode : std::uint8_t {
  kRate,     ///< Turns at it.
  kTension,  ///< Turns at it, faster while the tether pulls harder than `tension`, slower while
             ///< less.
};
inline constexpr std::array<EnumName<ReelMode>, 2> kReelModeNames{
    {{ReelMode::kRate, "rate"}, {ReelMode::kTension, "tension"}}};

struct ReelConfig {
  ReelMode mode{ReelMode::kRate};
  double metres_per_count{0.00285};  ///< What the device's documentation says.
  double scale{1.0};             ///< True metres per nominal metre: what calibration has to find.
  double power_on_length{0.0};   ///< Tether out when the encoder read 0 [m].
  double lag{0.1};               ///< Of the drum's speed behind the command [s].
  double max_acceleration{3.0};  ///< [m/s^2]
  double min_length{0.10};       ///< The end stop [m].
  double max_length{10.0};       ///< All that is on the drum [m].
  double slip_tension{9.0};      ///< The drive gives way above this [N].
  double tension{1.0};           ///< That kTension holds at the outlet [N].
  double compliance{0.5};        ///< Its extra rate over the tension's error [m/s/N].
  double layer{0.0};  ///< Relative loss of metres per count with each metre paid out [1/m]: the
                      ///< drum gets thinner.

  template <class Visitor>
  void fields(Visitor& v) {
    v.choice("mode", mode, kReelModeNames, "what the drum does with a commanded rate");
    v.field("metres_per_count_m", metres_per_count, Range{1e-5, 0.1}, "nominal encoder resolution");
    v.field("scale", scale, Range{0.5, 2.0}, "true metres per nominal metre");
    v.field("power_on_length_m", power_on_length, Range{0, 100},
            "true tether out when the encoder read 0");
    v.field("lag_s", lag, Range{0, 2}, "of the drum's speed behind the command");
    v.field("max_acceleration_mps2", max_acceleration, Range{0.1, 100},
            "of the tether by the drum");
    v.field("min_length_m", min_length, Range{0.05, 10}, "end stop");
    v.field("max_length_m", max_length, Range{0.1, 100}, "all that is on the drum");
    v.field("slip_tension_n", slip_tension, Range{0.5, 100}, "the drive gives way above this");
    v.field("tension_n", tension, Range{0, 50}, "held at the outlet in mode tension");
    v.field("compliance_mps_per_n", compliance, Range{0.01, 10},
            "in mode tension: extra rate over the tension's error");
    v.field("layer_per_m", layer, Range{0, 0.05},
            "relative loss of metres per count with each metre paid out: the drum gets thinner");
  }

  /// Throws InputError for what a single range cannot say.
  void validate() const {
    if (layer * std::max(max_length, power_on_length) < 0.9) return;
    throw InputError({.key = "layer_per_m",
                      .problem = "leaves nothing of the drum when all tether is out",
                      .allowed = "less than 0.9 over max_length_m and power_on_length_m"});
  }
};

/// What keeps the drum from doing as it is told.
struct ReelDisturbance {
  std::optional<double> rate;  ///< The drum is driven at this instead of the command [m/s].
  double follows{1.0};         ///< Share of its turning that the tether follows.
  double min_length{0.0};      ///< The tether is held: no less than this can be wound in [m].
};

/// Pay-out is positive. The command is a length rate in counts per second with the device's dead
/// zone: nothing moves for commands within half its width of its centre (docs/simulator.md). Above
/// the slip tension the drum turns backwards as fast as it must; the encoder sees that.
class Reel {
 public:
  /// `length`: tether out at the start [m].
  Reel(const ReelConfig& config, double length) noexcept;

  /// Sets the commanded rate [counts/s]; NaN counts as 0, larger ones are cut to the device's
  /// limit.
  void command(double counts_per_second) noexcept;
  /// Sets the commanded rate of a reel without dead zone [m/s nominal]; NaN counts as 0.
  void drive(double metres_per_second) noexcept;
  /// A locked reel does not follow commands; it still slips above the slip tension.
  void lock(bool locked) noexcept { locked_ = locked; }
  void disturb(const ReelDisturbance& disturbance) noexcept { disturbance_ = disturbance; }

  /// Advances by h [s] under `tension` at the outlet [N]. Real-time safe: no allocation, no locks,
  /// no exceptions.
  void step(double h, double tension) noexcept;

  [[nodiscard]] double length() const noexcept { return length_; }  ///< Tether out [m].
  [[nodiscard]] double rate() const noexcept { return rate_; }      ///< [m/s]
  /// What it is asked for, by command and lock [m/s].
  [[nodiscard]] double wanted() const noexcept { return locked_ ? 0.0 : commanded_; }
  /// It winds in against a tether that is held, with all its force.
  [[nodiscard]] bool stalled() const noexcept { return stalled_; }
  [[nodiscard]] std::int64_t counts() const noexcept;    ///< Encoder.
  [[nodiscard]] double metresPerCount() const noexcept;  ///< True, of the present layer.
  /// True metres per nominal metre, of all that is out.
  [[nodiscard]] double scale() const noexcept;

 private:
  /// Nominal metres that the drum has turned for `length` [m] of tether.
  [[nodiscard]] double turned(double length) const noexcept;

  ReelConfig config_;
  double length_;
  double rate_{0.0};
  double commanded_{0.0};  // [m/s]
  bool locked_{false};
  ReelDisturbance disturbance_;
  double counted_{0.0};  // turned without tether [m]
  bool stalled_{false};
};

}  // namespace tautline::sim
