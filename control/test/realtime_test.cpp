// Nothing of a cycle touches the heap.

#include <memory>

#include <gtest/gtest.h>

#include "common/testing/malloc_guard.h"
#include "control/command_gate.h"
#include "control/control_config.h"
#include "control/motion_executor.h"
#include "control/reel_dead_zone.h"
#include "control/test/flight.h"

namespace tautline::testing {
namespace {

TEST(RealTime, WholeMissionsDoNotAllocate) {
  if (!MallocGuard::available()) GTEST_SKIP() << "sanitizer build: the sanitizer owns malloc";
  const Path path = densify(path2(), 0.2);
  const auto plan = std::make_unique<MissionPlan>();
  for (const Eigen::Vector3d& p : path) {
    plan->waypoints[static_cast<std::size_t>(plan->waypoint_count++)].p_WD = p;
  }
  const Duration dt = fromSeconds(kPlantStep);
  for (const auto& law_name : kLawNames) {
    for (const TetherModel model : {TetherModel::kStraight, TetherModel::kCatenary}) {
      ControlConfig config;
      config.law = law_name.value;
      config.composite.feed_forward.model = model;
      config.position.target.model = model;
      const auto law = makeController(config);
      ExecutorConfig executor_config;
      executor_config.target.model = model;
      PlantConfig plant_config;
      ContactStack contacts;
      MotionExecutor executor(executor_config, config.composite.pole, plant_config.limits,
                              contacts);
      CommandGate gate({}, plant_config.limits);
      ReelDeadZone reel({});
      KinematicPlant plant(plant_config, path.front(), 1);
      const auto flown = std::make_unique<FlownPath>();
      flown->begin(path.front());

      const MallocGuard guard;
      ASSERT_TRUE(executor.start(*plan, plant.measure()));
      for (int i = 0; i < 1000; ++i) {
        const ExecutorOutput target = executor.update(dt, {.estimate = plant.measure(),
                                                           .R_WB = Eigen::Quaterniond::Identity(),
                                                           .gimbal_pitch = 0.0});
        const RateCommand u = law->update(dt, target.control);
        VehicleCommand command;
        command.engaged = u.ok;
        command.length_rate = reel.compensate(dt, u.length_rate);
        const GatedCommand gated = gate.apply(dt, command);
        ASSERT_FALSE(gated.not_finite);
        plant.step(u);
        flown->record(plant.position(), contacts, true);
        if (i == 200) (void)executor.pause();
        if (i == 210) (void)executor.resume();
        if (i == 220) (void)executor.skip();
        if (i == 900) (void)executor.goBack(*flown, 10.0, 0.3, plant.measure());
      }
      EXPECT_EQ(guard.allocations(), 0) << law->name();
    }
  }
}

}  // namespace
}  // namespace tautline::testing
