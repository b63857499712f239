#pragma once

/// @file
/// What a flight log says about the flight: pure functions from plain series to figures.
/// Definitions and formulas: docs/report.md. A figure that cannot be computed from the log is
/// absent, never zero. Not real-time safe.
///
/// "The position" of the drone is the simulator's truth where the log has it (SIM, HIL), else the
/// estimate.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "app/report/flight_log.h"
#include "app/report/series_math.h"

namespace tautline::report {

/// A number over time.
struct TimedValue {
  double t{};
  double value{};
};

struct TimeSpan {
  double begin{};
  double end{};
  [[nodiscard]] double length() const { return end - begin; }
};

struct Outcome {
  bool mission_completed{};
  bool landed{};  ///< Flew, and is on the ground again with its motors off and unbroken.
  bool flew{};
  bool crashed{};  ///< Simulator only: its own verdict, of hard landings and collisions.
  std::optional<double> touchdown_speed;            ///< Simulator only: last touch-down [m/s].
  MissionState mission_state{MissionState::kIdle};  ///< Last one of the flown mission.
  MissionFailure mission_failure{MissionFailure::kNone};
  std::string
      interruption;  ///< Mode and conditions that ended the mission before its time; empty = none.
  int waypoints_reached{};
  int waypoint_count{};
  std::string text;  ///< One sentence for people.
};

/// One segment of the mission as it was flown.
struct SegmentReport {
  int waypoint{};  ///< Index of its target.
  Eigen::Vector3d start{Eigen::Vector3d::Zero()};
  Eigen::Vector3d target{Eigen::Vector3d::Zero()};
  TimeSpan time;
  std::optional<Summary> cross_track;      ///< [m]
  std::optional<double> closest_approach;  ///< Smallest distance of the position to the target [m].
};

struct CrossTrackReport {
  std::vector<TimedValue> series;  ///< [m]
  std::optional<Summary> all;
  std::vector<SegmentReport> segments;
};

/// Simulator only.
struct LocalizationReport {
  std::vector<TimedValue> series;  ///< |estimate - truth| while airborne [m].
  std::optional<Summary> all;
  std::optional<double> slope_over_length;  ///< Growth of the error with tether length [m/m].
  std::optional<double> final_reel_scale;   ///< Estimated.
  std::optional<double> true_reel_scale;
};

/// While the mission runs.
struct SmoothnessReport {
  std::optional<double> rms_acceleration;  ///< [m/s^2]
  std::optional<double> rms_jerk;          ///< [m/s^3]
  std::optional<double> flown_length;      ///< [m]
  std::optional<double> planned_length;    ///< [m] Of the segments that were begun.
  std::optional<double> path_length_ratio;
  std::optional<std::array<double, 3>>
      sign_changes_hz;  ///< Of the length, elevation and azimuth rate commands.
};

struct LoopReport {
  std::optional<LoopSample> last;  ///< Counters since start.
  std::optional<double> lateness_mean;
  std::optional<double> lateness_max;
  std::optional<double> work_mean;
  std::optional<double> work_max;
};

struct ChannelReport {
  std::string name;
  std::int64_t messages{};
  std::int64_t undecodable{};
  std::optional<double> period;       ///< Median [s].
  std::optional<double> longest_gap;  ///< [s]
  int gaps{};                         ///< Intervals longer than three periods.
};

struct ModeSpan {
  TimeSpan time;
  Mode mode{Mode::kStandby};
  ConditionSet reasons;  ///< Conditions that caused the change; empty = the operator did.
};

struct ContactChange {
  double t{};
  bool formed{};  ///< False: relaxed.
  int id{};       ///< Active contact's id after the change, 0 = reel.
  int count{};
  Eigen::Vector3d p_WA{Eigen::Vector3d::Zero()};
};

struct TetherReport {
  std::optional<double> length_min;  ///< While airborne [m].
  std::optional<double> length_max;
  std::optional<double> tension_min;  ///< While airborne, at the drone [N].
  std::optional<double> tension_max;
  std::vector<ContactChange> contact_changes;
  int contacts_formed{};
};

struct FlightAnalysis {
  std::optional<RunMode> run_mode;
  bool has_truth{};
  std::vector<PositionSample> position;  ///< Truth, else valid estimates.
  std::vector<PositionSample> estimate;  ///< Valid estimates.
  std::optional<PlannedMission>
      plan;                         ///< Of the flown mission, as far as its chunks are in the log.
  std::optional<TimeSpan> mission;  ///< From its first to its last running moment.
  std::optional<TimeSpan> airborne;
  Outcome outcome;
  CrossTrackReport cross_track;
  LocalizationReport localization;
  SmoothnessReport smoothness;
  LoopReport loop;
  std::vector<ChannelReport> channels;
  std::vector<ModeSpan> modes;
  TetherReport tether;
  std::vector<std::string> notes;  ///< What a reader of the figures has to know.
};

[[nodiscard]] FlightAnalysis analyze(const FlightLog& log);

}  // namespace tautline::report
