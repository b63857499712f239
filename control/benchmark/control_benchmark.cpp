// Cost of one cycle of each control law, of the executor and of the gate.

#include <memory>

#include <benchmark/benchmark.h>

#include "control/command_gate.h"
#include "control/control_config.h"
#include "control/motion_executor.h"

namespace tautline {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(10);

Estimate someEstimate() {
  Estimate e;
  e.valid = true;
  e.health = EstimateHealth::kOk;
  e.p_WD = Eigen::Vector3d(0.2, 1.4, 0.3);
  e.P_position *= 1e-4;
  e.T = 0.5;
  return e;
}

void runLaw(benchmark::State& state, const ControlConfig& config) {
  const auto law = makeController(config);
  ControlInput in;
  in.estimate = someEstimate();
  in.p_WS = Eigen::Vector3d(1.5, 1.5, 1.5);
  in.p_WE = Eigen::Vector3d(-1.5, 1.5, -1.5);
  for (auto _ : state) {
    in.estimate.p_WD.x() = -in.estimate.p_WD.x();
    benchmark::DoNotOptimize(law->update(kStep, in));
  }
}

void BM_Law(benchmark::State& state) {
  ControlConfig config;
  config.law = kLawNames[static_cast<std::size_t>(state.range(0))].value;
  state.SetLabel(nameOf(config.law, kLawNames));
  runLaw(state, config);
}
BENCHMARK(BM_Law)->DenseRange(0, 2);

void BM_CompositeUnwrapped(benchmark::State& state) {
  ControlConfig config;
  config.composite.pole_strategy = PoleStrategy::kUnwrapped;
  runLaw(state, config);
}
BENCHMARK(BM_CompositeUnwrapped);

void BM_CompositeCatenary(benchmark::State& state) {
  ControlConfig config;
  config.composite.feed_forward.model = TetherModel::kCatenary;
  runLaw(state, config);
}
BENCHMARK(BM_CompositeCatenary);

void BM_Executor(benchmark::State& state) {
  ExecutorConfig config;
  config.target.model = state.range(0) == 0 ? TetherModel::kStraight : TetherModel::kCatenary;
  config.progress_time_s = 3600.0;
  config.timeout_constant_s = 3600.0;
  state.SetLabel(nameOf(config.target.model, kTetherModelNames));
  ContactStack contacts;
  MotionExecutor executor(config, PoleConfig{}, VehicleLimits{}, contacts);
  const auto plan = std::make_unique<MissionPlan>();
  plan->waypoint_count = kMaxWaypoints;
  for (Waypoint& w : plan->waypoints) w.p_WD = Eigen::Vector3d(2.0, 1.0, 1.0);
  const Estimate estimate = someEstimate();
  executor.start(*plan, estimate);
  for (auto _ : state) {
    benchmark::DoNotOptimize(executor.update(Duration(1), {.estimate = estimate}));
  }
}
BENCHMARK(BM_Executor)->Arg(0)->Arg(1);

void BM_CommandGate(benchmark::State& state) {
  CommandGate gate({}, {});
  VehicleCommand command;
  command.engaged = true;
  for (auto _ : state) {
    command.length_rate = 0.9 - command.length_rate;
    benchmark::DoNotOptimize(gate.apply(kStep, command));
  }
}
BENCHMARK(BM_CommandGate);

}  // namespace
}  // namespace tautline
