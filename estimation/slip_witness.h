#pragma once

/// @file
/// Has the tether slid along the edge of its contact? Length, angles and lean are the same before
/// and after, but the drone has moved with the contact, and where the edge is not level the
/// barometer feels it: barometric less reckoned height steps. Drift of the barometer and slow
/// errors of the tether's model are in its mean before. Section 8 of docs/tether_model.md.

#include <cstdint>
#include <optional>

#include "common/fields.h"
#include "common/time.h"

namespace tautline {

struct SlipWitnessConfig {
  double slip_m{0.2};
  double sigma_m{0.1};
  double correlation_time_s{0.1};
  double mean_time_s{10.0};
  double settle_s{1.0};
  double memory_s{8.0};
  double false_alarms_per_hour{0.1};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("slip_m", slip_m, Range{0.02, 10},
            "up or down along a contact's edge that is told soon; half of it is told later");
    v.field("sigma_m", sigma_m, Range{0.001, 10}, "barometric height ...");
    v.field("correlation_time_s", correlation_time_s, Range{0.001, 60},
            "... and the persistence of its errors");
    v.field("mean_time_s", mean_time_s, Range{0.5, 600}, "differences that last longer are drift");
    v.field("settle_s", settle_s, Range{0.1, 60}, "at a contact before anything is judged");
    v.field("memory_s", memory_s, Range{0.5, 600}, "evidence decays with this time");
    v.field("false_alarms_per_hour", false_alarms_per_hour, Range{1e-6, 1000},
            "on which the threshold is set");
  }
};

/// Two cumulated log likelihood ratios: of a step by +slip_m and by -slip_m, against none.
/// Real-time safe: no allocation, no locks, no exceptions.
class SlipWitness {
 public:
  explicit SlipWitness(const SlipWitnessConfig& config) noexcept;

  /// Another contact, none, or no reading.
  void restart() noexcept;

  /// One cycle at a contact.
  /// @param sequence Of the message that brought the barometer's reading; each counts once.
  /// @param residual Barometric less reckoned height [m].
  void update(Time now, std::uint32_t sequence, double residual) noexcept;

  /// Over what it takes: 1. Once there a slip stays one until the restart.
  [[nodiscard]] double evidence() const noexcept { return evidence_; }
  [[nodiscard]] bool slipped() const noexcept { return evidence_ >= 1.0; }
  /// By how much, upwards [m]; 0 without evidence.
  [[nodiscard]] double slip() const noexcept { return slip_; }

 private:
  /// A cumulated log likelihood ratio, and the mean residual since it last was zero.
  struct Sum {
    double step;
    double evidence{0.0};
    double time{0.0};
    double mean{0.0};
  };
  void add(Sum& sum, double dt, double residual, double variance) const noexcept;

  SlipWitnessConfig config_;
  double threshold_;
  Sum up_, down_;
  std::optional<Time> began_;
  Time last_{};
  std::uint32_t sequence_{0};
  double mean_{0.0};  ///< Of the residual, before a slip.
  double evidence_{0.0};
  double slip_{0.0};
};

}  // namespace tautline
