#pragma once

/// @file
/// One portable source, several instruction sets: a function marked TAUTLINE_MULTIVERSION is
/// compiled for AVX-512, AVX2 and the x86-64 baseline, and the loader picks the best that the
/// processor has. Elsewhere (aarch64 has NEON in its baseline), and under sanitizers, which cannot
/// run in the loader's choice, the macro is empty.
///
/// Write plain loops over arrays (of a fixed size, where possible): both compilers vectorize them
/// for each version at -O3, while g++ takes its own vector types apart before it clones. What such
/// a function calls is compiled for it only if it is inlined into it: mark helpers
/// TAUTLINE_INLINE. clang 14 cannot clone templates. Floating-point results are the same in all
/// versions, as the project compiles with -ffp-contract=off; order sums yourself.
///
/// -DTAUTLINE_BASELINE compiles the baseline alone, to test it on a better processor.

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(memory_sanitizer)
#define TAUTLINE_SANITIZED
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define TAUTLINE_SANITIZED
#endif

#if defined(__x86_64__) && defined(__linux__) && !defined(TAUTLINE_SANITIZED) && \
    !defined(TAUTLINE_BASELINE)
#if defined(__clang__)  // clang 14 tells features apart, not levels of the architecture
#define TAUTLINE_MULTIVERSION __attribute__((target_clones("avx512bw", "avx2", "default")))
#else
#define TAUTLINE_MULTIVERSION \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#endif
#else
#define TAUTLINE_MULTIVERSION
#endif

#define TAUTLINE_INLINE inline __attribute__((always_inline))
