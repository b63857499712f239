#include "control/flown_path.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "control/route.h"
#include "control/segment.h"

namespace tautline {
namespace {

/// Records a flight in steps of one centimetre.
class FlownPathTest : public ::testing::Test {
 protected:
  void SetUp() override { path_.begin({0, 1, 0}); }

  void flyTo(const Eigen::Vector3d& end) {
    const Eigen::Vector3d start = here_;
    const int steps = std::max(1, static_cast<int>((end - start).norm() / 0.01));
    for (int i = 1; i <= steps; ++i) {
      here_ = start + (end - start) * i / steps;
      path_.record(here_, contacts_, tether_known_);
      flown_.push_back(here_);
    }
  }
  void make(int id, const Eigen::Vector3d& p_WC) {
    EXPECT_EQ(contacts_.push(id, p_WC), ContactStack::Change::kPushed);
    path_.record(here_, contacts_, tether_known_);
  }
  void comeOff(int to) {
    EXPECT_EQ(contacts_.select(to, MissionPlan{}), ContactStack::Change::kPopped);
    path_.record(here_, contacts_, tether_known_);
  }
  /// Ids that are active on the way back, in order, without repetition.
  std::vector<int> idsBack() {
    const Route back = Route::back(path_, here_, 1e9, 0.3);
    ContactStack stack = contacts_;
    std::vector<int> ids;
    for (int i = 0; i < back.count(); ++i) {
      const ContactStack::Change change = back.select(i, stack);
      EXPECT_EQ(change, ContactStack::Change::kNone);
      if (ids.empty() || ids.back() != stack.activeId()) ids.push_back(stack.activeId());
    }
    EXPECT_EQ(stack.contactCount(), 0);
    return ids;
  }
  double farthest() const {  // of what was flown from the path
    double worst = 0.0;
    for (const Eigen::Vector3d& p : flown_) {
      double least = 1e9;
      for (int i = 1; i < path_.count(); ++i)
        least =
            std::min(least, projectOnSegment(p, path_.point(i - 1), path_.point(i)).cross_track);
      worst = std::max(worst, least);
    }
    return worst;
  }

  FlownPath path_;
  ContactStack contacts_;
  bool tether_known_{true};
  Eigen::Vector3d here_{0, 1, 0};
  std::vector<Eigen::Vector3d> flown_;
};

TEST_F(FlownPathTest, KnowsNothingBeforeItBegins) {
  FlownPath path;
  path.record({1, 1, 1}, contacts_, true);
  EXPECT_FALSE(path.known());
  EXPECT_EQ(Route::back(path, {1, 1, 1}, 1.0, 0.3).count(), 0);
  path_.clear();
  EXPECT_FALSE(path_.known());
}

TEST_F(FlownPathTest, KeepsCornersAndLeavesOutWhatLiesOnAStraightLine) {
  flyTo({5, 1, 0});
  flyTo({5, 1, 5});
  EXPECT_LE(path_.count(), 5);
  EXPECT_LT(farthest(), FlownPath::kSpacing);
}

TEST_F(FlownPathTest, FollowsACurveWithinItsTolerance) {
  for (double a = 0.0; a < 5.0; a += 0.01)
    flyTo({3.0 * std::sin(a), 1.0 + 0.3 * a, 3.0 * (1.0 - std::cos(a))});
  EXPECT_LT(path_.count(), 40);
  EXPECT_LT(farthest(), FlownPath::kTolerance + FlownPath::kSpacing / 2.0);
}

TEST_F(FlownPathTest, WhenFullItIsThinnedAndKeepsEveryContact) {
  tether_known_ = false;  // nothing is forgotten
  constexpr int kZigzags = 2000;
  for (int i = 0; i < kZigzags; ++i) {
    flyTo({0.3 * i, i % 2 == 0 ? 1.0 : 1.4, 0});
    if (i == 500) make(1, {100, 2, 0});
    if (i == 1500) make(2, {400, 2, 0});
  }
  EXPECT_TRUE(path_.known());
  EXPECT_LE(path_.count(), FlownPath::kMaxPoints);
  EXPECT_LT(farthest(), 0.6);
  EXPECT_EQ(idsBack(), (std::vector<int>{2, 1, 0}));
}

TEST_F(FlownPathTest, GivesUpWhenContactsAloneFillIt) {
  tether_known_ = false;
  for (int i = 0; i < FlownPath::kMaxPoints && path_.known(); ++i) {
    flyTo({0.5 * i, 1, 0});
    make(1, {0.1, 1, 0});
    comeOff(0);
  }
  EXPECT_FALSE(path_.known());
}

TEST_F(FlownPathTest, UndoesContactsInReverseAlsoThoseOfAnotherMissionWithTheSameIds) {
  flyTo({1, 1, 0});
  make(1, {0.5, 1, 0.1});
  flyTo({2, 1, 1});
  make(2, {1.5, 1, 0.5});
  flyTo({3, 1, 2});
  EXPECT_EQ(idsBack(), (std::vector<int>{2, 1, 0}));
  comeOff(0);  // far from both: the way over them is kept
  flyTo({3, 1, 4});
  EXPECT_EQ(idsBack(), (std::vector<int>{0, 2, 1, 0}));
  make(1, {3, 1, 3});
  flyTo({4, 1, 5});
  EXPECT_EQ(idsBack(), (std::vector<int>{1, 0, 2, 1, 0}));
  ContactStack stack;
  EXPECT_EQ(path_.restore(path_.count() - 1, stack), ContactStack::Change::kNone);
  EXPECT_EQ(stack.point(1), Eigen::Vector3d(3, 1, 3));
}

TEST_F(FlownPathTest, ALoopIsForgottenOnlyOnTheSameStackAndWithAKnownTether) {
  for (const bool known : {true, false}) {
    path_.begin({0, 1, 0});
    here_ = {0, 1, 0};
    tether_known_ = known;
    for (const Eigen::Vector3d& p :
         {Eigen::Vector3d(2, 1, 0), Eigen::Vector3d(4, 1, 0), Eigen::Vector3d(4, 1, 2),
          Eigen::Vector3d(2, 1, 2), Eigen::Vector3d(2, 1, -0.3)})
      flyTo(p);
    const Route back = Route::back(path_, here_, 1e9, 0.3);
    if (known) {
      EXPECT_LE(back.count(), 3);
    } else {
      EXPECT_GE(back.count(), 5);
    }
  }
}

TEST_F(FlownPathTest, AContactMadeAndComeOffOnTheTethersLineIsForgotten) {
  const Eigen::Vector3d corner(1, 1, 1);
  flyTo({2, 1.9, 2});
  make(1, corner);
  flyTo({3, 1.9, 1.5});
  flyTo({2.5, 2.5, 2.6});
  comeOff(0);
  EXPECT_EQ(idsBack(), (std::vector<int>{0})) << "made and undone";
}

TEST_F(FlownPathTest, IsCutWhileItIsFlownBack) {
  flyTo({2, 1, 0});
  make(1, {1.5, 1, 0.1});
  flyTo({2, 1, 3});
  flyTo({5, 1, 3});
  const int last = path_.count() - 1;
  path_.cutAfter(last - 2);
  EXPECT_EQ(path_.count(), last - 1);
  path_.cutAfter(0);
  EXPECT_EQ(path_.count(), 1);
  EXPECT_EQ(path_.point(0), Eigen::Vector3d(0, 1, 0));
}

TEST_F(FlownPathTest, ARouteBackEndsAfterItsDistance) {
  flyTo({3, 1, 0});
  flyTo({3, 1, 3});
  const Route back = Route::back(path_, here_, 4.0, 0.3);
  EXPECT_LT((back.leg(back.count() - 1).p_WD - Eigen::Vector3d(2, 1, 0)).norm(), 0.2);
  const Route home = Route::back(path_, here_, 100.0, 0.3);
  EXPECT_EQ(home.leg(home.count() - 1).p_WD, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(home.leg(0).speed, 0.3);
}

}  // namespace
}  // namespace tautline
