// Where a number falls among cumulative sums.
#ifndef LW_FIND_SUM_H
#define LW_FIND_SUM_H

#include "portable.h"

// Index of the first of `count` inclusive sums that is greater than `target`; when rounding leaves
// none, the last one that grew. Entries of zero weight are never returned while any other exists.
LW_FN int find_sum(__global const float* sums, int count, float target) {
    target = fmin(target, sums[count - 1]);
    int low = 0, high = count - 1;
    while (low < high) {
        const int middle = (low + high) >> 1;
        if (sums[middle] > target) high = middle;
        else low = middle + 1;
    }
    while (low > 0 && !(sums[low] > sums[low - 1])) --low;
    return low;
}

#endif
