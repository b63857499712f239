#pragma once

/// @file
/// Readings that moved farther between two good samples than reel or vehicle can. A reading that
/// comes back after an outage has had that long to move.

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "common/fields.h"
#include "common/time.h"
#include "supervision/detect/findings.h"

namespace tautline {

struct JumpConfig {
  double length_rate_mps{2.0};
  double length_noise_m{0.05};
  double angle_rate_radps{2.0};
  double angle_noise_rad{0.08};
  double time_jitter_s{0.1};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("length_rate_mps", length_rate_mps, Range{0.01, 100},
            "no reel moves faster, slipping included");
    v.field("length_noise_m", length_noise_m, Range{0, 10}, "a step that is only noise");
    v.field("angle_rate_radps", angle_rate_radps, Range{0.01, 100},
            "the tether's direction at the drone turns no faster");
    v.field("angle_noise_rad", angle_noise_rad, Range{0, 3}, "a step that is only noise");
    v.field("time_jitter_s", time_jitter_s, Range{0, 10}, "error of the time between two samples");
  }
};

/// One good sample of a stream; `sequence` grows with each, 0 = none yet.
struct SampledLength {
  std::uint32_t sequence{0};
  Time time{};
  double length{0.0};  ///< Total tether [m].
};
struct SampledAngles {
  std::uint32_t sequence{0};
  Time time{};
  double theta{0.0};  ///< [rad]
  double phi{0.0};    ///< [rad], any branch.
};

/// kReelJump, kAnglesJump: raised from a sample that jumped until the next one that did not.
/// Real-time safe: no allocation, no locks, no exceptions.
class JumpDetector {
 public:
  explicit JumpDetector(const JumpConfig& config) noexcept : config_(config) {}

  /// Streams without a new good sample are left as they are.
  void update(const SampledLength& length, const SampledAngles& angles, Findings& out) noexcept;

 private:
  struct Step {
    double size{0.0};
    double allowed{0.0};
  };

  JumpConfig config_;
  std::optional<SampledLength> last_length_;
  std::optional<SampledAngles> last_angles_;
  Step length_step_, angle_step_;
};

}  // namespace tautline
