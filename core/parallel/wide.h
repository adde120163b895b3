#pragma once

/// HYDROSCOPE_WIDE before a function has it compiled for any x86-64, for AVX2 and for AVX-512; which one runs
/// is settled when the program starts, by the processor it runs on. All give the same result to the bit:
/// loops keep their order and products are not fused with sums (-ffp-contract=off in CMakeLists.txt).
/// What such a function calls is compiled with it where it is always_inline; GCC takes in all of it (flatten), clang does not.
/// It is static, so that none can be declared in a header: of a function that an earlier block of its namespace declares, clang 14
/// makes one version alone, the one for AVX-512, and the program dies on every other processor.
/// HYDROSCOPE_WIDE_TEMPLATE before a template does the same where the compiler can (clang 14 cannot).
/// Sanitizers cannot intercept such functions, so they see the plain one.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HYDROSCOPE_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define HYDROSCOPE_SANITIZED
#endif
#endif

#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(HYDROSCOPE_SANITIZED)
#define HYDROSCOPE_HAS_WIDE
#endif

#if defined(HYDROSCOPE_HAS_WIDE) && defined(__clang__)
#define HYDROSCOPE_WIDE static __attribute__((target_clones("avx512f", "avx2", "default")))
#define HYDROSCOPE_WIDE_TEMPLATE
#elif defined(HYDROSCOPE_HAS_WIDE)
#define HYDROSCOPE_WIDE static __attribute__((flatten, target_clones("avx512f", "avx2", "default")))
#define HYDROSCOPE_WIDE_TEMPLATE __attribute__((flatten, target_clones("avx512f", "avx2", "default")))
#else
#define HYDROSCOPE_WIDE static
#define HYDROSCOPE_WIDE_TEMPLATE
#endif
