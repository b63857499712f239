#pragma once

/// @file
/// What to fly in each mode: take-off, hover, mission, ways back, landing. All of it goes through
/// the one motion executor; guidance chooses its route and tells the supervisor how far it is. Only
/// what must not or cannot know where the drone is goes past it, as plain rates: the operator's
/// sticks, a slack tether's reel-in, the descent without localization.

#include <optional>

#include <Eigen/Core>

#include "common/estimate.h"
#include "common/mission_plan.h"
#include "common/vehicle.h"
#include "control/contact_stack.h"
#include "control/descent.h"
#include "control/flown_path.h"
#include "control/motion_executor.h"
#include "supervision/supervisor.h"

namespace tautline {

struct GuidanceConfig;

/// Nobody hears the rates.
inline constexpr ConditionSet kUnheard{Condition::kLinkLost, Condition::kVehicleStale};
/// While one of these counts the drone stands still in every mode but DESCEND.
inline constexpr ConditionSet kStandStill =
    kUnheard | ConditionSet{Condition::kReelStale,       Condition::kReelStuck,
                            Condition::kReelJump,        Condition::kAnglesStale,
                            Condition::kAnglesStuck,     Condition::kAnglesJump,
                            Condition::kLocalizationLost};

struct GuidanceInput {
  Time now{};
  Duration dt{};
  Mode mode{Mode::kStandby};
  bool entered{false};  ///< The mode began in this cycle.
  Estimate estimate;    ///< Usable or not: lost estimates are flown by standing still.
  VehiclePhase vehicle{VehiclePhase::kUnknown};  ///< What the vehicle says it is doing.
  const SensorFrame* sensors{};                  ///< For look-at.
  const MissionPlan* plan{};                     ///< For AUTO; null: none.
  ConditionSet conditions;                       ///< As of this cycle.
  std::optional<TeleopRates> teleop{};           ///< For TELEOP; only if fresh.
};

struct GuidanceOutput {
  VehicleCommand command;  ///< Complete, but for the rates of an active route.
  ExecutorOutput route;
};

/// Real-time safe: no allocation, no locks, no exceptions.
class Guidance {
 public:
  Guidance(const GuidanceConfig& config, const ExecutorConfig& executor, const PoleConfig& pole,
           const VehicleLimits& limits) noexcept;
  Guidance(const Guidance&) = delete;
  Guidance& operator=(const Guidance&) = delete;

  [[nodiscard]] GuidanceOutput update(const GuidanceInput& in) noexcept;

  /// kAtTarget, kTouchdown, kMissionDone and kMissionFailed, as of the last update.
  [[nodiscard]] ConditionSet conditions() const noexcept;

  /// Whether the contact that `plan` begins with is the one the tether now hangs on; any other
  /// beginning would put the estimate on a wrong anchor.
  [[nodiscard]] bool startsWithPresentTether(const MissionPlan& plan) const noexcept;

  /// Whether a way back is known: the flight was seen from its take-off on.
  [[nodiscard]] bool knowsWayBack() const noexcept { return path_.known(); }

  [[nodiscard]] const ContactStack& contacts() const noexcept { return contacts_; }
  /// Of the mission flown last, also after the mode has changed: a completed mission stays
  /// completed.
  [[nodiscard]] const ExecutorStatus& mission() const noexcept { return mission_; }

 private:
  enum class Landing : std::uint8_t { kRetrace, kApproach, kDescend, kStopMotors };

  void enter(const GuidanceInput& in) noexcept;
  void fly(const GuidanceInput& in) noexcept;
  [[nodiscard]] bool flyByRates(const GuidanceInput& in, VehicleCommand& command) noexcept;
  void land(const GuidanceInput& in) noexcept;
  void descend(const GuidanceInput& in, VehicleCommand& command) noexcept;
  bool goTo(const Eigen::Vector3d& p_WD, double speed, const Estimate& estimate) noexcept;
  bool goBack(double distance, const Estimate& estimate) noexcept;
  void recordFlight(const GuidanceInput& in) noexcept;
  [[nodiscard]] bool goingBack() const noexcept;
  [[nodiscard]] bool routeFailed() const noexcept;
  [[nodiscard]] Eigen::Vector3d aboveHome(double height) const noexcept;
  [[nodiscard]] bool onGround(const GuidanceInput& in) noexcept;
  void watchVehicle(const GuidanceInput& in) noexcept;
  [[nodiscard]] VehicleAction paced(VehicleAction action, Time now) noexcept;

  const GuidanceConfig& config_;
  VehicleLimits limits_;
  ContactStack contacts_;
  FlownPath path_;
  MotionExecutor executor_;
  ExecutorStatus mission_;
  Mode mode_{Mode::kStandby};
  bool under_way_{false};                 ///< The mode's route has been started.
  std::optional<PointTarget> viewpoint_;  ///< In HOLD: the last one of the mission just completed.
  bool has_flown_{false};                 ///< Since arming.
  int grounded_samples_{0};  ///< Vehicle status samples in a row that say that it stands.
  Time not_flying_since_{};  ///< The vehicle has said nothing of flying.
  bool stands_{false};       ///< On the ground, motors off, as far as can be told.
  bool gave_up_{false};      ///< On the ground in a fault of the vehicle.
  std::uint32_t vehicle_sequence_{0};
  Landing landing_{Landing::kApproach};
  double level_{0.0};   ///< Height above home about which a landing has stood still [m] ...
  Time level_since_{};  ///< ... since then.
  Descent descent_;
  Time descending_since_{};                        ///< In DESCEND.
  std::optional<Time> down_since_;                 ///< When the descent first took itself for down.
  Eigen::Vector3d p_AD_{Eigen::Vector3d::Zero()};  ///< Last that could be trusted [m].
  std::optional<Time> last_action_;
};

}  // namespace tautline
