#pragma once

/// @file
/// A flight's LCM log as plain series: what the pure functions of analysis.h work on. Not real-time
/// safe.
///
/// Times are seconds since the station's first message in the log (or the simulator's, without a
/// station), by the senders' own clocks (`utime`). Positions are in the world frame W, SI units,
/// radians.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "app/station/events.h"
#include "common/estimate.h"
#include "common/vehicle.h"
#include "control/motion_executor.h"
#include "supervision/supervisor.h"

namespace tautline::report {

struct StateSample {
  double t{};
  RunMode run_mode{RunMode::kReal};
  Mode mode{Mode::kStandby};
  ConditionSet reasons{};
  std::int64_t mission_hash{};
};

struct EstimateSample {
  double t{};
  bool valid{};
  EstimateHealth health{EstimateHealth::kLost};
  Eigen::Vector3d p_WD{Eigen::Vector3d::Zero()};
  double T{};
  double reel_scale{1.0};
};

struct TruthSample {
  double t{};
  Eigen::Vector3d p_WD{Eigen::Vector3d::Zero()};
  Eigen::Vector3d v_WD{Eigen::Vector3d::Zero()};
  double T{};
  double L_total{};
  double reel_scale{1.0};
  double theta{};
  double phi{};
  bool on_ground{true};
  bool motors_on{};
  bool crashed{};
  int contact_count{};
  Eigen::Vector3d p_WA{Eigen::Vector3d::Zero()};
};

struct TetherSample {
  double t{};
  double L_meas{};  ///< Total, nominal calibration.
  double L_free{};
  double L_static{};
  double theta{};
  double phi{};
  double T{};
  int contact_count{};
  int contact_id{};  ///< 0 = anchored at the reel.
  Eigen::Vector3d p_WA{Eigen::Vector3d::Zero()};
};

struct VehicleSample {
  double t{};
  VehiclePhase phase{VehiclePhase::kUnknown};
};

struct CommandSample {
  double t{};
  bool engaged{};
  double length_rate{};
  double elevation_rate{};
  double azimuth_rate{};
};

struct MissionSample {
  double t{};
  std::int64_t hash{};
  MissionState state{MissionState::kIdle};
  MissionFailure failure{MissionFailure::kNone};
  int waypoint{};
  int waypoint_count{};
  Eigen::Vector3d target{Eigen::Vector3d::Zero()};
  Eigen::Vector3d segment_start{Eigen::Vector3d::Zero()};
  double cross_track{};
};

struct LoopSample {
  double t{};
  double period{};
  std::int64_t cycles{};
  std::int64_t overruns{};
  std::int64_t skipped{};
  double lateness_mean{};
  double lateness_max{};
  double work_mean{};
  double work_max{};
  double work_max_ever{};
  std::int64_t publish_errors{};
  std::int64_t commands_refused{};
};

struct LoggedEvent {
  double t{};
  Severity severity{Severity::kInfo};
  int code{};
  std::string text;
  std::string reaction;
  std::string remedy;
};

struct PlannedWaypoint {
  Eigen::Vector3d p_WD{Eigen::Vector3d::Zero()};
  int contact_id{};
};

struct PlannedContact {
  int id{};
  Eigen::Vector3d p_WC{Eigen::Vector3d::Zero()};
};

/// A mission as it went over the wire, put together from its chunks.
struct PlannedMission {
  std::vector<std::optional<PlannedWaypoint>>
      waypoints;  ///< Empty slots: their chunk is not in the log.
  std::vector<std::optional<PlannedContact>> contacts;

  [[nodiscard]] bool complete() const;
};

/// Arrivals on one channel.
struct ChannelStats {
  std::int64_t messages{};
  std::int64_t undecodable{};
  std::vector<double> times;  ///< Of the decodable ones, by utime.
};

struct FlightLog {
  std::string file;
  std::int64_t start_utime{};  ///< [us] of t = 0.
  double
      duration{};  ///< [s] From the station's (or else the simulator's) first message to its last.
  bool truth_on_other_clock{};  ///< SIM_TRUTH does not overlap the station's time; `truth` was left
                                ///< empty.
  std::string damage;  ///< What is missing of the file itself, in one line; empty if it is whole.
  std::map<std::string, ChannelStats> channels;

  std::vector<StateSample> states;
  std::vector<EstimateSample> estimates;
  std::vector<TruthSample> truth;
  std::vector<TetherSample> tether;
  std::vector<VehicleSample> vehicle;
  std::vector<CommandSample> commands;
  std::vector<MissionSample> mission;
  std::vector<LoopSample> loop;
  std::vector<LoggedEvent> events;
  std::map<std::int64_t, PlannedMission> missions;  ///< By mission hash.
  std::map<std::string, std::string> programs;      ///< Name and version of who published PARAMS.
};

/// Reads a log written by `tautline log record`, lcm-logger or the bench. Messages that do not
/// decode and damaged places are counted. Throws InputError when the file cannot be read, holds no
/// message of the station or the simulator, or was recorded by a version with other messages.
[[nodiscard]] FlightLog readFlightLog(const std::filesystem::path& file);

}  // namespace tautline::report
