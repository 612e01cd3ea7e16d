// Where a surface stood in a picture kept from the frame before, and what that picture holds of it. Whoever includes this has
// defined the picture's planes: LW_MIXED that are mixed bilinearly, then the position's three from LW_POSITION_PLANE on, and
// LW_WORD_PLANE with the words of surface_word.h.
#ifndef LW_HISTORY_LOOK_UP_H
#define LW_HISTORY_LOOK_UP_H

#include "history_types.h"
#include "surface.h"
#include "surface_word.h"
#include "wide.h"

// Parts of a pixel below which a place counts as a pixel's middle. Larger: a slow pan lags behind by as much in
// every frame of the mean (1/4 pixel in 64 frames). Smaller: rounding of the projection (some 1e-3 pixels at 4096) would
// mix neighbours into a picture at rest, and blur it frame by frame.
#define LW_SNAP (1.0f / 256.0f)
// Least weight of the taps that show the surface. Smaller: noise of one far tap stands for the pixel, with a long past.
#define LW_LEAST_WEIGHT 0.01f
// How far off the tangent plane, in pixels' widths, a tap shows the same surface. Larger: steps as low as that are
// taken for one surface, and light stays behind on what they uncover. Smaller: curved and normal-mapped surfaces lose
// their history in motion, since their normals lean away from the chord between two pixels.
#define LW_PLANE_TOLERANCE 1.0f

typedef struct {
    real mixed[LW_MIXED];
    real age, learnt, weight;
} lw_past;

// One tap for the surface `s` (its place in the frame before). `uniform`, a constant: all lanes' taps lie side by side, from
// `at` on; otherwise each lane's is `index`.
LW_FN void add_tap(lw_past* past, const lw_surface s, real tolerance, __global const float* before, int plane, int at,
                   lanei index, const int uniform, real weight, mask inside) {
#define LW_READ(n) (uniform ? load(before, at + (n) * plane) : gather(before, index + (lanei)((n) * plane)))
    __global const int* words = (__global const int*)before;
    const laneu word = as_laneu_(uniform ? loadi(words, at + LW_WORD_PLANE * plane)
                                         : gatheri(words, index + (lanei)(LW_WORD_PLANE * plane)));
    const real age = age_of(word);
    const real dx = LW_READ(LW_POSITION_PLANE) - s.px, dy = LW_READ(LW_POSITION_PLANE + 1) - s.py,
               dz = LW_READ(LW_POSITION_PLANE + 2) - s.pz;
    const real off = fma_(dx, s.nx, fma_(dy, s.ny, dz * s.nz));
    const mask same = and_(and_(inside, age > 0.0f), and_(fabs(off) <= tolerance, agrees(word, s.nx, s.ny, s.nz)));
    const real w = select_((real)0.0f, weight, same);
    LW_UNROLL for (int c = 0; c < LW_MIXED; ++c)
        past->mixed[c] = fma_(w, select_((real)0.0f, LW_READ(c), same), past->mixed[c]);
    past->age = fma_(w, age, past->age);
    past->learnt = fma_(w, learnt_of(word), past->learnt);
    past->weight += w;
#undef LW_READ
}

// A look-up at (column + fx, row + fy), of `taps` = 1 pixel where both fractions are 0 in all lanes, else of 4.
LW_FN void add_taps(lw_past* past, const lw_surface s, real tolerance, __global const float* before, int4 layout,
                    const LwReprojection r, lanei column, lanei row, real fx, real fy, mask wanted, int taps,
                    int firstColumn, int firstRow, const int uniform) {
    for (int j = 0; j < taps; ++j) {
        const lanei i = column + (lanei)(j & 1), k = row + (lanei)(j >> 1);
        const mask inside = and_(wanted, and_(and_(i >= (lanei)0, i < (lanei)r.width), and_(k >= (lanei)0, k < (lanei)r.height)));
        const real weight = ((j & 1) ? fx : 1.0f - fx) * ((j >> 1) ? fy : 1.0f - fy);
        const int at = layout.x + clamp(firstRow + (j >> 1), 0, r.height - 1) * layout.y + firstColumn + (j & 1);
        const lanei index = (lanei)layout.x + clamp(k, (lanei)0, (lanei)(r.height - 1)) * layout.y + clamp(i, (lanei)0, (lanei)(r.width - 1));
        add_tap(past, s, tolerance, before, layout.z, at, index, uniform, weight, inside);
    }
}

LW_FN real dot_row(float4 row, real x, real y, real z) { return fma_((real)row.x, x, fma_((real)row.y, y, fma_((real)row.z, z, (real)row.w))); }

// The look-up of LW_WIDTH pixels from (x, y) on. `speed`: pixels of the history since the frame before. `rounding`, a constant or one
// for all pixels: 0: bilinear; else one pixel, that at the floor of its coordinate plus this, which is a quarter of the work.
LW_FN lw_past look_up(lw_surface s, mask wanted, int x, int y, int mode, const LwReprojection r,
                      __global const float* motion, int4 motionLayout, __global const float* before, int4 layout,
                      float rounding, real* speed) {
    lw_past past;
    LW_UNROLL for (int c = 0; c < LW_MIXED; ++c) past.mixed[c] = (real)0.0f;
    past.age = past.learnt = past.weight = *speed = (real)0.0f;
    lanei column = lanei_iota() + (lanei)x, row = (lanei)y;
    real fx = (real)0.0f, fy = (real)0.0f;
    const real ox = s.px - r.origin.x, oy = s.py - r.origin.y, oz = s.pz - r.origin.z;
    const real depth = dot_row(r.depth, ox, oy, oz);
    real tolerance = LW_PLANE_TOLERANCE * r.origin.w * fabs(depth);
    // From here on as the history has positions, whose origin may be another.
    s.px = (s.px + r.shiftHigh.x) + r.shiftLow.x;
    s.py = (s.py + r.shiftHigh.y) + r.shiftLow.y;
    s.pz = (s.pz + r.shiftHigh.z) + r.shiftLow.z;
    if (mode >= LW_HISTORY_REPROJECT) {
        const real w = dot_row(r.w, ox, oy, oz), scale = 1.0f / select_((real)1.0f, w, w > 0.0f);
        const real seenX = dot_row(r.x, ox, oy, oz) * scale, seenY = dot_row(r.y, ox, oy, oz) * scale;
        const real ownX = (lane_iota() + ((float)x + 0.5f)) * r.scaleX, ownY = (real)(((float)y + 0.5f) * r.scaleY);
        real placeX = seenX, placeY = seenY;
        if (mode == LW_HISTORY_MOTION) {
            const int m = motionLayout.x + y * motionLayout.y + x;
            placeX = fma_(load(motion, m), (real)r.scaleX, ownX);
            placeY = fma_(load(motion, m + motionLayout.z), (real)r.scaleY, ownY);
            // What moves by itself was elsewhere than the cameras alone say, and how much nearer or farther no motion vector
            // tells: by as much as it went across, at most.
            const real ax = (placeX - seenX) * depth, ay = (placeY - seenY) * depth;
            const real mx = fma_(ax, (real)r.acrossX.x, ay * r.acrossY.x), my = fma_(ax, (real)r.acrossX.y, ay * r.acrossY.y),
                       mz = fma_(ax, (real)r.acrossX.z, ay * r.acrossY.z);
            s.px += mx;
            s.py += my;
            s.pz += mz;
            tolerance += sqrt(squared_length(mx, my, mz));
        }
        // Far enough beyond the picture's edge for no tap to be inside; NaN is not wanted.
        const mask near = and_(and_(placeX > -1.0f, placeX < (float)r.width + 1.0f), and_(placeY > -1.0f, placeY < (float)r.height + 1.0f));
        wanted = and_(wanted, and_(near, w > 0.0f));
        placeX = select_(ownX, placeX, wanted);
        placeY = select_(ownY, placeY, wanted);
        *speed = fmax(fabs(placeX - ownX), fabs(placeY - ownY));
        const float shift = rounding > 0.0f ? 0.5f - rounding : 0.5f - LW_SNAP;
        const real left = floor(placeX - shift), top = floor(placeY - shift);
        if (rounding == 0.0f) {
            fx = placeX - 0.5f - left;
            fy = placeY - 0.5f - top;
            fx = select_((real)0.0f, fx, fx > LW_SNAP);
            fy = select_((real)0.0f, fy, fy > LW_SNAP);
        }
        column = to_lanei(left);
        row = to_lanei(top);
    }
    if (!any_(wanted)) return past;
    // At rest, which is told without looking across lanes.
    const mask moved = or_(or_(column != lanei_iota() + (lanei)x, row != (lanei)y), or_(fx > 0.0f, fy > 0.0f));
    if (!any_(and_(wanted, moved)) && y < r.height && x < r.width) {
        add_taps(&past, s, tolerance, before, layout, r, column, row, fx, fy, wanted, 1, x, y, 1);
        return past;
    }
    const lanei shift = column - lanei_iota(), far = (lanei)(1 << 30);
    const int taps = any_(and_(wanted, or_(fx > 0.0f, fy > 0.0f))) ? 4 : 1;
    // As a rule all go as far as the first lane: one look across lanes tells, where the ends of all take four.
    int firstColumn = firsti_lane(shift), firstRow = firsti_lane(row);
    int even = !any_(and_(wanted, or_(shift != (lanei)firstColumn, row != (lanei)firstRow)));
    if (!even) {
        firstColumn = mini_lane(selecti_(far, shift, wanted));
        firstRow = mini_lane(selecti_(far, row, wanted));
        even = firstColumn == maxi_lane(selecti_(-far, shift, wanted)) && firstRow == maxi_lane(selecti_(-far, row, wanted));
    }
    const int rowEnd = (r.width + LW_WIDTH - 1) & ~(LW_WIDTH - 1);  // what blend has written, padding with it
    if (even && firstColumn >= 0 && firstColumn + (taps > 1) + LW_WIDTH <= rowEnd)
        add_taps(&past, s, tolerance, before, layout, r, column, row, fx, fy, wanted, taps, firstColumn, firstRow, 1);
    else
        add_taps(&past, s, tolerance, before, layout, r, column, row, fx, fy, wanted, taps, 0, 0, 0);
    return past;
}

#endif
