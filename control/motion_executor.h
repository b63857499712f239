#pragma once

/// @file
/// Flies a route leg by leg: which segment, which anchor, when a waypoint counts as reached, when
/// to give up. Dissertation section 5.3.3, with time-outs, holds and a pole that it could not have.
/// State diagram: docs/control.md.

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/estimate.h"
#include "common/fields.h"
#include "common/mission_plan.h"
#include "common/time.h"
#include "control/contact_stack.h"
#include "control/controller.h"
#include "control/flown_path.h"
#include "control/look_at.h"
#include "control/pole.h"
#include "control/route.h"
#include "control/tether_target.h"

namespace tautline {

/// Values as in lcmtypes/mission_status_t.lcm.
enum class MissionState : std::uint8_t {
  kIdle,       ///< No route.
  kRunning,    ///< On a leg.
  kHolding,    ///< At a waypoint, for its hold time.
  kPaused,     ///< Holding where it was told to pause.
  kCompleted,  ///< Holding the last point.
  kFailed,     ///< Holding where it gave up.
};
inline constexpr std::array<EnumName<MissionState>, 6> kMissionStateNames{
    {{MissionState::kIdle, "idle"},
     {MissionState::kRunning, "running"},
     {MissionState::kHolding, "holding"},
     {MissionState::kPaused, "paused"},
     {MissionState::kCompleted, "completed"},
     {MissionState::kFailed, "failed"}}};

/// Values as in lcmtypes/mission_status_t.lcm.
enum class MissionFailure : std::uint8_t {
  kNone,
  kWaypointTimeout,
  kNoProgress,
  kBadContact,   ///< A waypoint names a contact that the plan has not, or the stack is full.
  kUnreachable,  ///< Farther than the tether is long, or no static tether shape at this tension for
                 ///< a while.
};
inline constexpr std::array<EnumName<MissionFailure>, 5> kMissionFailureNames{
    {{MissionFailure::kNone, "none"},
     {MissionFailure::kWaypointTimeout, "waypoint_timeout"},
     {MissionFailure::kNoProgress, "no_progress"},
     {MissionFailure::kBadContact, "bad_contact"},
     {MissionFailure::kUnreachable, "unreachable"}}};

struct ExecutorConfig {
  double speed_mps{0.3};
  double acceptance_floor_m{0.15};
  double acceptance_ceiling_m{0.4};
  double acceptance_sigmas{2.0};
  bool pass_by_progress{true};
  double corridor_m{0.6};
  double timeout_factor{3.0};
  double timeout_constant_s{30.0};
  double progress_m{0.05};
  double progress_time_s{15.0};
  double unreachable_time_s{2.0};
  TetherModelConfig target;
  LookAtConfig look_at;

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("speed_mps", speed_mps, Range{0.01, 2.0}, "speed where the waypoint names none");
    v.field("acceptance_floor_m", acceptance_floor_m, Range{0.01, 5.0},
            "least acceptance radius (as published: 0.4)");
    v.field("acceptance_ceiling_m", acceptance_ceiling_m, Range{0.01, 5.0},
            "largest acceptance radius (as published: 0.4)");
    v.field("acceptance_sigmas", acceptance_sigmas, Range{0.0, 10.0},
            "acceptance radius over the position's standard deviation");
    v.field("pass_by_progress", pass_by_progress,
            "waypoints on the way also count when passed; published: no");
    v.field("corridor_m", corridor_m, Range{0.05, 5.0},
            "how far beside a waypoint it may be passed");
    v.field("timeout_factor", timeout_factor, Range{1.0, 100.0},
            "time for a leg over its length / speed");
    v.field("timeout_constant_s", timeout_constant_s, Range{1.0, 3600.0}, "and this on top");
    v.field("progress_m", progress_m, Range{0.001, 5.0}, "this much nearer is progress");
    v.field("progress_time_s", progress_time_s, Range{1.0, 3600.0},
            "without progress for this long the leg fails");
    v.field("unreachable_time_s", unreachable_time_s, Range{0.0, 60.0},
            "without a static tether shape for this long the leg fails");
    v.section("target", target);
    v.section("look_at", look_at);
  }
};

/// What the executor sees in one cycle.
struct ExecutorInput {
  Estimate estimate;
  std::optional<Eigen::Quaterniond> R_WB{};  ///< Only if fresh: turns by look-at need it.
  std::optional<double> gimbal_pitch{};      ///< Above the horizon [rad]; only if fresh.
};

struct ExecutorOutput {
  bool active{false};             ///< False: idle, nothing below is to be used.
  ControlInput control;           ///< For the control law.
  double yaw_rate{0.0};           ///< About +y [rad/s].
  double gimbal_pitch_rate{0.0};  ///< Up positive [rad/s].
};

/// For telemetry: MISSION_STATUS.
struct ExecutorStatus {
  MissionState state{MissionState::kIdle};
  MissionFailure failure{MissionFailure::kNone};
  std::uint64_t mission_hash{0};  ///< 0: no mission, or a single point.
  int waypoint{0};                ///< Index of the present target in plan or flown path.
  int waypoint_count{0};
  Eigen::Vector3d p_WTarget{Eigen::Vector3d::Zero()};        ///< Present waypoint [m].
  Eigen::Vector3d p_WSegmentStart{Eigen::Vector3d::Zero()};  ///< [m]
  double distance{0.0};                                      ///< To the present waypoint [m].
  double cross_track{0.0};                                   ///< From the present segment [m].
  double acceptance_radius{0.0};                             ///< In force now [m].
  double target_length{0.0};     ///< L_total with the drone at the waypoint [m].
  double target_elevation{0.0};  ///< theta there, by the configured model [rad].
  double target_azimuth{0.0};    ///< phi there [rad].
  Duration time_on_waypoint{0};  ///< Since it became the target, without pauses.
};

/// Real-time safe throughout: no allocation, no locks, no exceptions; no clock, same calls give
/// same results.
class MotionExecutor {
 public:
  /// `contacts` outlives the executor; it changes only when a leg begins that names another
  /// contact.
  MotionExecutor(const ExecutorConfig& config, const PoleConfig& pole, const VehicleLimits& limits,
                 ContactStack& contacts) noexcept;

  /// Begins a mission where the drone is. False, and nothing changed, if the plan is empty or there
  /// is no usable estimate. The plan must not change until another route is started or abort() is
  /// called.
  bool start(const MissionPlan& plan, const Estimate& estimate) noexcept;

  /// Goes to a single point. False, and nothing changed, if there is no usable estimate or the
  /// point is not finite.
  bool goTo(const PointTarget& target, const Estimate& estimate) noexcept;

  /// Goes back along the flown path, `distance` [m] or all the way, at `speed` [m/s]. While a leg
  /// is flown the path may be cut after the leg's end (status().waypoint), not before it. False,
  /// and nothing changed, if there is no path or no usable estimate.
  bool goBack(const FlownPath& path, double distance, double speed,
              const Estimate& estimate) noexcept;

  /// Holds where the drone was last seen until resume(). False unless running or holding.
  bool pause() noexcept;

  /// Goes on with the leg, from where the drone is now, with fresh time-outs. False unless paused.
  bool resume() noexcept;

  /// Gives up the present waypoint for the next; the last one: completes. False if idle, completed
  /// or failed, or if the next leg has another contact: a contact is made by the way flown, not by
  /// leaving it out.
  bool skip() noexcept;

  /// Forgets the route; the contact stack stays.
  void abort() noexcept;

  [[nodiscard]] ExecutorOutput update(Duration dt, const ExecutorInput& in) noexcept;

  [[nodiscard]] const ExecutorStatus& status() const noexcept { return status_; }

  /// Where it holds, and what it looks at there: a route that is completed holds at its last point,
  /// not where it came near enough to it. Means nothing while running or idle.
  [[nodiscard]] PointTarget holdPoint() const noexcept {
    return {.p_WD = p_WHold_, .speed = speed(), .p_WL = leg_.p_WL};
  }

 private:
  bool begin(const Route& route, const Estimate& estimate) noexcept;
  void beginLeg(int index, Eigen::Vector3d p_WS) noexcept;
  void flyLegFrom(const Eigen::Vector3d& p_WS) noexcept;
  void advance() noexcept;
  void holdAt(MissionState state, const Eigen::Vector3d& p_WD) noexcept;
  void fail(MissionFailure failure) noexcept;
  void fly(Duration dt, double T) noexcept;
  [[nodiscard]] bool arrived() const noexcept;
  [[nodiscard]] MissionFailure failureAfter(Duration dt, double T) noexcept;
  void describe(const Estimate& estimate) noexcept;
  [[nodiscard]] std::optional<Leg> nextLeg() const noexcept;
  [[nodiscard]] bool endsNearPole() const noexcept;
  [[nodiscard]] double speed() const noexcept;

  ExecutorConfig config_;
  VehicleLimits limits_;
  PoleCylinder pole_;
  ContactStack& contacts_;

  Route route_;
  int index_{0};
  Leg leg_;
  Eigen::Vector3d p_WD_{Eigen::Vector3d::Zero()};     ///< Drone, where last seen.
  Eigen::Vector3d p_WHold_{Eigen::Vector3d::Zero()};  ///< Point to stay at while not running.
  Duration held_{0};                                  ///< Hold time so far.
  double best_{0.0};                                  ///< Least way that was left on this leg [m].
  Duration since_best_{0};
  Duration unreachable_for_{0};
  bool was_holding_{false};  ///< Paused out of a hold.

  ExecutorStatus status_;
};

}  // namespace tautline
