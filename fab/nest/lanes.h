// For loops over lanes that the compiler is to vectorise.

#pragma once

#if defined(__GNUC__)
#define LEAFCUTTER_INLINE inline __attribute__((always_inline))
#else
#define LEAFCUTTER_INLINE inline
#endif

// A loop over lanes that is unrolled before the vectoriser sees it stays scalar.
#if defined(__GNUC__) && !defined(__clang__)
#define LEAFCUTTER_LANES _Pragma("GCC unroll 1")
#else
#define LEAFCUTTER_LANES
#endif
