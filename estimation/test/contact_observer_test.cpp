#include "estimation/contact_observer.h"

#include <gtest/gtest.h>

namespace tautline {
namespace {

TEST(ContactObserver, HoldsWhereNothingMoves) {
  ContactObserver observer{ContactObserverConfig{}};
  ContactObserverInput in{.flying = true, .L_total = 2.0, .theta = 0.5, .T = 0.5};
  for (Time now{}; now < Time{} + std::chrono::seconds(20); now += std::chrono::milliseconds(10))
    EXPECT_EQ(observer.update(now, in).hypothesis, TetherHypothesis::kHolds);
}

}  // namespace
}  // namespace tautline
