#pragma once

/// @file
/// Proof that a piece of code does not touch the heap. Link tautline_malloc_guard: it replaces
/// malloc and its kin in the test program with counting ones. Tests only.
///
///     testing::MallocGuard guard;
///     loop();
///     EXPECT_EQ(guard.allocations(), 0);

namespace tautline::testing {

/// Counts what this thread does to the heap since the guard's construction.
class MallocGuard {
 public:
  MallocGuard() noexcept;

  /// malloc, calloc, realloc, aligned_alloc, memalign, posix_memalign and operator new calls so
  /// far.
  [[nodiscard]] long allocations() const noexcept;

  /// Blocks given back by free or operator delete so far: as unfit for the loop as taking them.
  [[nodiscard]] long deallocations() const noexcept;

  /// False in sanitizer builds, where the sanitizer owns malloc and nothing is counted.
  [[nodiscard]] static bool available() noexcept;

 private:
  long allocations_at_start_;
  long deallocations_at_start_;
};

}  // namespace tautline::testing
