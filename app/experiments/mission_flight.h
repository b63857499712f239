#pragma once

/// @file
/// One flight of a planned mission, and how it ended by the plant's truth, whatever the station
/// believes. Not real-time safe.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "app/bench/lockstep.h"
#include "common/fields.h"
#include "common/mission_plan.h"

namespace tautline::experiments {

/// The kinds of the dissertation's trials (chapter 7), and ours.
enum class FlightEnd : std::uint8_t {
  kFinished,     ///< The mission was flown, and the drone truly is where it ends.
  kObstacle,     ///< Touched an obstacle: its "railings".
  kRoom,         ///< Touched a wall, the ceiling or the floor: its "wall".
  kOscillation,  ///< Never reached a waypoint.
  kContactLost,  ///< The tether rested on an obstacle, and the station did not know where it was.
  kAborted,      ///< The supervisor ended the mission for another reason.
  kMissed,       ///< Flown as the station believes, but truly ended elsewhere, without a contact.
  kNotStarted,   ///< Not armed, no take-off, or the mission was refused.
};
inline constexpr std::array<EnumName<FlightEnd>, 8> kFlightEndNames{
    {{FlightEnd::kFinished, "finished"},
     {FlightEnd::kObstacle, "obstacle"},
     {FlightEnd::kRoom, "wall"},
     {FlightEnd::kOscillation, "oscillation"},
     {FlightEnd::kContactLost, "contact+lost"},
     {FlightEnd::kAborted, "aborted"},
     {FlightEnd::kMissed, "missed"},
     {FlightEnd::kNotStarted, "not started"}}};

struct FlightVerdict {
  FlightEnd end{FlightEnd::kNotStarted};
  int waypoint{0};                                ///< Index of the target when it ended.
  Eigen::Vector3d p_WD{Eigen::Vector3d::Zero()};  ///< True, then [m].
  double error{0.0};                              ///< Of the station's position, then [m].
  double seconds{0.0};                            ///< Virtual, of the whole flight.
  std::string why{};  ///< The condition that ended it, by name; may be empty.

  [[nodiscard]] bool failed() const noexcept { return end != FlightEnd::kFinished; }
};

[[nodiscard]] nlohmann::json toJson(const FlightVerdict& verdict);
/// Throws nlohmann::json::exception.
[[nodiscard]] FlightVerdict verdictFrom(const nlohmann::json& json);

/// What a flight was when it ended: all that its verdict depends on.
struct FlightFacts {
  bool began{false};      ///< The mission was accepted.
  bool completed{false};  ///< The station says that the mission is flown.
  sim::CrashReason crash{sim::CrashReason::kNone};
  bool grounded{false};       ///< Stood on something while the mission flew.
  bool contact{false};        ///< The tether touched an obstacle at some time of the mission.
  bool stood_still{false};    ///< No new waypoint for too long.
  double goal_distance{0.0};  ///< True, from the last waypoint [m].
  double error{0.0};          ///< Of the station's position [m].
  ConditionSet conditions{};  ///< That counted when the mission was left.
};

/// How near to the mission's last waypoint a finished flight truly ends, and how wrong a position
/// is that counts as lost [m]: a voxel of the dissertation's map, corner to corner. It takes its
/// 0.4 m as the vehicle's accuracy.
inline constexpr double kGoalTolerance = 0.7;

[[nodiscard]] FlightEnd judge(const FlightFacts& facts, double goal_tolerance) noexcept;

/// Where the drone was, 10 times a second, for pictures.
using FlightTrack = std::vector<Eigen::Vector3d>;

/// Arms, takes off and flies the mission; it ends with the last waypoint, without a landing. A
/// flight that reaches no new waypoint for 60 s is over. `track` may be null.
[[nodiscard]] FlightVerdict flyPlanned(const bench::LockstepConfig& config,
                                       const MissionPlan& mission, double goal_tolerance,
                                       FlightTrack* track = nullptr);

}  // namespace tautline::experiments
