#pragma once

/// HYDROSCOPE_WIDE before a function has it compiled for any x86-64, for AVX2 and for AVX-512; which one runs
/// is settled when the program starts, by the processor it runs on. All give the same result to the bit:
/// loops keep their order and products are not fused with sums (-ffp-contract=off in CMakeLists.txt).
/// Sanitizers cannot intercept such functions, so they see the plain one.
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define HYDROSCOPE_HAS_WIDE
#define HYDROSCOPE_WIDE __attribute__((flatten, target_clones("avx512f", "avx2", "default")))
#else
#define HYDROSCOPE_WIDE
#endif
