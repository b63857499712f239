#pragma once

/// @file
/// One source for all vector widths: a piece of work is compiled once for each instruction set that
/// matters and the widest one that this CPU has is chosen when it runs. The code inside uses the
/// compilers' vector types, no intrinsics. Not real-time safe: offline only.
///
/// multiversion.h compiles plain loops several times; here the code also knows how wide the vectors
/// are, so that it keeps many of them in registers. It works under sanitizers, and a test can run
/// every width. All that is called inside must be TAUTLINE_INLINE.
///
/// Vectors are passed by reference only: by value their calling convention would depend on the
/// instruction set.

#include <atomic>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "planning_offline/multiversion.h"

/// What TAUTLINE_INLINE is to a function, for a lambda: stands after its parameters.
#define TAUTLINE_SIMD_LAMBDA __attribute__((always_inline))

namespace tautline::planning {

/// Vector of kBytes bytes with elements of type T.
template <class T, int kBytes>
struct SimdOf {
  typedef T Type __attribute__((vector_size(kBytes)));  // NOLINT: `using` cannot carry it in clang
};
template <class T, int kBytes>
using Simd = typename SimdOf<T, kBytes>::Type;

/// Reads or writes a vector at any address.
template <class V, class T>
TAUTLINE_INLINE void simdLoad(const T* from, V& to) noexcept {
  std::memcpy(&to, from, sizeof(V));
}
template <class V, class T>
TAUTLINE_INLINE void simdStore(const V& from, T* to) noexcept {
  std::memcpy(to, &from, sizeof(V));
}

/// True if any bit of the vector is set.
template <class V>
TAUTLINE_INLINE bool simdAny(const V& v) noexcept {
  std::uint64_t words[sizeof(V) / sizeof(std::uint64_t)];
  std::memcpy(words, &v, sizeof(V));
  std::uint64_t all = 0;
  for (const std::uint64_t word : words) all |= word;
  return all != 0;
}

namespace simd_detail {

template <int kBytes>
using Bytes = std::integral_constant<int, kBytes>;

#if defined(__x86_64__)
template <class Body>
__attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,avx2,bmi,bmi2"))) void runAvx512(
    const Body& body) {
  body(Bytes<64>{});
}
template <class Body>
__attribute__((target("avx2,bmi,bmi2"))) void runAvx2(const Body& body) {
  body(Bytes<32>{});
}
#endif

}  // namespace simd_detail

/// Widest vectors of this CPU [bytes]: 64 (x86-64-v4), 32 (x86-64-v3) or 16 (every x86-64 and
/// aarch64).
[[nodiscard]] inline int simdBytes() noexcept {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq")) {
    return 64;
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2")) return 32;
#endif
  return 16;
}

/// While it lives, withWidestVectors() keeps to vectors of at most this many bytes: how tests and
/// benchmarks run every width. One at a time.
class SimdLimit {
 public:
  explicit SimdLimit(int bytes) noexcept { largest_ = bytes; }
  ~SimdLimit() { largest_ = kNone; }
  SimdLimit(const SimdLimit&) = delete;
  SimdLimit& operator=(const SimdLimit&) = delete;

  [[nodiscard]] static int apply(int bytes) noexcept {
    return bytes < largest_ ? bytes : largest_.load();
  }

 private:
  static constexpr int kNone = 64;
  inline static std::atomic<int> largest_{kNone};
};

/// Calls body(std::integral_constant<int, kBytes>), compiled for vectors of kBytes bytes, the
/// widest that this CPU has. The body is a lambda with TAUTLINE_SIMD_LAMBDA.
template <class Body>
void withWidestVectors(const Body& body) {
  const int bytes = SimdLimit::apply(simdBytes());
#if defined(__x86_64__)
  if (bytes == 64) return simd_detail::runAvx512(body);
  if (bytes == 32) return simd_detail::runAvx2(body);
#endif
  static_cast<void>(bytes);
  body(simd_detail::Bytes<16>{});
}

}  // namespace tautline::planning
