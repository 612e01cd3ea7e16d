// Marks a function whose loops the compiler turns into vector code: built once for each level of x86-64,
// the best that runs here is taken when the program starts. Loops must be plain: arrays, no calls out.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define STUDIO_SIMD __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define STUDIO_SIMD
#endif
