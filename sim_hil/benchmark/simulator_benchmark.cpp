#include <array>
#include <string>

#include <benchmark/benchmark.h>

#include "sim_hil/simulator.h"
#include "sim_hil/test/flight_rig.h"

// Simulated seconds per second of one core: the counter "x_real_time".

namespace tautline::sim {
namespace {

void send(Simulator& sim, const std::string& text) {
  sim.receive({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

/// Takes off, pays out to about 3 m and flies there and back for as long as it is measured, with
/// default gusts, noise and telemetry at `rate_hz`.
void fly(benchmark::State& state, const Scene& scene, const std::string& rate_hz) {
  SimConfig config;
  config.vehicle.battery_life = 1e6;
  Simulator sim(config, scene, 1);
  std::array<std::uint8_t, 4096> out;
  send(sim, "RemoteControl start\nPset 117," + rate_hz +
                "\nPcommit\nGet_GroundStatus 0\nGet_Att 0\nGet_Pos 0\nGet_FlightStatus 0\n"
                "Get_Gimbal 0\nStartTakeoff\n");
  int tick = 0;
  const auto advance = [&](const std::string& command) {
    send(sim, command);
    sim.advanceTo(sim.now() + std::chrono::milliseconds(100));
    benchmark::DoNotOptimize(sim.transmit(out));
  };
  for (; tick < 90; ++tick) advance("Pos 0,0,0\n");
  for (; tick < 190; ++tick) advance("Pos2 -0.01,0,75\n");
  for (auto _ : state) {
    advance(++tick % 120 < 60 ? "Pos2 0,0.1,20\n" : "Pos2 0,-0.1,-20\n");
  }
  if (sim.truth().crashed || !sim.truth().motors_on) state.SkipWithError("does not fly any more");
  state.counters["x_real_time"] = benchmark::Counter(0.1 * static_cast<double>(state.iterations()),
                                                     benchmark::Counter::kIsRate);
}

void standardFlight(benchmark::State& state) { fly(state, emptyRoom(), "10"); }
BENCHMARK(standardFlight)->Unit(benchmark::kMicrosecond);

void flightAtFullTelemetry(benchmark::State& state) { fly(state, emptyRoom(), "100"); }
BENCHMARK(flightAtFullTelemetry)->Unit(benchmark::kMicrosecond);

/// The pillar bends the tether during half of the time; 20 more obstacles stand around.
void flightRoundAPillar(benchmark::State& state) {
  Scene scene = emptyRoom();
  scene.boxes.push_back({"pillar", {0.5, -0.3, 0.6}, {0.8, 3.0, 0.9}});
  for (int i = 0; i < 20; ++i) {
    const double x = -15.0 + 1.5 * i;
    scene.boxes.push_back({"box", {x, -0.3, -8.0}, {x + 0.5, 1.0, -7.0}});
  }
  fly(state, scene, "10");
}
BENCHMARK(flightRoundAPillar)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace tautline::sim
