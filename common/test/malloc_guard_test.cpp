#include "common/testing/malloc_guard.h"

#include <cstdlib>
#include <memory>
#include <thread>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

namespace tautline::testing {
namespace {

// Keeps the compiler from removing a block that nobody uses.
void use(void* block) {
  void* volatile seen = block;
  static_cast<void>(seen);
}

class MallocGuardTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!MallocGuard::available())
      GTEST_SKIP() << "a sanitizer owns malloc in this build: nothing to count";
  }
};

TEST_F(MallocGuardTest, SeesEveryWayToTheHeapAndBack) {
  struct alignas(64) Aligned {
    double value[8];
  };
  const MallocGuard guard;
  long expected = 0;
  const auto counted = [&](const char* what) {
    ++expected;
    EXPECT_EQ(guard.allocations(), expected) << what;
    EXPECT_EQ(guard.deallocations(), expected) << what;
  };
  void* block = std::malloc(16);
  use(block);
  std::free(block);
  counted("malloc");
  block = std::calloc(2, 8);
  use(block);
  std::free(block);
  counted("calloc");
  block = std::aligned_alloc(64, 64);
  use(block);
  std::free(block);
  counted("aligned_alloc");
  ASSERT_EQ(posix_memalign(&block, 64, 64), 0);
  use(block);
  std::free(block);
  counted("posix_memalign");
  { use(std::make_unique<int>(1).get()); }
  counted("new");
  { use(std::make_unique<Aligned>().get()); }
  counted("new of an over-aligned type");
  { use(std::vector<int>(10).data()); }
  counted("std::vector");
  { use(Eigen::VectorXd(10).data()); }
  counted("Eigen");
}

TEST_F(MallocGuardTest, CountsFromItsConstructionAndInItsThreadOnly) {
  use(std::make_unique<int>(1).get());
  const MallocGuard guard;
  std::thread other;
  const long before = guard.allocations();
  EXPECT_EQ(before, 0);
  long in_thread = 0;
  other = std::thread([&in_thread] {
    const MallocGuard own;
    use(std::make_unique<int>(1).get());
    in_thread = own.allocations();
  });
  const long of_starting_it = guard.allocations();
  other.join();
  EXPECT_EQ(in_thread, 1);
  EXPECT_EQ(guard.allocations(), of_starting_it);
}

}  // namespace
}  // namespace tautline::testing
