// Marked pixels, wherever they are in a picture, as a small image that any gather can light, and their light back to where they are:
// what interpolation does not get right is computed (Dachsbacher and Stamminger 2005 repair their indirect light so).
//
// Pixels lie in the small image in the order of the picture's rows. Where more are marked than it has room for, every n-th (n need not
// be whole) is taken, so that no part of the picture is better off.
#include "shared/pixel_repair_types.h"
#include "shared/vpl_list.h"
#include "shared/wide.h"

// One work-item = one row: how many of its pixels are marked.
__kernel void pixel_repair_count(__global const uint* marks, int width, int height, __global int* rows) {
    const int y = (int)get_global_id(0), words = LW_REPAIR_WORDS_OF_ROW(width);
    if (y >= height) return;
    int count = 0;
    for (int i = 0; i < words; ++i) count += (int)popcount(marks[y * words + i]);
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
__kernel void pixel_repair_collect(__global const uint* marks, __global const float* position, int4 positionLayout,
                                   __global const float* normal, int4 normalLayout, int width, int height, __global const int* rows,
                                   __global const int* state, __global int* pixels, __global float* listedPosition,
                                   int4 listedPositionLayout, __global float* listedNormal, int4 listedNormalLayout) {
    const int y = (int)get_global_id(0), words = LW_REPAIR_WORDS_OF_ROW(width);
    const int taken = state[LW_REPAIR_TAKEN], marked = state[LW_REPAIR_MARKED];
    if (y >= height || taken == 0) return;
    // The place of the i-th marked pixel is i * taken / marked, carried on with its remainder; it is taken where the next one's place is
    // another.
    const long first = (long)rows[y] * (long)taken;
    int place = (int)(first / (long)marked), rest = (int)(first - (long)place * (long)marked);
    for (int i = 0; i < words; ++i) {
        uint bits = marks[y * words + i];
        while (bits) {
            const int x = LW_REPAIR_BITS * i + take_lowest(&bits);
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

// One work-item = LW_WIDTH pixels: 1 where they are marked, 0 elsewhere.
__kernel void pixel_repair_show(__global const uint* marks, int width, int height, __global float* shown, int4 shownLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const uint word = marks[y * LW_REPAIR_WORDS_OF_ROW(width) + x / LW_REPAIR_BITS] >> x % LW_REPAIR_BITS;
    const laneu bits = (laneu)word >> as_laneu_(lanei_iota());
    store(to_real(bits & 1u), shown, shownLayout.x + y * shownLayout.y + x);
}
