#include "planning_offline/field/parallel.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace tautline::planning {
namespace {

TEST(ParallelFor, CallsEachOnce) {
  for (const int threads : {0, 1, 2, 7}) {
    for (const int count : {0, 1, 5, 1000}) {
      std::vector<int> calls(static_cast<std::size_t>(count), 0);
      EXPECT_TRUE(parallelFor(count, threads, Progress(), {"test"},
                              [&](int i) { ++calls[static_cast<std::size_t>(i)]; }));
      EXPECT_EQ(std::count(calls.begin(), calls.end(), 1), count);
    }
  }
}

TEST(ParallelFor, ReportsFromTheCallersThreadWithinItsStage) {
  const auto caller = std::this_thread::get_id();
  std::vector<double> said;
  const Progress progress([&](std::string_view what, double fraction) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    EXPECT_EQ(what, "half");
    said.push_back(fraction);
  });
  EXPECT_TRUE(parallelFor(50, 1, progress, {"half", 0.5, 0.75}, [](int) {}));
  ASSERT_EQ(said.size(), 50U);
  EXPECT_TRUE(std::is_sorted(said.begin(), said.end()));
  EXPECT_GT(said.front(), 0.5);
  EXPECT_EQ(said.back(), 0.75);
}

TEST(ParallelFor, StopsWhenCancelled) {
  Progress progress;
  std::atomic<int> calls{0};
  EXPECT_FALSE(parallelFor(100000, 3, progress, {"test"}, [&](int) {
    if (++calls == 10) progress.cancel();
  }));
  EXPECT_LT(calls.load(), 100000);
}

}  // namespace
}  // namespace tautline::planning
