// A number for each of the n x n subsets of an interleaved gather.
#ifndef LW_SPREAD_NUMBER_H
#define LW_SPREAD_NUMBER_H

#include "portable.h"

// Its low bits differ most between neighbouring pixels: of every two side by side the lowest, of every 2 x 2 the two
// lowest, and so on. So the groups, which take the low bits, lie as close together as they can, and what an edge leaves of a
// window holds many of them.
LW_FN int spread_number(int subset, int n) {
    const int row = subset / n, column = subset % n;
    int number = 0;
    for (int bit = 0; (1 << bit) < n; ++bit)
        number |= (((row ^ column) >> bit & 1) << (2 * bit)) | ((row >> bit & 1) << (2 * bit + 1));
    return number;
}

#endif
