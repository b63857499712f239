#include <algorithm>
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>

#include "common/catenary.h"
#include "estimation/localizer.h"

/// Cost of the sag model and of one localizer cycle, each beside what a textbook would do in its
/// place. Run: build/release/benchmark/estimation_benchmark

namespace tautline {
namespace {

constexpr double kTetherWeight = 0.0061 * 9.81;

std::vector<CatenaryInput> segments() {
  std::vector<CatenaryInput> out;
  for (double L = 0.5; L < 6.0; L += 0.7) {
    for (double theta = -0.3; theta < 1.5; theta += 0.23) {
      for (const double T : {0.4, 0.8, 2.0}) out.push_back({L, theta, T, kTetherWeight});
    }
  }
  return out;
}

struct Point {
  double r, h;
};

std::vector<Point> points() {
  std::vector<Point> out;
  for (double r = 0.2; r < 4.0; r += 0.37) {
    for (double h = -1.0; h < 3.0; h += 0.41) out.push_back({r, h});
  }
  return out;
}

// The textbook solution: difference of two asinh and two cosh, by the parameter a = H/w.
Point textbookCatenary(const CatenaryInput& in) {
  const double H = in.T_D * std::cos(in.theta_D);
  const double V_D = in.T_D * std::sin(in.theta_D);
  const double V_A = V_D - in.w * in.L;
  const double a = H / in.w;
  const double u_D = std::asinh(V_D / H);
  const double u_A = std::asinh(V_A / H);
  return {a * (u_D - u_A), a * (std::cosh(u_D) - std::cosh(u_A))};
}

// The length to pay out by bisection: for each length the tangent that reaches the height, until
// the reach fits.
double bisectedLength(double r, double h, double T, double w) {
  const double chord = std::hypot(r, h);
  double shortest = chord;
  double longest = 1.2 * chord;
  for (int i = 0; i < 40; ++i) {
    const double L = 0.5 * (shortest + longest);
    double low = -1.57;
    double high = 1.57;
    for (int k = 0; k < 40; ++k) {
      const double theta = 0.5 * (low + high);
      (textbookCatenary({L, theta, T, w}).h < h ? low : high) = theta;
    }
    (textbookCatenary({L, low, T, w}).r < r ? shortest : longest) = L;
  }
  return shortest;
}

void catenaryClosedForm(benchmark::State& state) {
  const auto inputs = segments();
  for (auto _ : state) {
    for (const CatenaryInput& in : inputs) benchmark::DoNotOptimize(solveCatenary(in));
  }
  state.SetItemsProcessed(state.iterations() * static_cast<long>(inputs.size()));
}
BENCHMARK(catenaryClosedForm);

void catenaryClosedFormWithJacobian(benchmark::State& state) {
  const auto inputs = segments();
  CatenaryJacobian J;
  for (auto _ : state) {
    for (const CatenaryInput& in : inputs) {
      benchmark::DoNotOptimize(solveCatenary(in, &J));
      benchmark::DoNotOptimize(J.data());
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<long>(inputs.size()));
}
BENCHMARK(catenaryClosedFormWithJacobian);

void catenaryTextbook(benchmark::State& state) {
  const auto inputs = segments();
  for (auto _ : state) {
    for (const CatenaryInput& in : inputs) benchmark::DoNotOptimize(textbookCatenary(in));
  }
  state.SetItemsProcessed(state.iterations() * static_cast<long>(inputs.size()));
}
BENCHMARK(catenaryTextbook);

void inverseNewton(benchmark::State& state) {
  const auto targets = points();
  for (auto _ : state) {
    for (const Point& p : targets) {
      benchmark::DoNotOptimize(solveInverseCatenary(p.r, p.h, 0.8, kTetherWeight));
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<long>(targets.size()));
}
BENCHMARK(inverseNewton);

void inverseBisection(benchmark::State& state) {
  const auto targets = points();
  for (auto _ : state) {
    for (const Point& p : targets) {
      benchmark::DoNotOptimize(bisectedLength(p.r, p.h, 0.8, kTetherWeight));
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<long>(targets.size()));
}
BENCHMARK(inverseBisection);

// A drone that circles at constant length; every cycle has new samples from all sensors if `fresh`.
void localizerCycle(benchmark::State& state, LocalizerVariant variant, bool fresh) {
  LocalizerConfig config;
  config.variant = variant;
  Localizer localizer(config);
  Time now{};
  localizer.reset({0.0, 1.2, 1.6}, now);
  SensorFrame frame;
  frame.vehicle.valid = true;
  frame.vehicle.sequence = 1;
  frame.vehicle.value.phase = VehiclePhase::kFlying;
  VehicleCommand command;
  command.engaged = true;
  command.azimuth_rate = 0.1;
  double phi = 0.0;
  bool first = true;
  for (auto _ : state) {
    now += fromSeconds(0.01);
    phi = std::remainder(phi + 0.001, 6.283185307179586);
    if (fresh || first) {
      frame.reel = {
          now, frame.reel.sequence + 1, true, {.counts = 0.0, .length = 2.0, .tension = 0.4}};
      frame.angles = {
          now, frame.angles.sequence + 1, true, {.theta = 0.7, .phi = phi, .altitude = {}}};
      frame.attitude = {now, frame.attitude.sequence + 1, true, {}};
      first = false;
    }
    benchmark::DoNotOptimize(localizer.update(now, frame, command, Anchor{}));
  }
}
BENCHMARK_CAPTURE(localizerCycle, filter_all_samples_new, LocalizerVariant::kFilter, true);
BENCHMARK_CAPTURE(localizerCycle, filter_between_samples, LocalizerVariant::kFilter, false);
BENCHMARK_CAPTURE(localizerCycle, memoryless_exact, LocalizerVariant::kExact, true);
BENCHMARK_CAPTURE(localizerCycle, memoryless_straight, LocalizerVariant::kStraight, true);

}  // namespace
}  // namespace tautline
