#include "app/station/mission_store.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "app/station/mission_upload.h"

namespace tautline {
namespace {

using Chunk = tautline::mission_chunk_t;

std::unique_ptr<MissionPlan> makePlan(int waypoints, int contacts) {
  auto plan = std::make_unique<MissionPlan>();
  plan->hash = 0x123456789abcU + static_cast<std::uint64_t>(waypoints);
  plan->waypoint_count = waypoints;
  plan->contact_count = contacts;
  for (int i = 0; i < contacts; ++i)
    plan->contacts[static_cast<std::size_t>(i)] = {10 + i, {0.1 * i, 1.0, -0.2 * i}};
  for (int i = 0; i < waypoints; ++i) {
    Waypoint& w = plan->waypoints[static_cast<std::size_t>(i)];
    w.p_WD = {0.01 * i, 1.0 + 0.001 * i, -0.5};
    w.contact = contacts > 0 && i % 3 == 1 ? 10 + i % contacts : 0;
    if (i % 2 == 0) w.p_WL = Eigen::Vector3d(1, 2, 0.5 * i);
    w.speed = 0.3;
    w.hold = i % 5;
    w.risk = 0.001 * (i % 100);
  }
  return plan;
}

std::vector<Chunk> chunksOf(const MissionPlan& plan) {
  std::vector<Chunk> chunks;
  forEachChunk(plan, [&](Chunk& chunk) {
    chunks.push_back(chunk);
    return true;
  });
  return chunks;
}

void expectSame(const MissionPlan& a, const MissionPlan& b) {
  EXPECT_EQ(a.hash, b.hash);
  ASSERT_EQ(a.waypoint_count, b.waypoint_count);
  ASSERT_EQ(a.contact_count, b.contact_count);
  for (std::size_t i = 0; i < static_cast<std::size_t>(a.waypoint_count); ++i) {
    EXPECT_EQ(a.waypoints[i].p_WD, b.waypoints[i].p_WD);
    EXPECT_EQ(a.waypoints[i].contact, b.waypoints[i].contact);
    EXPECT_EQ(a.waypoints[i].p_WL, b.waypoints[i].p_WL);
    EXPECT_EQ(a.waypoints[i].speed, b.waypoints[i].speed);
    EXPECT_EQ(a.waypoints[i].hold, b.waypoints[i].hold);
    EXPECT_EQ(a.waypoints[i].risk, b.waypoints[i].risk);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(a.contact_count); ++i) {
    EXPECT_EQ(a.contacts[i].id, b.contacts[i].id);
    EXPECT_EQ(a.contacts[i].p_WC, b.contacts[i].p_WC);
  }
}

TEST(MissionStore, TakesChunksInAnyOrderAndTwice) {
  std::mt19937 random(7);
  for (const auto& [waypoints, contacts] :
       {std::pair{1, 0}, {16, 1}, {17, 2}, {701, 40}, {kMaxWaypoints, kMaxContacts}}) {
    const auto plan = makePlan(waypoints, contacts);
    std::vector<Chunk> chunks = chunksOf(*plan);
    chunks.insert(chunks.end(), chunks.begin(),
                  chunks.begin() + static_cast<std::ptrdiff_t>(chunks.size() / 2));
    std::shuffle(chunks.begin(), chunks.end(), random);
    const auto store = std::make_unique<MissionStore>();
    for (const Chunk& chunk : chunks) EXPECT_TRUE(store->add(chunk));
    ASSERT_NE(store->loaded(), nullptr);
    expectSame(*store->loaded(), *plan);
  }
}

TEST(MissionStore, IsNotLoadedWhileAnythingIsMissing) {
  const auto plan = makePlan(40, 2);
  const std::vector<Chunk> chunks = chunksOf(*plan);
  for (std::size_t missing = 0; missing < chunks.size(); ++missing) {
    const auto store = std::make_unique<MissionStore>();
    for (std::size_t i = 0; i < chunks.size(); ++i) {
      if (i != missing) {
        EXPECT_TRUE(store->add(chunks[i]));
      }
    }
    EXPECT_EQ(store->loaded(), nullptr);
    EXPECT_TRUE(store->add(chunks[missing]));
    EXPECT_NE(store->loaded(), nullptr);
  }
}

TEST(MissionStore, ActivePlanStaysWhileAnotherArrives) {
  const auto store = std::make_unique<MissionStore>();
  const auto first = makePlan(20, 1);
  const auto second = makePlan(30, 3);
  for (const Chunk& c : chunksOf(*first)) store->add(c);
  store->activate();
  EXPECT_EQ(store->loaded(), nullptr);
  for (const Chunk& c : chunksOf(*second)) store->add(c);
  ASSERT_NE(store->active(), nullptr);
  expectSame(*store->active(), *first);
  expectSame(*store->loaded(), *second);
  store->activate();
  expectSame(*store->active(), *second);
}

TEST(MissionStore, WaypointWithUnknownContactIsNeverLoaded) {
  auto plan = makePlan(5, 1);
  plan->waypoints[3].contact = 99;
  const auto store = std::make_unique<MissionStore>();
  for (const Chunk& c : chunksOf(*plan)) store->add(c);
  EXPECT_EQ(store->loaded(), nullptr);
}

TEST(MissionStore, RefusesMalformedChunks) {
  const Chunk good = chunksOf(*makePlan(10, 0)).front();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::function<void(Chunk&)>> damages{
      [](Chunk& c) { c.mission_hash = 0; },
      [](Chunk& c) { c.waypoint_total = 0; },
      [](Chunk& c) { c.waypoint_total = kMaxWaypoints + 1; },
      [](Chunk& c) { c.contact_total = -1; },
      [](Chunk& c) { c.contact_total = kMaxContacts + 1; },
      [](Chunk& c) { c.kind = 2; },
      [](Chunk& c) { c.first = -1; },
      [](Chunk& c) { c.first = 1; },
      [](Chunk& c) { c.first = std::numeric_limits<std::int32_t>::max(); },
      [](Chunk& c) { c.count = 0; },
      [](Chunk& c) { c.count = Chunk::CAPACITY + 1; },
      [](Chunk& c) { c.count = std::numeric_limits<std::int32_t>::min(); },
      [=](Chunk& c) { c.position_m[4][1] = nan; },
      [](Chunk& c) { c.position_m[0][0] = 1e9; },
      [=](Chunk& c) { c.look_at_m[2][2] = nan; },
      [](Chunk& c) { c.contact_id[1] = -3; },
      [=](Chunk& c) { c.speed_mps[0] = nan; },
      [](Chunk& c) { c.speed_mps[0] = -0.1; },
      [](Chunk& c) { c.hold_s[9] = -1.0; },
      [](Chunk& c) { c.risk[9] = 1.5; },
  };
  for (std::size_t i = 0; i < damages.size(); ++i) {
    const auto store = std::make_unique<MissionStore>();
    Chunk bad = good;
    damages[i](bad);
    EXPECT_FALSE(store->add(bad)) << "damage " << i;
    EXPECT_EQ(store->loaded(), nullptr);
    EXPECT_TRUE(store->add(good)) << "a bad chunk must not spoil a good one, damage " << i;
  }
}

// Any bytes that decode as a chunk: never a crash (run under the sanitizers), and never a plan that
// names no contact.
TEST(MissionStore, SurvivesRandomChunks) {
  std::mt19937_64 random(11);
  const auto store = std::make_unique<MissionStore>();
  const Chunk good = chunksOf(*makePlan(10, 0)).front();
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(good.getEncodedSize()));
  for (int round = 0; round < 20000; ++round) {
    good.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    for (int hit = 0; hit < 4; ++hit)
      bytes[8 + random() % (bytes.size() - 8)] = static_cast<std::uint8_t>(random());
    Chunk chunk;
    ASSERT_GT(chunk.decode(bytes.data(), 0, static_cast<int>(bytes.size())), 0);
    store->add(chunk);
    if (const MissionPlan* plan = store->loaded()) {
      for (int i = 0; i < plan->waypoint_count; ++i) {
        const Waypoint& w = plan->waypoints[static_cast<std::size_t>(i)];
        ASSERT_TRUE(w.p_WD.allFinite());
        ASSERT_TRUE(w.contact == kReelContact || plan->findContact(w.contact) != nullptr);
      }
    }
  }
}

}  // namespace
}  // namespace tautline
