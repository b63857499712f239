#pragma once

/// @file
/// A published flight once more: its telegrams through the driver, the published estimator and
/// executor, held against what its own program logged; and through our estimator, detectors and
/// supervisor. docs/real_logs.md. Not real-time safe.

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "app/station/recording.h"
#include "app/station/station_config.h"

namespace tautline::experiments {

/// Largest differences to the log: of our position, and of the executor's target. Its program had
/// the same sensors, so what is left is the six digits of the log.
struct LogAgreement {
  int rows{0};                   ///< Compared.
  int position_off{0};           ///< Rows with more than 2 mm.
  double position{0.0};          ///< [m]
  int targets{0};                ///< Rows with a target compared.
  int other_target{0};           ///< Rows in which the executor was at another waypoint.
  double target_length{0.0};     ///< [m]
  double target_elevation{0.0};  ///< [rad]
  double target_azimuth{0.0};    ///< [rad]
};

/// What the log says of the machine.
struct LogFigures {
  double duration{0.0};           ///< First to last row [s].
  int lengths{0};                 ///< Different ones.
  std::optional<double> quantum;  ///< Of which all are multiples [m]; absent: too few.
  double new_samples{0.0};        ///< Rows with another length or direction, a second.
  int fullest_second{0};          ///< Rows of one second, at most.
};

/// What our supervisor says to it: the flight is its AUTO until it takes that away.
struct SupervisorVerdict {
  struct Raised {
    Condition condition{};
    double first{0.0};   ///< Since take-off [s].
    double lasted{0.0};  ///< In all [s].
  };
  std::optional<double> intervened;  ///< Since take-off [s]; absent: never.
  Mode mode{Mode::kAuto};            ///< Where it went then.
  Mode last_mode{Mode::kAuto};       ///< At the end of the log.
  ConditionSet reasons;              ///< Of the first.
  std::vector<Raised> raised;        ///< In flight; conditions that are something wrong.
  double usable{0.0};                ///< Share of the time with a usable estimate.
  double reel_scale{1.0};            ///< Our filter's, at the end.
  double sigma_reel_scale{0.0};
};

/// Tether contacts in the order in which the log comes to them [m]; empty: none.
[[nodiscard]] std::vector<Eigen::Vector3d> contactsOf(const Recording& recording);

/// `station` is the published one. Targets only where the log has contact columns (`with_targets`):
/// the earlier programs meant other things by them.
[[nodiscard]] LogAgreement agreement(const Recording& recording, const StationConfig& station,
                                     bool with_targets);

[[nodiscard]] LogFigures figuresOf(const Recording& recording);

/// `station` is ours; with the obstacles of the flight's place where they are known.
[[nodiscard]] SupervisorVerdict verdictOn(const Recording& recording, const StationConfig& station);

}  // namespace tautline::experiments
