#pragma once

/// @file
/// Is the reel's scale the one that it was calibrated to? A reel read with the wrong scale puts the
/// drone where it is not, in proportion to the length (docs/tether_model.md, section 5).

#include <cmath>

#include "common/fields.h"
#include "supervision/detect/findings.h"

namespace tautline {

struct ReelScaleConfig {
  double tolerance{0.06};
  double sigmas{3.0};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("tolerance", tolerance, Range{0.001, 10},
            "of the estimated reel scale from 1 is a wrong calibration ...");
    v.field("sigmas", sigmas, Range{1, 100}, "... when it is also this many of its sigmas");
  }
};

/// kReelScale, with the estimated scale [true metres per nominal metre] and the side's limit.
/// Real-time safe: no allocation, no locks, no exceptions.
class ReelScaleWatch {
 public:
  explicit ReelScaleWatch(const ReelScaleConfig& config) noexcept : config_(config) {}

  /// Scale and sigma as estimated; `known`: in flight, with an estimate that may be used.
  void update(bool known, double scale, double sigma, Findings& out) const noexcept {
    const double error = scale - 1.0;
    const bool is =
        known && std::abs(error) > config_.tolerance && std::abs(error) > config_.sigmas * sigma;
    out.report(Condition::kReelScale, is, scale, 1.0 + std::copysign(config_.tolerance, error));
  }

 private:
  ReelScaleConfig config_;
};

}  // namespace tautline
