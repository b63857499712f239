#pragma once

/// @file
/// A flight in lock-step with what the experiments measure: where the drone was, where the station
/// believed it to be, and the active contact, while the mission was flown. Not real-time safe.

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "app/bench/lockstep.h"
#include "common/mission_plan.h"

namespace tautline::experiments {

struct TrackPoint {
  double t{0.0};                                           ///< Since the mission began [s].
  Eigen::Vector3d p_WD{Eigen::Vector3d::Zero()};           ///< True [m].
  Eigen::Vector3d p_WD_estimate{Eigen::Vector3d::Zero()};  ///< The station's [m].
  int waypoint{0};                                         ///< Index of the target.
  int contacts{0};                                         ///< On the executor's stack.
  int true_contacts{0};                                    ///< Where the tether really rests.
  Eigen::Vector3d p_WA{Eigen::Vector3d::Zero()};           ///< True last contact, or the reel [m].
  Eigen::Vector3d p_WA_planned{Eigen::Vector3d::Zero()};   ///< The executor's [m].
};

struct TrackedFlight {
  bench::FlightResult result;
  Mode last_mode{Mode::kStandby};  ///< When the mission ended.
  std::string reasons;  ///< First conditions that ended the mission by themselves; empty: none did.
  std::vector<TrackPoint> track;  ///< 20 a second, from NAVIGATE to the end of the mission.
};

/// Arms, takes off, flies the mission, lands.
[[nodiscard]] TrackedFlight flyTracked(const bench::LockstepConfig& config,
                                       const MissionPlan& mission, Duration limit);

/// Straight legs through `points`, all with the reel as anchor, and a hold at the end [s].
[[nodiscard]] std::unique_ptr<MissionPlan> missionThrough(
    const std::vector<Eigen::Vector3d>& points, double final_hold = 0.0);

/// Distance of `p` to the polyline [m]; at least one point.
[[nodiscard]] double crossTrack(const Eigen::Vector3d& p,
                                const std::vector<Eigen::Vector3d>& polyline);

}  // namespace tautline::experiments
