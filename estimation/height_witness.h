#pragma once

/// @file
/// What the barometer says of the tether's anchor: its height less the one that length, angles and
/// anchor give. Drift of the barometer and slow errors of the tether's model are in the mean since
/// the anchor was changed; a step over it is the anchor's. Section 8 of docs/tether_model.md.

#include <cstdint>
#include <optional>

#include "common/fields.h"
#include "common/time.h"

namespace tautline {

struct HeightWitnessConfig {
  double sigma_m{0.1};
  double correlation_time_s{0.1};
  double mean_time_s{10.0};
  double settle_s{1.0};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("sigma_m", sigma_m, Range{0.001, 10}, "barometric height ...");
    v.field("correlation_time_s", correlation_time_s, Range{0.001, 60},
            "... and the persistence of its errors");
    v.field("mean_time_s", mean_time_s, Range{0.5, 600}, "differences that last longer are drift");
    v.field("settle_s", settle_s, Range{0.1, 60}, "with a new anchor before anything is judged");
  }
};

/// Real-time safe: no allocation, no locks, no exceptions.
class HeightWitness {
 public:
  explicit HeightWitness(const HeightWitnessConfig& config) noexcept : config_(config) {}

  /// Another anchor, or no reading.
  void restart() noexcept;

  /// One cycle. Each reading counts once.
  /// @param sequence Of the barometer's reading.
  /// @param residual Barometric less reckoned height [m].
  void update(Time now, std::uint32_t sequence, double residual) noexcept;

  /// This cycle's log likelihood ratio of a residual that is `step` over its mean against none. 0
  /// without a new reading.
  [[nodiscard]] double evidenceOf(double step) const noexcept;
  /// Of the residual over its mean, low-passed [m].
  [[nodiscard]] double step() const noexcept { return step_; }

 private:
  HeightWitnessConfig config_;
  std::optional<Time> began_;
  Time last_{};
  std::uint32_t sequence_{0};
  double mean_{0.0};
  double residual_{0.0};  ///< Over its mean.
  double step_{0.0};
  double samples_{0.0};  ///< Independent ones in this cycle.
};

}  // namespace tautline
