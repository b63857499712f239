#pragma once

/// @file
/// Does the tether turn about the point that the executor believes in? Section 8 of
/// docs/tether_model.md.
///
/// Length and angles are the same whatever the drone turns about: behind a contact that nobody
/// knows they are as consistent as before. What differs is how far the drone moves when its angles
/// turn, and that is felt: the lean sideways accelerates the drone, and what it accelerates by,
/// divided by how much faster the azimuth turns, is the lever. Hypotheses about the lever are
/// judged by the likelihood ratio of what the lean and the turning of the tether say about the
/// sideways velocity. Of a contact that slides along its edge the lever says nothing; the barometer
/// does (slip_witness.h).

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/estimate.h"
#include "common/fields.h"
#include "common/time.h"
#include "estimation/slip_witness.h"

namespace tautline {

/// What the tether turns about.
enum class TetherHypothesis : std::uint8_t {
  kHolds,      ///< The active anchor.
  kNotFormed,  ///< The anchor before it: the planned contact is not there (yet).
  kLost,       ///< Not the active anchor, which was seen to hold: the tether has come off.
  kUnplanned,  ///< A point between anchor and drone that nobody planned.
  kSlipped,    ///< The active anchor, which has slid along its edge.
};
inline constexpr std::array<EnumName<TetherHypothesis>, 5> kTetherHypothesisNames{
    {{TetherHypothesis::kHolds, "holds"},
     {TetherHypothesis::kNotFormed, "not formed"},
     {TetherHypothesis::kLost, "lost"},
     {TetherHypothesis::kUnplanned, "unplanned"},
     {TetherHypothesis::kSlipped, "slipped"}}};

struct ContactObserverConfig {
  double smoothing_rate_hz{1.0};
  double forget_rate_hz{0.5};
  double drag_per_s{0.5};
  double bias_time_s{4.0};
  double sigma_mps{0.03};
  double lever_sigma{0.15};
  double correlation_time_s{0.15};
  double false_alarms_per_hour{0.1};
  double memory_s{8.0};
  double least_lever_m{0.3};
  double settle_s{4.0};
  double relax_s{3.0};
  double form_s{0.9};
  double longest_period_s{0.06};
  double least_tension_n{0.4};
  SlipWitnessConfig slip;

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("smoothing_rate_hz", smoothing_rate_hz, Range{0.1, 50},
            "bandwidth in which lean and turning are compared ...");
    v.field("forget_rate_hz", forget_rate_hz, Range{0.01, 10},
            "... and how soon velocity is forgotten");
    v.field("drag_per_s", drag_per_s, Range{0, 10},
            "deceleration by drag, of vehicle and tether, over the velocity");
    v.field("bias_time_s", bias_time_s, Range{0.5, 600},
            "lean and wind that last longer are not motion");
    v.field("sigma_mps", sigma_mps, Range{0.001, 10},
            "of the sideways velocity: wind, waves of the tether, noise ...");
    v.field("lever_sigma", lever_sigma, Range{0, 1}, "... and of the lever, relative");
    v.field("correlation_time_s", correlation_time_s, Range{0.01, 10},
            "persistence of these errors");
    v.field("false_alarms_per_hour", false_alarms_per_hour, Range{1e-6, 1000},
            "of each hypothesis, on which the threshold is set");
    v.field("memory_s", memory_s, Range{0.5, 600}, "evidence decays with this time");
    v.field("least_lever_m", least_lever_m, Range{0.05, 10},
            "levers nearer to each other are not told apart");
    v.field("settle_s", settle_s, Range{0, 60}, "after take-off before anything is judged");
    v.field("relax_s", relax_s, Range{0, 60},
            "a contact that was let go may hold on for this long");
    v.field("form_s", form_s, Range{0, 60}, "a planned contact may form this late");
    v.field("longest_period_s", longest_period_s, Range{0.001, 10},
            "slower angles or attitude show no accelerations: nothing is judged");
    v.field("least_tension_n", least_tension_n, Range{0, 100},
            "a tether with less nominal tension moves otherwise than its end: nothing is judged");
    v.section("slip", slip);
  }
};

/// One cycle's readings, corrected for what is known of the sensors; the newest there are.
struct ContactObserverInput {
  bool flying{false};   ///< In the air, with sensors and an estimate that may be used.
  double L_total{0.0};  ///< True metres, so times the reel scale [m].
  double theta{0.0};    ///< Tangent elevation at D [rad].
  double sag{0.0};      ///< By how much the chord's is less [rad].
  double phi{0.0};      ///< [rad]
  Eigen::Quaterniond R_WB{Eigen::Quaterniond::Identity()};
  double T{0.0};                     ///< At D [N].
  double G{6.0};                     ///< Weight of the vehicle [N].
  Anchor anchor;                     ///< The active one.
  std::optional<double> height;      ///< Barometric, in W [m], where sensed.
  std::uint32_t height_sequence{0};  ///< Of the message that brought it.
};

struct ContactVerdict {
  TetherHypothesis hypothesis{TetherHypothesis::kHolds};
  double evidence{0.0};  ///< Of the most likely other anchor, over what it takes: 1.
  double lever{0.0};     ///< From the drone to what the tether turns about, under it [m].
  Eigen::Vector3d p_WC{Eigen::Vector3d::Zero()};  ///< Where that is.
  double slip{0.0};  ///< By how much the active one has slid, upwards [m].
};

/// A vector signal x through lambda^2/(s + lambda)^2/(s + a), and its first two derivatives so.
class BandFilter {
 public:
  void reset(const Eigen::Vector3d& x, double a) noexcept;
  void update(double dt, double lambda, double a, const Eigen::Vector3d& x) noexcept;
  /// Moves the signal and all its past: a step that is not motion.
  void shift(const Eigen::Vector3d& by, double a) noexcept;
  [[nodiscard]] const Eigen::Vector3d& value() const noexcept { return s3_; }
  [[nodiscard]] Eigen::Vector3d rate(double a) const noexcept { return s2_ - a * s3_; }
  [[nodiscard]] Eigen::Vector3d acceleration(double lambda, double a) const noexcept {
    return lambda * (s1_ - s2_) - a * rate(a);
  }

 private:
  Eigen::Vector3d s1_{Eigen::Vector3d::Zero()};
  Eigen::Vector3d s2_{Eigen::Vector3d::Zero()};
  Eigen::Vector3d s3_{Eigen::Vector3d::Zero()};
};

/// Real-time safe: no allocation, no locks, no exceptions.
class ContactObserver {
 public:
  explicit ContactObserver(const ContactObserverConfig& config) noexcept;

  /// One cycle. Time that does not go on, and readings that are not finite, change nothing.
  [[nodiscard]] const ContactVerdict& update(Time now, const ContactObserverInput& in) noexcept;

 private:
  static constexpr std::array<double, 3> kUnplannedShares{0.25, 0.5, 0.75};
  static constexpr int kDeepest = 64;  // contacts whose places are remembered

  void changeAnchor(Time now, const ContactObserverInput& in, const Eigen::Vector3d& d) noexcept;
  [[nodiscard]] const Eigen::Vector3d* anchorBelow() const noexcept;
  void judge(Time now, double dt, double L) noexcept;
  void watchSlip(Time now, const ContactObserverInput& in, double L) noexcept;
  void decide(const ContactObserverInput& in, const Eigen::Vector3d& d, double L) noexcept;
  [[nodiscard]] double evidenceOf(double extra, double L) const noexcept;

  ContactObserverConfig config_;
  double lambda_, a_, threshold_;
  std::optional<Time> last_, began_, changed_;
  bool popped_{false};
  bool formed_{false};  ///< The active contact was seen to hold.
  std::array<std::optional<Eigen::Vector3d>, kDeepest + 1>
      anchors_{};  ///< By depth; as far as seen.
  Anchor anchor_;
  Eigen::Vector3d offset_{Eigen::Vector3d::Zero()};
  BandFilter p_, d_, f_;
  SlipWitness slip_;
  double bias_{0.0};
  double residual_{0.0};
  double turning_{0.0};
  double before_{0.0};  ///< Evidence for the anchor before the active one, ...
  double holds_{0.0};   ///< ... against it, ...
  std::array<double, kUnplannedShares.size()> unplanned_{};  ///< ... for a contact at each share.
  ContactVerdict verdict_;
};

}  // namespace tautline
