// Sums of whole numbers of 64 bits that many work-items add to, in two halves for 32-bit atomics: the same bits in any order.
#ifndef LW_WHOLE_SUMS_H
#define LW_WHOLE_SUMS_H

#include "portable.h"

// Adds to 64 bits in two halves: what overflows the lower one is seen by the one addition that makes it so.
LW_FN void add_long_apart(__global uint* lower, __global uint* upper, long value) {
    if (value == 0) return;
    const uint low = (uint)((ulong)value & 0xffffffffu);
    const uint before = atomic_add(lower, low);
    const uint high = (uint)((ulong)value >> 32) + (before + low < before ? 1u : 0u);
    if (high) atomic_add(upper, high);
}
LW_FN void add_long(__global uint* to, long value) { add_long_apart(to, to + 1, value); }

LW_FN long long_at(__global const uint* from) { return (long)((ulong)from[1] << 32 | (ulong)from[0]); }

#endif
