#pragma once

/// @file
/// Published position control (dissertation section 5.2.1): three independent laws on length,
/// elevation and azimuth that pull towards the segment's end. Between sparse waypoints the drone
/// follows arcs, not lines; at the pole it goes round. Kept for comparison and as the simplest law
/// there is.

#include <array>
#include <cstdint>

#include "control/controller.h"
#include "control/tether_target.h"

namespace tautline {

enum class LengthLaw : std::uint8_t {
  kProportional,
  kBangBang,  ///< What flew: a fixed step in or out with every position message.
};
inline constexpr std::array<EnumName<LengthLaw>, 2> kLengthLawNames{
    {{LengthLaw::kProportional, "proportional"}, {LengthLaw::kBangBang, "bang_bang"}}};

struct PositionLawConfig {
  double elevation_gain_per_s{0.25};
  double azimuth_gain_per_s{0.2};
  LengthLaw length_law{LengthLaw::kProportional};
  double length_gain_per_s{0.5};
  double bang_bang_step_m{0.00855};
  double message_rate_hz{10.0};
  double damping{0.0};
  TetherModelConfig target;

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("elevation_gain_per_s", elevation_gain_per_s, Range{0.0, 10.0}, "P gain, elevation");
    v.field("azimuth_gain_per_s", azimuth_gain_per_s, Range{0.0, 10.0}, "P gain, azimuth");
    v.choice("length_law", length_law, kLengthLawNames, "how the length is driven");
    v.field("length_gain_per_s", length_gain_per_s, Range{0.0, 10.0}, "P gain, length");
    v.field("bang_bang_step_m", bang_bang_step_m, Range{0.0, 1.0},
            "bang-bang: step with each position message (3 counts of 2.85 mm)");
    v.field("message_rate_hz", message_rate_hz, Range{0.1, 1000.0},
            "bang-bang: position messages a second");
    v.field("damping", damping, Range{0.0, 1.0},
            "D gain on all three, as a share of the measured rate; 0 as flown");
    v.section("target", target);
  }
};

/// u = K_P (q_d - q) - K_D q_dot, azimuth wrapped, each rate clamped by itself, eq. (C1).
class PositionLaw final : public Controller {
 public:
  explicit PositionLaw(const PositionLawConfig& config) noexcept : config_(config) {}

  [[nodiscard]] RateCommand update(Duration dt, const ControlInput& in) noexcept override;
  void reset() noexcept override {}
  [[nodiscard]] const char* name() const noexcept override { return "position"; }

 private:
  [[nodiscard]] double lengthRate(double error, double rate) const noexcept;

  PositionLawConfig config_;
};

}  // namespace tautline
