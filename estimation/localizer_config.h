#pragma once

/// @file
/// Settings of the localizer: the tether and drone constants of the model, the prior and process
/// noise of each filter state, the noise of each sensor, and the limits of its health. Section 5 of
/// docs/tether_model.md.

#include <array>
#include <cstdint>
#include <optional>

#include "common/fields.h"
#include "estimation/position_fix.h"
#include "estimation/sensor_health.h"

namespace tautline {

/// The filter, or one of the memoryless fixes run on the newest samples.
enum class LocalizerVariant : std::uint8_t {
  kFilter,
  kExact,
  kStraight,
  kAsPublishedText,
  kAsPublishedCode,
};
inline constexpr std::array<EnumName<LocalizerVariant>, 5> kLocalizerVariantNames{
    {{LocalizerVariant::kFilter, "filter"},
     {LocalizerVariant::kExact, "exact"},
     {LocalizerVariant::kStraight, "straight"},
     {LocalizerVariant::kAsPublishedText, "as-published-text"},
     {LocalizerVariant::kAsPublishedCode, "as-published-code"}}};

/// The memoryless fix behind a variant; empty for the filter.
[[nodiscard]] constexpr std::optional<FixVariant> fixOf(LocalizerVariant variant) noexcept {
  switch (variant) {
    case LocalizerVariant::kFilter:
      return std::nullopt;
    case LocalizerVariant::kExact:
      return FixVariant::kExact;
    case LocalizerVariant::kStraight:
      return FixVariant::kStraight;
    case LocalizerVariant::kAsPublishedText:
      return FixVariant::kAsPublishedText;
    case LocalizerVariant::kAsPublishedCode:
      return FixVariant::kAsPublishedCode;
  }
  return std::nullopt;
}

/// Where the filter starts: standard deviations before the first sample.
struct LocalizerPriorConfig {
  double position_sigma_m{0.05};         ///< On the ground.
  double takeoff_position_sigma_m{0.5};  ///< When the vehicle first says that it flies.
  double takeoff_velocity_sigma_mps{0.5};
  double reel_scale_sigma{
      0.03};  ///< Calibrated with two marks; 0.5 for a reel that never was: those are off by 40 %.
  double parked_slack_sigma_m{0.05};  ///< Tether beyond the straight line to the parked drone.
  double azimuth_zero_sigma_rad{0.02};
  double elevation_bias_sigma_rad{0.015};
  double altitude_offset_sigma_m{0.3};
  double contact_sigma_m{0.05};  ///< Error of each contact's position.

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("position_sigma_m", position_sigma_m, Range{0.001, 10}, "position before take-off");
    v.field("takeoff_position_sigma_m", takeoff_position_sigma_m, Range{0.001, 10},
            "position when the vehicle first flies");
    v.field("takeoff_velocity_sigma_mps", takeoff_velocity_sigma_mps, Range{0.001, 10},
            "velocity then");
    v.field("reel_scale_sigma", reel_scale_sigma, Range{0, 1},
            "relative error of the reel's calibration; 0.5: never calibrated");
    v.field("parked_slack_sigma_m", parked_slack_sigma_m, Range{0.001, 10},
            "tether beyond the straight line to the parked drone");
    v.field("azimuth_zero_sigma_rad", azimuth_zero_sigma_rad, Range{0, 1},
            "error of the azimuth's zero");
    v.field("elevation_bias_sigma_rad", elevation_bias_sigma_rad, Range{0, 1},
            "bias of the sensed elevation");
    v.field("altitude_offset_sigma_m", altitude_offset_sigma_m, Range{0, 10},
            "offset of the barometric height");
    v.field("contact_sigma_m", contact_sigma_m, Range{0, 10}, "error of each contact's position");
  }
};

/// How the states move between samples. Constants drift as random walks; 0 = truly constant.
struct LocalizerProcessConfig {
  double velocity_time_constant_s{0.4};  ///< Velocity follows the command with this lag ...
  double velocity_sigma_mps{0.12};       ///< ... and departs from it by this much.
  double tension_time_constant_s{10.0};  ///< Tension returns to nominal_tension_n with this lag ...
  double tension_sigma{0.5};             ///< ... and departs from it by this factor's logarithm.
  double reel_scale_drift{0.0005};       ///< Per square root of a second, as all that follow.
  double azimuth_zero_drift_rad{0.0005};
  double elevation_bias_drift_rad{0.0003};
  double altitude_offset_drift_m{0.01};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("velocity_time_constant_s", velocity_time_constant_s, Range{0.01, 10},
            "lag of velocity behind the command");
    v.field("velocity_sigma_mps", velocity_sigma_mps, Range{0.001, 5},
            "departure of velocity from the command");
    v.field("tension_time_constant_s", tension_time_constant_s, Range{0.1, 1000},
            "pull of tension back to nominal");
    v.field("tension_sigma", tension_sigma, Range{0.01, 3},
            "departure of ln(tension) from nominal");
    v.field("reel_scale_drift", reel_scale_drift, Range{0, 0.1}, "random walk, per sqrt(s)");
    v.field("azimuth_zero_drift_rad", azimuth_zero_drift_rad, Range{0, 0.1},
            "random walk, per sqrt(s)");
    v.field("elevation_bias_drift_rad", elevation_bias_drift_rad, Range{0, 0.1},
            "random walk, per sqrt(s)");
    v.field("altitude_offset_drift_m", altitude_offset_drift_m, Range{0, 1},
            "random walk, per sqrt(s)");
  }
};

/// Noise of the sensors. Errors that persist (quantization while hovering, a badly levelled
/// attitude) carry no new information in every sample: a noise with correlation time tau, sampled
/// every dt < 2 tau, is weighted by 2 tau/dt.
struct LocalizerNoiseConfig {
  double length_sigma_m{0.01};
  double elevation_sigma_rad{0.006};
  double azimuth_sigma_rad{0.006};
  double correlation_time_s{0.3};  ///< Of length and angles.
  bool use_altitude{true};
  double altitude_sigma_m{0.2};
  double altitude_correlation_time_s{5.0};
  double lean_sigma_rad{0.035};
  double reel_tension_sigma{0.2};  ///< Relative.
  double capstan_log_sigma{0.47};  ///< Of ln(tension across one contact): 0.3 x 90 deg either way.
  double tension_correlation_time_s{2.0};  ///< Of lean and reel tension.

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("length_sigma_m", length_sigma_m, Range{0.0001, 10}, "reel length");
    v.field("elevation_sigma_rad", elevation_sigma_rad, Range{0.0001, 1},
            "tether elevation, quantization included");
    v.field("azimuth_sigma_rad", azimuth_sigma_rad, Range{0.0001, 1},
            "tether azimuth, quantization included");
    v.field("correlation_time_s", correlation_time_s, Range{0, 60},
            "persistence of length and angle errors");
    v.field("use_altitude", use_altitude, "use the barometric height, where sensed");
    v.field("altitude_sigma_m", altitude_sigma_m, Range{0.001, 100}, "barometric height");
    v.field("altitude_correlation_time_s", altitude_correlation_time_s, Range{0, 600},
            "persistence of its errors");
    v.field("lean_sigma_rad", lean_sigma_rad, Range{0.0001, 1},
            "lean of the thrust axis, its level included");
    v.field("reel_tension_sigma", reel_tension_sigma, Range{0.001, 10},
            "reel motor's tension, relative");
    v.field("capstan_log_sigma", capstan_log_sigma, Range{0, 5}, "ln(tension) across one contact");
    v.field("tension_correlation_time_s", tension_correlation_time_s, Range{0, 60},
            "persistence of lean and reel tension errors");
  }
};

/// When samples are refused and when the estimate is degraded or lost.
struct LocalizerHealthConfig {
  double innovation_gate{5.0};  ///< Innovations beyond this many sigmas are refused.
  int reacquire_after{3};       ///< So many refusals in a row of one stream, ...
  double reacquire_time_s{
      1.0};  ///< ... over at least this long, and the filter gives up its position for it.
  double reacquire_sigma_m{1.0};  ///< Position uncertainty that it then adds.
  double degraded_nis{
      4.0};  ///< Low-passed normalized innovation per degree of freedom: degraded above this, ...
  double lost_nis{9.0};  ///< ... lost above this.
  double degraded_position_sigma_m{0.4};
  double lost_position_sigma_m{1.0};
  double lost_factor{
      2.5};  ///< No accepted reel or angle sample for so many times what makes it stale: lost.

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("innovation_gate", innovation_gate, Range{1, 100},
            "sigmas beyond which a sample is refused");
    v.field("reacquire_after", reacquire_after, Range{1, 1000},
            "refusals in a row after which position is given up ...");
    v.field("reacquire_time_s", reacquire_time_s, Range{0, 60},
            "... if they last at least this long");
    v.field("reacquire_sigma_m", reacquire_sigma_m, Range{0.01, 100},
            "position uncertainty that is then added");
    v.field("degraded_nis", degraded_nis, Range{1, 1000},
            "normalized innovation above which health is degraded");
    v.field("lost_nis", lost_nis, Range{1, 1000},
            "normalized innovation above which health is lost");
    v.field("degraded_position_sigma_m", degraded_position_sigma_m, Range{0.01, 100},
            "position sigma above which health is degraded");
    v.field("lost_position_sigma_m", lost_position_sigma_m, Range{0.01, 100},
            "position sigma above which health is lost");
    v.field("lost_factor", lost_factor, Range{1, 100},
            "times the stale age without an accepted sample: health is lost");
  }
};

struct LocalizerConfig {
  LocalizerVariant variant{LocalizerVariant::kFilter};
  double tether_weight_n_per_m{0.0061 * 9.81};  ///< w: 0.0061 kg/m.
  double vehicle_weight_n{6.0};                 ///< G.
  double nominal_tension_n{0.35};               ///< T at the drone where nothing else is known.
  LocalizerPriorConfig prior;
  LocalizerProcessConfig process;
  LocalizerNoiseConfig noise;
  LocalizerHealthConfig health;
  SensorHealthConfig sensors;

  template <class Visitor>
  void fields(Visitor& v) {
    v.choice("variant", variant, kLocalizerVariantNames,
             "filter, or a memoryless fix for comparison");
    v.field("tether_weight_n_per_m", tether_weight_n_per_m, Range{1e-6, 10},
            "tether weight per length");
    v.field("vehicle_weight_n", vehicle_weight_n, Range{0.1, 1000}, "weight of the vehicle");
    v.field("nominal_tension_n", nominal_tension_n, Range{0.01, 1000},
            "tension at the vehicle where nothing else is known");
    v.section("prior", prior);
    v.section("process", process);
    v.section("noise", noise);
    v.section("health", health);
    v.section("sensors", sensors);
  }
};

}  // namespace tautline
