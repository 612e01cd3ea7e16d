// Temporal history: each pixel's light is the mean over the last frames that saw the same surface,
//   F = c + (I - c) / (n + 1),    c = what the history W(F_prev) holds of the pixel, made to fit the frame (below),
// with n the frames in that mean (Soler et al. 2009 print I_prev for F_prev; the text describes this recursion). So a new
// pixel takes I as it is, a static view is the plain mean of its frames up to `frames`, and an exponential one after.
//
// W looks up the four history pixels around the place where the surface stood, and leaves out those that showed
// another one (position off the tangent plane, another normal). What is left is weighed anew.
//
// Light changes too, so a history is only believed as far as the last few frames allow. Of each surface's light Y (the sum of
// the channels) three more numbers are kept: m, the mean over three frames; b, over four, of Y - m, which is what Y changes by in
// three; and s, the noise that this surface shows from frame to frame: as many frames leave Y within s * light of m + b as twice
// those that leave it farther off against the sign of b. Noise leaps back; light that speeds up does not, and is not
// taken for noise. Frames are counted, not summed, since jumps of the light shall not weigh more than they are many. History is
// brought between the bounds (clamping, Karis 2014)
//   m + 2/3 b -+ gamma / 2 * s * light,
// and forgets where much of it was cut off, where a frame is more than some 5 deviations of Y away, or where b says that light is
// in motion. Bounds from the 3 x 3
// pixels around, the usual choice, do not work here: samples that all pixels share, such as VPLs, move whole
// patches up and down from frame to frame with next to no difference between neighbours, and at the edge of a moving
// shadow neighbours differ by all of its light.
#include "shared/wide.h"
#include "shared/surface.h"
#include "shared/edge_weight.h"
#include "shared/history_types.h"
#include "recent_light.h"
#include "surface_word.h"

#ifndef LW_SCALARS
#define LW_SCALARS 0  // 1-channel images beside the irradiance (validity, ambient occlusion): 0, 1, 2
#endif
#define LW_VALUES (3 + LW_SCALARS)
#define LW_KINDS (1 + LW_SCALARS)  // the irradiance, and each scalar
#define LW_MIXED (LW_VALUES + 3 * LW_KINDS)  // values, m of each kind, s, b
// Planes of a history: the mixed ones, position xyz, and a word of normal and age.
#define LW_POSITION_PLANE LW_MIXED
#define LW_WORD_PLANE (LW_MIXED + 3)

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
// Speed in pixels a frame that halves the mean. Every look-up between pixels blurs a little; a short mean repeats that less
// often, and the eye resolves less in motion. Larger: blur in motion. Smaller: noise in motion.
#define LW_HALVING_SPEED 8.0f

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

// The look-up of LW_WIDTH pixels from (x, y) on. `speed`: pixels of the history since the frame before.
LW_FN lw_past look_up(lw_surface s, mask wanted, int x, int y, int mode, const LwReprojection r,
                      __global const float* motion, int4 motionLayout, __global const float* before, int4 layout,
                      real* speed) {
    lw_past past;
    LW_UNROLL for (int c = 0; c < LW_MIXED; ++c) past.mixed[c] = (real)0.0f;
    past.age = past.learnt = past.weight = *speed = (real)0.0f;
    lanei column = lanei_iota() + (lanei)x, row = (lanei)y;
    real fx = (real)0.0f, fy = (real)0.0f;
    const real ox = s.px - r.origin.x, oy = s.py - r.origin.y, oz = s.pz - r.origin.z;
    const real depth = dot_row(r.depth, ox, oy, oz);
    real tolerance = LW_PLANE_TOLERANCE * r.origin.w * fabs(depth);
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
        const real left = floor(placeX - (0.5f - LW_SNAP)), top = floor(placeY - (0.5f - LW_SNAP));
        fx = placeX - 0.5f - left;
        fy = placeY - 0.5f - top;
        fx = select_((real)0.0f, fx, fx > LW_SNAP);
        fy = select_((real)0.0f, fy, fy > LW_SNAP);
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
    const int firstColumn = mini_lane(selecti_(far, shift, wanted)), firstRow = mini_lane(selecti_(far, row, wanted));
    const int taps = any_(and_(wanted, or_(fx > 0.0f, fy > 0.0f))) ? 4 : 1;
    const int even = firstColumn == maxi_lane(selecti_(-far, shift, wanted)) && firstRow == maxi_lane(selecti_(-far, row, wanted));
    const int rowEnd = (r.width + LW_WIDTH - 1) & ~(LW_WIDTH - 1);  // what blend has written, padding with it
    if (even && firstColumn >= 0 && firstColumn + (taps > 1) + LW_WIDTH <= rowEnd)
        add_taps(&past, s, tolerance, before, layout, r, column, row, fx, fy, wanted, taps, firstColumn, firstRow, 1);
    else
        add_taps(&past, s, tolerance, before, layout, r, column, row, fx, fy, wanted, taps, 0, 0, 0);
    return past;
}

// One work-item = LW_WIDTH adjacent pixels. current: 3 planes of irradiance and LW_SCALARS more. frames: in a mean at
// most, at least 1. gamma: of the bounds; 0: none. before, after: a history's planes (above), of the frame before at its
// size and of this one. counts[0]: surfaces without a history.
__kernel void temporal_history_blend(__global const float* position, int4 positionLayout, __global const float* normal,
                                     int4 normalLayout, int width, int height, __global const float* current,
                                     int4 currentLayout, __global const float* motion, int4 motionLayout, int mode,
                                     LwReprojection r, float frames, float gamma, __global const float* before,
                                     int4 beforeLayout, __global float* after, int4 afterLayout,
                                     __global float* irradiance, int4 irradianceLayout, __global float* first,
                                     int4 firstLayout, __global float* second, int4 secondLayout, __global int* counts) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const lw_surface s = load_surface(position, positionLayout, normal, normalLayout, x, y);
    const mask surface = and_(s.valid, lanei_iota() + (lanei)x < (lanei)width);
    real own[LW_VALUES];
    mask finite = surface;
    const int c0 = currentLayout.x + y * currentLayout.y + x;
    LW_UNROLL for (int c = 0; c < LW_VALUES; ++c) {
        own[c] = load(current, c0 + c * currentLayout.z);
        finite = and_(finite, fabs(own[c]) <= LW_MOST_LIGHT);
    }
    LW_UNROLL for (int c = 0; c < LW_VALUES; ++c) own[c] = select_((real)0.0f, own[c], finite);

    mask known = splat_mask(0), learnt = splat_mask(0);
    real age = (real)0.0f;
    real past[LW_MIXED];
    LW_UNROLL for (int c = 0; c < LW_MIXED; ++c) past[c] = (real)0.0f;
    if (mode != LW_HISTORY_NONE && any_(surface)) {
        real speed;
        const lw_past found = look_up(s, surface, x, y, mode, r, motion, motionLayout, before, beforeLayout, &speed);
        known = and_(surface, found.weight > LW_LEAST_WEIGHT);
        const real scale = select_((real)0.0f, 1.0f / found.weight, known);
        const real most = fmax(frames * LW_HALVING_SPEED / (LW_HALVING_SPEED + speed) - 1.0f, (real)0.0f);
        LW_UNROLL for (int c = 0; c < LW_MIXED; ++c) past[c] = found.mixed[c] * scale;
        age = select_((real)0.0f, fmin(floor(fma_(found.age, scale, (real)0.5f)), most), known);
        learnt = and_(known, or_(found.learnt * scale > 0.5f, age >= LW_LEARNING));
    }
    real share = (real)1.0f, m[LW_KINDS], noise[LW_KINDS], trend[LW_KINDS];
    LW_UNROLL for (int k = 0; k < LW_KINDS; ++k) {
        m[k] = past[LW_VALUES + k];
        noise[k] = past[LW_VALUES + LW_KINDS + k];
        trend[k] = past[LW_VALUES + 2 * LW_KINDS + k];
    }
    if (any_(known)) {
        const mask trusted = and_(splat_mask(gamma > 0.0f), and_(learnt, finite));
        real keep = (real)1.0f;
        LW_UNROLL for (int k = 0; k < LW_KINDS; ++k)
            keep = fmin(keep, follow(past + (k ? k + 2 : 0), own + (k ? k + 2 : 0), k ? 1 : 3, age, (real)gamma, trusted, &m[k], &noise[k], &trend[k]));
        // Where the noise is known half of the light stays what the bounds allow: a frame far off may be the only one such, and
        // would flash.
        age = fmax(age * keep, select_((real)0.0f, fmin(age, (real)1.0f), learnt));
        share = 1.0f / (age + 1.0f);
    }
    // A frame that is no number adds nothing to the history, and nothing comes of it without one.
    const mask follows = and_(known, finite);
    LW_UNROLL for (int k = 0; k < LW_KINDS; ++k) {
        const real whole = k ? own[k + 2] : own[0] + own[1] + own[2];
        m[k] = select_(select_(whole, past[LW_VALUES + k], known), m[k], follows);
        noise[k] = select_(select_((real)LW_FIRST_SPREAD, past[LW_VALUES + LW_KINDS + k], known), noise[k], follows);
        trend[k] = select_((real)0.0f, trend[k], follows);
    }

    const int o = afterLayout.x + y * afterLayout.y + x, plane = afterLayout.z;
    LW_UNROLL for (int c = 0; c < LW_VALUES; ++c) {
        const real mean = select_(own[c], fma_(own[c] - past[c], select_((real)0.0f, share, finite), past[c]), known);
        store(mean, after, o + c * plane);
        if (c < 3) store(mean, irradiance, irradianceLayout.x + c * irradianceLayout.z + y * irradianceLayout.y + x);
        if (c == 3) store(mean, first, firstLayout.x + y * firstLayout.y + x);
        if (c == 4) store(mean, second, secondLayout.x + y * secondLayout.y + x);
    }
    LW_UNROLL for (int k = 0; k < LW_KINDS; ++k) {
        store(m[k], after, o + (LW_VALUES + k) * plane);
        store(noise[k], after, o + (LW_VALUES + LW_KINDS + k) * plane);
        store(trend[k], after, o + (LW_VALUES + 2 * LW_KINDS + k) * plane);
    }
    store(s.px, after, o + LW_POSITION_PLANE * plane);
    store(s.py, after, o + (LW_POSITION_PLANE + 1) * plane);
    store(s.pz, after, o + (LW_POSITION_PLANE + 2) * plane);
    const lanei grown = to_lanei(fmax(age + select_((real)0.0f, (real)1.0f, finite), (real)1.0f) + 0.5f);
    store(pack_word(s.nx, s.ny, s.nz, selecti_((lanei)0, grown, or_(known, finite)), learnt), (__global uint*)after, o + LW_WORD_PLANE * plane);
    const mask fresh = and_(surface, not_(known));
    if (any_(fresh)) atomic_add(counts, count_(fresh));
}

// For debugging, one work-item = LW_WIDTH adjacent pixels: frames in the mean of each, 0 without a surface.
__kernel void temporal_history_age(__global const float* history, int4 layout, int width, int height, __global float* age,
                                   int4 ageLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const laneu word = as_laneu_(loadi((__global const int*)history, layout.x + LW_WORD_PLANE * layout.z + y * layout.y + x));
    store(age_of(word), age, ageLayout.x + y * ageLayout.y + x);
}
