#include "sim_hil/simulator.h"

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tautline/sim_truth_t.hpp>

#include "common/testing/malloc_guard.h"
#include "sim_hil/test/flight_rig.h"
#include "sim_hil/test/wire_client.h"

namespace tautline::sim {
namespace {

using std::chrono::milliseconds;

void send(Simulator& sim, const std::string& text) {
  sim.receive({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

struct Recording {
  std::string bytes;
  std::vector<double> truth;
};

/// Two minutes with take-off, turns and reel work, and everything that comes out of it.
Recording record(std::uint64_t seed, Duration tick, const Scene& scene) {
  Simulator sim(SimConfig{}, scene, seed);
  send(sim, WireClient::startSequence());
  Recording r;
  std::array<std::uint8_t, 4096> out;
  const Duration command_period = milliseconds(100);
  for (Time t = Time{} + tick; t < Time{} + std::chrono::seconds(40); t += tick) {
    sim.advanceTo(t);
    const std::size_t n = sim.transmit(out);
    r.bytes.append(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(n));
    if ((t - Time{}) % command_period != Duration::zero()) continue;
    const auto k = (t - Time{}) / command_period;
    if (k == 10) send(sim, "StartTakeoff\n");
    send(sim, k < 150 ? "Pos 0,0,0\n" : k < 250 ? "Pos2 -0.02,0.1,60\n" : "Pos2 0.03,-0.1,-60\n");
    const Truth& truth = sim.truth();
    for (const double x : {truth.p_WD.x(), truth.p_WD.y(), truth.p_WD.z(), truth.tension,
                           truth.reel_tension, truth.length, truth.gust.x()}) {
      r.truth.push_back(x);
    }
  }
  return r;
}

Scene withPillar() {
  Scene scene = emptyRoom();
  scene.boxes.push_back({"pillar", {0.4, -0.3, 0.7}, {0.8, 3.0, 1.1}});
  return scene;
}

TEST(Simulator, SameSeedAndInputGiveTheSameBits) {
  const Recording a = record(5, milliseconds(10), withPillar());
  const Recording b = record(5, milliseconds(10), withPillar());
  ASSERT_FALSE(a.bytes.empty());
  EXPECT_EQ(a.bytes, b.bytes);
  ASSERT_EQ(a.truth.size(), b.truth.size());
  EXPECT_EQ(std::memcmp(a.truth.data(), b.truth.data(), a.truth.size() * sizeof(double)), 0);
}

TEST(Simulator, TheCallersTickDoesNotMatter) {
  const Recording a = record(5, milliseconds(10), emptyRoom());
  const Recording b = record(5, milliseconds(50), emptyRoom());
  EXPECT_EQ(a.truth, b.truth);
  EXPECT_EQ(a.bytes, b.bytes);
}

TEST(Simulator, AnotherSeedIsAnotherFlight) {
  EXPECT_NE(record(5, milliseconds(10), emptyRoom()).truth,
            record(6, milliseconds(10), emptyRoom()).truth);
}

TEST(Simulator, StandsAtTheLastStepNotAfterTheTimeAskedFor) {
  Simulator sim(SimConfig{}, emptyRoom(), 1);
  sim.advanceTo(Time{} + milliseconds(5));
  EXPECT_EQ(sim.now(), Time{} + milliseconds(4));
  sim.advanceTo(Time{} + milliseconds(1));
  EXPECT_EQ(sim.now(), Time{} + milliseconds(4));
  sim.advanceTo(Time{} + milliseconds(6));
  EXPECT_EQ(sim.now(), Time{} + milliseconds(6));
  EXPECT_EQ(sim.truth().time, sim.now());
}

TEST(Simulator, NoHeapInTheStep) {
  if (!testing::MallocGuard::available()) GTEST_SKIP() << "the sanitizer owns malloc";
  Simulator sim(SimConfig{}, withPillar(), 1);
  std::array<std::uint8_t, 4096> out;
  send(sim, WireClient::startSequence() + "StartTakeoff\n");
  const std::string command = "Pos2 -0.02,0.15,20\n";
  const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(command.data()),
                                            command.size());
  const testing::MallocGuard guard;
  for (int i = 1; i < 1500; ++i) {
    sim.advanceTo(Time{} + i * milliseconds(10));
    sim.receive(bytes);
    static_cast<void>(sim.transmit(out));
  }
  EXPECT_EQ(guard.allocations(), 0);
  EXPECT_EQ(guard.deallocations(), 0);
}

TEST(Simulator, TruthMessageCarriesTheTruth) {
  Truth truth;
  truth.p_WD = {1, 2, 3};
  truth.p_WA = {4, 5, 6};
  truth.gust = {7, 8, 9};
  truth.contact_count = 2;
  truth.motors_on = true;
  truth.on_ground = false;
  truth.tangent_elevation = 0.5;
  sim_truth_t message;
  fillTruth(truth, 123456, message);
  EXPECT_EQ(message.utime, 123456);
  EXPECT_EQ(message.position_m[2], 3.0);
  EXPECT_EQ(message.anchor_m[0], 4.0);
  EXPECT_EQ(message.gust_mps[1], 8.0);
  EXPECT_EQ(message.contact_count, 2);
  EXPECT_EQ(message.tangent_elevation_rad, 0.5);
  EXPECT_TRUE(message.motors_on);
  EXPECT_FALSE(message.on_ground);
}

}  // namespace
}  // namespace tautline::sim
