// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// LACUNA_WIDE before a function compiles it once more for AVX2; the clone is chosen when the
/// program starts. The same numbers come out, since products and sums stay apart
/// (-ffp-contract=off). It is empty in builds with sanitizers, whose run-time is not ready yet when
/// the loader chooses, and for clang, which says by other means that it builds with them.
///
/// Such a function must not throw, nor ask for memory: GCC 12 compiles calls of it as if it could
/// not, so that the caller's objects are not destroyed, or the wrong ones.
#ifndef lacunaWide_h
#define lacunaWide_h

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) &&                             \
  !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define LACUNA_WIDE __attribute__((target_clones("default", "avx2")))
#else
#define LACUNA_WIDE
#endif

/// Before a function that such a function calls: only what is inlined is compiled for AVX2 with it.
#if defined(__GNUC__)
#define LACUNA_INLINE inline __attribute__((always_inline))
#else
#define LACUNA_INLINE inline
#endif
#endif
