// The only header that knows which language compiles it: OpenCL C 1.2 or C++17. Headers shared by
// kernels and host include this one, use scalars and 4-vectors only, and check every struct's size on
// both sides. Includes in angle brackets are the host's; only quoted ones are flattened into kernels.
#ifndef LW_PORTABLE_H
#define LW_PORTABLE_H

#ifdef __cplusplus
#include <cmath>
#include <compute/cl.h>
#include <cstdint>
typedef cl_int lw_int;
typedef cl_uint lw_uint;
typedef cl_float lw_float;
typedef cl_long lw_long;
typedef cl_int4 lw_int4;
typedef cl_float4 lw_float4;
#define LW_FN static inline
#define LW_CONSTANT static const
#define LW_SIZE_CHECK(T, bytes) static_assert(sizeof(T) == (bytes), #T " differs between host and device")
#else
typedef int lw_int;
typedef uint lw_uint;
typedef float lw_float;
typedef long lw_long;
typedef int4 lw_int4;
typedef float4 lw_float4;
#define LW_FN static inline __attribute__((always_inline))
#define LW_CONSTANT __constant
#define LW_SIZE_CHECK(T, bytes) typedef char lw_size_check_##T[sizeof(T) == (bytes) ? 1 : -1]
#endif

#endif
