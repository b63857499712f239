#include "common/testing/malloc_guard.h"

#include <cerrno>
#include <cstddef>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define TAUTLINE_COUNT_MALLOC 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(memory_sanitizer)
#define TAUTLINE_COUNT_MALLOC 0
#else
#define TAUTLINE_COUNT_MALLOC 1
#endif
#else
#define TAUTLINE_COUNT_MALLOC 1
#endif

namespace {
thread_local long allocation_count = 0;
thread_local long deallocation_count = 0;
}  // namespace

#if TAUTLINE_COUNT_MALLOC
// glibc's own entry points; operator new and Eigen's aligned allocation end in the functions below.
extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier)
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);
// NOLINTEND(bugprone-reserved-identifier)

void* malloc(std::size_t size) noexcept {
  ++allocation_count;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  ++allocation_count;
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) noexcept {
  ++allocation_count;
  return __libc_realloc(block, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++allocation_count;
  return __libc_memalign(alignment, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  ++allocation_count;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) noexcept {
  ++allocation_count;
  *block = __libc_memalign(alignment, size);
  return *block != nullptr ? 0 : ENOMEM;
}
void free(void* block) noexcept {
  if (block != nullptr) ++deallocation_count;
  __libc_free(block);
}
}  // extern "C"
#endif

namespace tautline::testing {

MallocGuard::MallocGuard() noexcept
    : allocations_at_start_(allocation_count), deallocations_at_start_(deallocation_count) {}

long MallocGuard::allocations() const noexcept { return allocation_count - allocations_at_start_; }

long MallocGuard::deallocations() const noexcept {
  return deallocation_count - deallocations_at_start_;
}

bool MallocGuard::available() noexcept { return TAUTLINE_COUNT_MALLOC != 0; }

}  // namespace tautline::testing
