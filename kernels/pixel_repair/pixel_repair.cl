// Marked pixels, wherever they are in a picture, as a small image that any gather can light, and their light back to where they are:
// what interpolation does not get right is computed (Dachsbacher and Stamminger 2005 repair their indirect light so).
//
// Pixels lie in the small image in the order of the picture's rows. Where more are marked than it has room for, every n-th (n need not
// be whole) is taken, so that no part of the picture is better off.
#include "shared/pixel_repair_types.h"
#include "shared/vpl_list.h"
#include "shared/wide.h"

// The marks of pixels x, x + 1, ... x + 31 of a row, a bit each; none beyond `width`.
LW_FN uint marks_at(__global const float* row, int x, int width) {
    uint word = 0;
    LW_UNROLL for (int k = 0; k < 32; k += LW_WIDTH) {
        if (x + k >= width) break;
        const mask marked = and_(load(row, x + k) > 0.0f, lanei_iota() + (lanei)(x + k) < (lanei)width);
        if (any_(marked)) word |= bits_(marked) << k;
    }
    return word;
}

// One work-item = one row: its marks as words of 32 pixels, and how many there are.
__kernel void pixel_repair_count(__global const float* marks, int4 marksLayout, int width, int height, __global uint* words,
                                 __global int* rows) {
    const int y = (int)get_global_id(0), wordsOfRow = (width + 31) / 32;
    if (y >= height) return;
    int count = 0;
    for (int i = 0; i < wordsOfRow; ++i) {
        const uint word = marks_at(marks + marksLayout.x + y * marksLayout.y, 32 * i, width);
        words[y * wordsOfRow + i] = word;
        count += (int)popcount(word);
    }
    rows[y] = count;
}

// One work-item in all. rows: becomes the number of marked pixels before each row. room: of the small image.
__kernel void pixel_repair_share(__global int* rows, int height, int room, __global int* state) {
    if (get_global_id(0) != 0) return;
    int before = 0;
    for (int y = 0; y < height; ++y) {
        const int count = rows[y];
        rows[y] = before;
        before += count;
    }
    const int taken = min(before, room);
    state[LW_REPAIR_MARKED] = before;
    state[LW_REPAIR_TAKEN] = taken;
    state[LW_REPAIR_LEFT] = before - taken;
}

// One work-item = one row: its marked pixels' surfaces as the host gave them, 3 planes each, and where they are (LW_REPAIR_PIXEL) by
// place. Normals of places that none takes are 0 before.
__kernel void pixel_repair_collect(__global const uint* words, __global const float* position, int4 positionLayout,
                                   __global const float* normal, int4 normalLayout, int width, int height, __global const int* rows,
                                   __global const int* state, __global int* pixels, __global float* listedPosition,
                                   int4 listedPositionLayout, __global float* listedNormal, int4 listedNormalLayout) {
    const int y = (int)get_global_id(0), wordsOfRow = (width + 31) / 32;
    const int taken = state[LW_REPAIR_TAKEN], marked = state[LW_REPAIR_MARKED];
    if (y >= height || taken == 0) return;
    // The place of the i-th marked pixel is i * taken / marked, carried on with its remainder; it is taken where the next one's place is
    // another.
    const long first = (long)rows[y] * (long)taken;
    int place = (int)(first / (long)marked), rest = (int)(first - (long)place * (long)marked);
    for (int i = 0; i < wordsOfRow; ++i) {
        uint bits = words[y * wordsOfRow + i];
        while (bits) {
            const int x = 32 * i + take_lowest(&bits);
            rest += taken;
            if (rest < marked) continue;
            rest -= marked;
            pixels[place] = LW_REPAIR_PIXEL(x, y);
            const int row = place / LW_REPAIR_COLUMNS, column = place - row * LW_REPAIR_COLUMNS;
            ++place;
            LW_UNROLL for (int a = 0; a < 3; ++a) {
                listedPosition[listedPositionLayout.x + a * listedPositionLayout.z + row * listedPositionLayout.y + column] =
                    position[positionLayout.x + a * positionLayout.z + y * positionLayout.y + x];
                listedNormal[listedNormalLayout.x + a * listedNormalLayout.z + row * listedNormalLayout.y + column] =
                    normal[normalLayout.x + a * normalLayout.z + y * normalLayout.y + x];
            }
        }
    }
}

// One work-item = one place: its light, 3 planes, to the pixel that it is of.
__kernel void pixel_repair_put(__global const int* state, __global const int* pixels, __global const float* light, int4 lightLayout,
                               __global float* irradiance, int4 irradianceLayout) {
    const int place = lw_list_index();
    if (place >= state[LW_REPAIR_TAKEN]) return;
    const int row = place / LW_REPAIR_COLUMNS, column = place - row * LW_REPAIR_COLUMNS, pixel = pixels[place];
    for (int a = 0; a < 3; ++a)
        irradiance[irradianceLayout.x + a * irradianceLayout.z + LW_REPAIR_Y(pixel) * irradianceLayout.y + LW_REPAIR_X(pixel)] =
            light[lightLayout.x + a * lightLayout.z + row * lightLayout.y + column];
}
