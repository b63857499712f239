#include "app/station/guidance.h"

#include <memory>

#include <gtest/gtest.h>

#include "app/station/station_config.h"
#include "control/control_config.h"
#include "control/test/kinematic_plant.h"

namespace tautline {
namespace {

using testing::KinematicPlant;
using testing::kPlantStep;
using testing::PlantConfig;

/// Guidance with its law and a kinematic plant, which hangs from whatever anchor is active.
class GuidanceTest : public ::testing::Test {
 protected:
  void enter(Mode mode) {
    mode_ = mode;
    entered_ = true;
    step();
  }
  void step(Duration d = fromSeconds(kPlantStep)) {
    const Duration dt = fromSeconds(kPlantStep);
    for (const Time end = now_ + d; now_ < end;) {
      now_ += dt;
      sensors_.vehicle.sequence += 1;
      output_ = guidance_->update({.now = now_,
                                   .dt = dt,
                                   .mode = mode_,
                                   .entered = entered_,
                                   .estimate = estimate(),
                                   .vehicle = phase_,
                                   .sensors = &sensors_,
                                   .plan = plan_.get(),
                                   .conditions = conditions_,
                                   .teleop = sticks_});
      entered_ = false;
      RateCommand rates;
      if (output_.route.active) {
        rates = law_->update(dt, output_.route.control);
      } else {
        rates = {.ok = true,
                 .length_rate = output_.command.length_rate,
                 .elevation_rate = output_.command.elevation_rate,
                 .azimuth_rate = output_.command.azimuth_rate};
      }
      if (height() > floor_) plant_.step(rates);
    }
  }
  [[nodiscard]] Estimate estimate() {
    Estimate e = plant_.measure();
    e.p_WD.y() += too_high_;
    return e;
  }
  void takeOff() {
    enter(Mode::kArmed);
    phase_ = VehiclePhase::kFlying;
    enter(Mode::kTakeoff);
    step(std::chrono::seconds(10));
    EXPECT_TRUE(guidance_->conditions().has(Condition::kAtTarget));
    enter(Mode::kHold);
  }
  [[nodiscard]] std::unique_ptr<Guidance> makeGuidance() const {
    return std::make_unique<Guidance>(config_.guidance, config_.executor,
                                      config_.control.composite.pole, plant_config_.limits);
  }
  [[nodiscard]] double height() const {
    return (plant_.position() - config_.guidance.home_position_m).y();
  }
  [[nodiscard]] Eigen::Vector3d aboveHome() const {
    return config_.guidance.home_position_m +
           Eigen::Vector3d(0, config_.guidance.takeoff_height_m, 0);
  }

  CoreConfig config_;
  PlantConfig plant_config_{.noise = 0.1};
  KinematicPlant plant_{plant_config_, config_.guidance.home_position_m + Eigen::Vector3d(0, .3, 0),
                        1};
  std::unique_ptr<Guidance> guidance_ = makeGuidance();
  std::unique_ptr<Controller> law_ = makeController(config_.control);
  SensorFrame sensors_;
  GuidanceOutput output_;
  Mode mode_{Mode::kStandby};
  bool entered_{false};
  VehiclePhase phase_{VehiclePhase::kIdle};
  ConditionSet conditions_;
  std::optional<TeleopRates> sticks_;
  std::unique_ptr<MissionPlan> plan_;
  double too_high_{0.0};  ///< The estimate [m].
  double floor_{-10.0};   ///< Height above home where the plant stays for good [m].
  Time now_{};
};

TEST_F(GuidanceTest, TeleopIsTheSticksAndWithoutThemAHover) {
  takeOff();
  enter(Mode::kTeleop);
  sticks_ = {.length = 0.2, .elevation = 0.05, .azimuth = -0.1, .yaw = 0.3, .gimbal_pitch = -0.2};
  step();
  EXPECT_FALSE(output_.route.active);
  EXPECT_TRUE(output_.command.engaged && output_.command.reel_controller);
  EXPECT_EQ(output_.command.length_rate, 0.2);
  EXPECT_EQ(output_.command.elevation_rate, 0.05);
  EXPECT_EQ(output_.command.azimuth_rate, -0.1);
  EXPECT_EQ(output_.command.yaw_rate, 0.3);
  EXPECT_EQ(output_.command.gimbal_pitch_rate, -0.2);
  step(std::chrono::seconds(5));
  const Eigen::Vector3d there = plant_.position();
  EXPECT_GT((there - aboveHome()).norm(), 0.8);
  sticks_.reset();
  step(std::chrono::seconds(10));
  EXPECT_TRUE(output_.route.active);
  EXPECT_LT((plant_.position() - there).norm(), 0.2);
  sticks_ = TeleopRates{.length = -0.1};
  step(std::chrono::seconds(4));
  const Eigen::Vector3d nearer = plant_.position();
  sticks_.reset();
  step(std::chrono::seconds(10));
  EXPECT_LT((plant_.position() - nearer).norm(), 0.2) << "where the last sticks ended, not before";
}

TEST_F(GuidanceTest, AMissionEndsAtItsLastViewpointAndGoesOnLooking) {
  config_.executor.acceptance_floor_m = 0.4;
  guidance_ = makeGuidance();
  plan_ = std::make_unique<MissionPlan>();
  plan_->waypoint_count = 1;
  plan_->waypoints[0].p_WD = aboveHome() + Eigen::Vector3d(0.5, 0.4, 0.8);
  plan_->waypoints[0].p_WL = Eigen::Vector3d(3.0, 0.0, 3.0);
  takeOff();
  enter(Mode::kAuto);
  for (int i = 0; i < 60 && !guidance_->conditions().has(Condition::kMissionDone); ++i)
    step(std::chrono::milliseconds(500));
  ASSERT_TRUE(guidance_->conditions().has(Condition::kMissionDone));
  EXPECT_GT((plant_.position() - plan_->waypoints[0].p_WD).norm(), 0.2) << "near enough";
  enter(Mode::kHold);
  sensors_.attitude.valid = true;
  step(std::chrono::seconds(10));
  EXPECT_LT((plant_.position() - plan_->waypoints[0].p_WD).norm(), 0.15);
  EXPECT_NE(output_.route.yaw_rate, 0.0);
  enter(Mode::kTeleop);
  sticks_ = TeleopRates{.length = -0.1};
  step(std::chrono::seconds(8));
  sticks_.reset();
  const Eigen::Vector3d there = plant_.position();
  enter(Mode::kHold);
  step(std::chrono::seconds(10));
  EXPECT_LT((plant_.position() - there).norm(), 0.2) << "a later hover is where the drone is";
}

TEST_F(GuidanceTest, ReturnsTheWayTheSticksFlew) {
  takeOff();
  enter(Mode::kTeleop);
  for (const TeleopRates& rates :
       {TeleopRates{.length = 0.3}, TeleopRates{.azimuth = 0.2}, TeleopRates{.length = -0.1}}) {
    sticks_ = rates;
    step(std::chrono::seconds(6));
  }
  sticks_.reset();
  enter(Mode::kReturn);
  for (int i = 0; i < 60 && !guidance_->conditions().has(Condition::kAtTarget); ++i)
    step(std::chrono::seconds(1));
  EXPECT_TRUE(guidance_->conditions().has(Condition::kAtTarget));
  EXPECT_LT((plant_.position() - aboveHome()).norm(), 0.3);
}

TEST_F(GuidanceTest, BacksUpByItsDistance) {
  takeOff();
  enter(Mode::kTeleop);
  sticks_ = TeleopRates{.length = 0.3};
  step(std::chrono::seconds(10));
  sticks_.reset();
  step(std::chrono::seconds(3));
  const Eigen::Vector3d before = plant_.position();
  enter(Mode::kBackUp);
  step(std::chrono::seconds(15));
  EXPECT_TRUE(guidance_->conditions().has(Condition::kAtTarget));
  EXPECT_NEAR((plant_.position() - before).norm(), config_.guidance.back_up_m, 0.25);
}

TEST_F(GuidanceTest, WithoutATakeoffNoWayBackIsKnown) {
  phase_ = VehiclePhase::kFlying;  // a station that was restarted in flight
  enter(Mode::kHold);
  step(std::chrono::seconds(3));
  EXPECT_FALSE(guidance_->knowsWayBack());
  EXPECT_FALSE(guidance_->conditions().has(Condition::kMissionFailed));
  const Eigen::Vector3d before = plant_.position();
  enter(Mode::kReturn);
  step(std::chrono::seconds(5));
  EXPECT_TRUE(guidance_->conditions().has(Condition::kMissionFailed));
  EXPECT_FALSE(guidance_->conditions().has(Condition::kAtTarget));
  EXPECT_LT((plant_.position() - before).norm(), 0.1);
}

TEST_F(GuidanceTest, FailsafeHoversAndReelsASlackTetherIn) {
  takeOff();
  enter(Mode::kFailsafe);
  step(std::chrono::seconds(5));
  EXPECT_TRUE(output_.route.active);
  EXPECT_LT((plant_.position() - aboveHome()).norm(), 0.35);
  conditions_.set(Condition::kTetherSlack);
  step();
  EXPECT_FALSE(output_.route.active);
  EXPECT_EQ(output_.command.length_rate, -config_.guidance.slack_reel_in_mps);
  EXPECT_EQ(output_.command.elevation_rate, 0.0);
  conditions_ = {};
  step();
  EXPECT_TRUE(output_.route.active);
}

TEST_F(GuidanceTest, LeavesTheMotorsToAVehicleThatLandsByItself) {
  for (const bool by_itself : {true, false}) {
    takeOff();
    phase_ = by_itself ? VehiclePhase::kLanding : VehiclePhase::kFlying;
    enter(Mode::kDescend);
    EXPECT_EQ(output_.command.action, VehicleAction::kLand);
    EXPECT_LT(output_.command.elevation_rate, 0.0);
    bool stopped = false;
    for (int i = 0; i < 1000; ++i) {
      step();
      stopped = stopped || output_.command.action == VehicleAction::kMotorStop;
    }
    EXPECT_EQ(stopped, !by_itself);
    plant_ = KinematicPlant(plant_config_,
                            config_.guidance.home_position_m + Eigen::Vector3d(0, .3, 0), 1);
    phase_ = VehiclePhase::kIdle;
    enter(Mode::kStandby);
  }
}

TEST_F(GuidanceTest, StopsTheMotorsOfAVehicleThatHangsAndNeverEndsItsLanding) {
  for (int flight = 0; flight < 2; ++flight) {
    takeOff();
    phase_ = VehiclePhase::kLanding;
    enter(Mode::kDescend);
    const auto stopped = [&] { return output_.command.action == VehicleAction::kMotorStop; };
    double waited = 0.0;
    for (; waited < 200.0 && !stopped(); waited += kPlantStep) step();
    EXPECT_GT(waited, 60.0) << "flight " << flight;
    EXPECT_LT(waited, 100.0) << "flight " << flight;
    plant_ = KinematicPlant(plant_config_,
                            config_.guidance.home_position_m + Eigen::Vector3d(0, .3, 0), 1);
    phase_ = VehiclePhase::kIdle;
    enter(Mode::kStandby);
  }
}

TEST_F(GuidanceTest, TheFloorEndsALandingAndNotAHeight) {
  for (const double too_high : {-0.4, 0.0, 0.2}) {
    SCOPED_TRACE(too_high);
    too_high_ = 0.0;
    floor_ = -10.0;
    takeOff();
    too_high_ = too_high;
    floor_ = 0.0;
    enter(Mode::kLand);
    double on_floor = 0.0;
    for (double waited = 0.0; waited < 60.0; waited += kPlantStep) {
      step();
      if (output_.command.action == VehicleAction::kMotorStop) break;
      if (height() <= floor_) on_floor += kPlantStep;
    }
    EXPECT_EQ(output_.command.action, VehicleAction::kMotorStop);
    EXPECT_LE(height(), floor_) << "not in the air";
    EXPECT_LT(on_floor, too_high > 0.1 ? 9.0 : 2.0);
    plant_ = KinematicPlant(plant_config_,
                            config_.guidance.home_position_m + Eigen::Vector3d(0, .3, 0), 1);
    phase_ = VehiclePhase::kIdle;
    enter(Mode::kStandby);
  }
}

TEST_F(GuidanceTest, DescendsFromWhereATakeoffHasCome) {
  enter(Mode::kArmed);
  phase_ = VehiclePhase::kFlying;
  enter(Mode::kTakeoff);
  step(std::chrono::seconds(10));
  enter(Mode::kDescend);
  while (output_.command.action != VehicleAction::kMotorStop) step();
  EXPECT_LT(height(), 0.0);
}

}  // namespace
}  // namespace tautline
