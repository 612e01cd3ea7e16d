// Marked pixels, wherever they are in a picture, as a small image that any gather can light, and their light back to where they are:
// what interpolation does not get right is computed (Dachsbacher and Stamminger 2005 repair their indirect light so).
//
// Pixels lie in the small image in the order of the picture's rows. Where more are marked than it has room for, every n-th (n need not
// be whole) is taken, so that no part of the picture is better off.
#include "shared/pixel_repair_types.h"
#include "shared/vpl_list.h"
#include "shared/wide.h"

LW_FN mask marked_at(__global const float* marks, int4 layout, int x, int y, int width) {
    return and_(load(marks, layout.x + y * layout.y + x) > 0.0f, lanei_iota() + (lanei)x < (lanei)width);
}

// One work-item = one row: how many of its pixels are marked.
__kernel void pixel_repair_count(__global const float* marks, int4 marksLayout, int width, int height, __global int* rows) {
    const int y = (int)get_global_id(0);
    if (y >= height) return;
    lanei count = (lanei)0;
    for (int x = 0; x < width; x += LW_WIDTH)
        count += selecti_((lanei)0, (lanei)1, marked_at(marks, marksLayout, x, y, width));
    rows[y] = sum_(count);
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

// The place of the i-th marked pixel among those taken; it is one of them where the next one's place is another.
// Where there is room for all, as a rule, without the division.
LW_FN int place_of(int i, int taken, int marked) { return taken == marked ? i : (int)((long)i * (long)taken / (long)marked); }

// One work-item = one row: its marked pixels' surfaces as the host gave them, 3 planes each, and where they are (y * width + x) by
// place. Normals of places that none takes are 0 before.
__kernel void pixel_repair_collect(__global const float* marks, int4 marksLayout, __global const float* position, int4 positionLayout,
                                   __global const float* normal, int4 normalLayout, int width, int height, __global const int* rows,
                                   __global const int* state, __global int* pixels, __global float* listedPosition,
                                   int4 listedPositionLayout, __global float* listedNormal, int4 listedNormalLayout) {
    const int y = (int)get_global_id(0), taken = state[LW_REPAIR_TAKEN], marked = state[LW_REPAIR_MARKED];
    if (y >= height || taken == 0) return;
    int i = rows[y], next = place_of(i, taken, marked);
    for (int x = 0; x < width; x += LW_WIDTH) {
        uint bits = bits_(marked_at(marks, marksLayout, x, y, width));
        while (bits) {
            const int column = x + take_lowest(&bits), place = next;
            next = place_of(++i, taken, marked);
            if (next == place) continue;
            pixels[place] = y * width + column;
            const int row = place / LW_REPAIR_COLUMNS, at = place - row * LW_REPAIR_COLUMNS;
            for (int a = 0; a < 3; ++a) {
                listedPosition[listedPositionLayout.x + a * listedPositionLayout.z + row * listedPositionLayout.y + at] =
                    position[positionLayout.x + a * positionLayout.z + y * positionLayout.y + column];
                listedNormal[listedNormalLayout.x + a * listedNormalLayout.z + row * listedNormalLayout.y + at] =
                    normal[normalLayout.x + a * normalLayout.z + y * normalLayout.y + column];
            }
        }
    }
}

// One work-item = one place: its light, 3 planes, to the pixel that it is of.
__kernel void pixel_repair_put(__global const int* state, __global const int* pixels, __global const float* light, int4 lightLayout,
                               int width, __global float* irradiance, int4 irradianceLayout) {
    const int place = lw_list_index();
    if (place >= state[LW_REPAIR_TAKEN]) return;
    const int row = place / LW_REPAIR_COLUMNS, at = place - row * LW_REPAIR_COLUMNS;
    const int y = pixels[place] / width, x = pixels[place] - y * width;
    for (int a = 0; a < 3; ++a)
        irradiance[irradianceLayout.x + a * irradianceLayout.z + y * irradianceLayout.y + x] =
            light[lightLayout.x + a * lightLayout.z + row * lightLayout.y + at];
}
