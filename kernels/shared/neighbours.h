// Reading a row at a shifted position, for filters. Rows hold `width` pixels; what lies outside is not
// read: lanes whose neighbour would be outside take the nearest one inside.
#ifndef LW_NEIGHBOURS_H
#define LW_NEIGHBOURS_H

#include "wide.h"

// Whether every lane's neighbour at x + shift lies inside; uniform over the work-item.
LW_FN int shift_inside(int x, int shift, int width) {
    return x + shift >= 0 && x + shift + LW_WIDTH <= width;
}

// Pixels x + shift ... of the row at `row` (index of its first pixel).
LW_FN real load_shifted(__global const float* image, int row, int x, int shift, int width) {
    if (shift_inside(x, shift, width)) return load(image, row + x + shift);
    const lanei last = (lanei)(width - 1);
    return gather(image, (lanei)row + clamp(lanei_iota() + (lanei)(x + shift), (lanei)0, last));
}

// The same of the pixels right beside: shift is -1, 0 or 1, and x a multiple of LW_WIDTH. Where a row ends, lanes are shifted and not
// gathered: what stands in the row's padding is loaded with them, and only lanes whose neighbour is inside hold something.
LW_FN real load_beside(__global const float* image, int row, int x, int shift, int width) {
    if (shift < 0 && x == 0) return from_left_(load_whole(image + row));
    if (shift > 0 && x + LW_WIDTH >= width) return from_right_(load_whole(image + row + x));
    return load_whole(image + row + x + shift);
}

#endif
