#include "estimation/height_witness.h"

#include <gtest/gtest.h>

namespace tautline {
namespace {

/// Cycles of 10 ms; a reading every `every` of them.
struct Fed {
  HeightWitness witness{HeightWitnessConfig{}};
  Time now{};
  std::uint32_t sequence{0};
  double evidence{0.0};

  void run(int cycles, int every, double residual) {
    for (int i = 0; i < cycles; ++i) {
      now += std::chrono::milliseconds(10);
      if (i % every == 0) ++sequence;
      witness.update(now, sequence, residual);
      evidence += witness.evidenceOf(0.2);
    }
  }
};

TEST(HeightWitness, AStepIsEvidenceAnOffsetIsNot) {
  Fed fed;
  fed.run(500, 4, 1.5);
  EXPECT_LT(fed.evidence, 0.0);
  EXPECT_NEAR(fed.witness.step(), 0.0, 1e-12);
  fed.evidence = 0.0;
  fed.run(50, 4, 1.7);
  // 12.5 readings, each 0.4 of a sample of (0.2 * 0.2 - 0.02)/0.1^2 at first; the mean follows.
  EXPECT_NEAR(fed.evidence, 10.0, 2.0);
  EXPECT_GT(fed.witness.step(), 0.06);
}

TEST(HeightWitness, AReadingCountsOnce) {
  Fed fed;
  fed.run(500, 4, 0.0);
  fed.run(1, 1, 0.2);
  const double once = fed.evidence;
  for (int i = 0; i < 1000; ++i) {
    fed.now += std::chrono::milliseconds(10);
    fed.witness.update(fed.now, fed.sequence, 0.2);
    EXPECT_EQ(fed.witness.evidenceOf(0.2), 0.0);
  }
  EXPECT_EQ(fed.evidence, once);
}

TEST(HeightWitness, NothingIsJudgedBeforeTheMeanIsSettled) {
  Fed fed;
  fed.run(95, 4, 0.0);
  fed.run(5, 1, 5.0);
  EXPECT_EQ(fed.evidence, 0.0);
  fed.run(300, 4, 0.0);
  EXPECT_NE(fed.evidence, 0.0);
  fed.witness.restart();
  fed.evidence = 0.0;
  fed.run(95, 4, 5.0);
  EXPECT_EQ(fed.evidence, 0.0);
}

}  // namespace
}  // namespace tautline
