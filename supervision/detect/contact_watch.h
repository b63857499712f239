#pragma once

/// @file
/// Does the tether touch something that the mission does not know? Length and angles alone cannot
/// tell: behind a contact they are as consistent as before, about another point. So three
/// witnesses, each with its own threshold (docs/supervisor.md): the map, the barometric height, the
/// localizer's innovations. A fourth, the lever, is in estimation/contact_observer.h.

#include <optional>

#include <Eigen/Core>

#include "common/fields.h"
#include "common/time.h"
#include "supervision/detect/fence.h"
#include "supervision/detect/findings.h"

namespace tautline {

struct ContactWatchConfig {
  double through_obstacle_m{0.3};
  double through_time_s{1.5};
  double height_residual_m{0.6};
  double height_time_s{3.0};
  double nis{6.0};
  double nis_time_s{1.0};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("through_obstacle_m", through_obstacle_m, Range{0.01, 100},
            "of the straight tether inside an obstacle of the map is a contact ...");
    v.field("through_time_s", through_time_s, Range{0, 60}, "... when it lasts this long");
    v.field("height_residual_m", height_residual_m, Range{0.05, 100},
            "between barometric and estimated height is a contact ...");
    v.field("height_time_s", height_time_s, Range{0.1, 60}, "... low-passed with this time");
    v.field("nis", nis, Range{1, 1000}, "normalized innovation above this is a contact ...");
    v.field("nis_time_s", nis_time_s, Range{0, 60}, "... when it lasts this long");
  }
};

struct ContactWatchInput {
  bool flying{false};
  bool usable{false};                             ///< The estimate.
  Eigen::Vector3d p_WA{Eigen::Vector3d::Zero()};  ///< Active anchor.
  Eigen::Vector3d p_WD{Eigen::Vector3d::Zero()};
  double nis{0.0};  ///< Low-passed, per degree of freedom.
  /// Barometric minus estimated height above take-off [m], where sensed.
  std::optional<double> height_residual{};
};

/// kUnplannedContact, with the witness that went farthest beyond its threshold as a ratio to it.
/// Real-time safe: no allocation, no locks, no exceptions.
class ContactWatch {
 public:
  /// Keeps a reference to the obstacles.
  ContactWatch(const ContactWatchConfig& config, const FenceObstacles& obstacles) noexcept
      : config_(config), obstacles_(obstacles) {}

  void update(Time now, const ContactWatchInput& in, Findings& out) noexcept;

 private:
  [[nodiscard]] double throughObstacles(const Eigen::Vector3d& p_WA,
                                        const Eigen::Vector3d& p_WD) const noexcept;

  ContactWatchConfig config_;
  const FenceObstacles& obstacles_;
  std::optional<Time> last_;
  Time clear_of_map_{};       ///< Last time that the straight tether was clear of the map.
  Time innovations_small_{};  ///< Last time that they were.
  double height_residual_{0.0};
};

}  // namespace tautline
