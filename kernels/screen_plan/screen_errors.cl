// What technique screen_space would miss with other samples and a coarser start, from what a few receivers and texels have been asked.
#ifndef LW_LEVELS
#define LW_LEVELS 4  // 1 .. 6
#endif
#include "shared/edge_weight.h"
#include "shared/screen_plan_types.h"
#include "shared/wide.h"

// Of the squared error that independent samples would have, what is left by the even spread of the patterns: measured, see
// docs/techniques/screen_space.md. Larger: more samples than the target needs; smaller: it is missed by noise.
#define LW_SCREEN_NOISE 0.3f
// log2(4/3): a disc to 2 r has 4/3 of the texels of the ring from r on. In halvings of samples, between whose losses it lies.
#define LW_SCREEN_DISC_HALVINGS 0.415f
// Outer radius, in texels that are asked, of the smallest ring whose light receivers tell: what the default radius has on 40 rows. Smaller:
// hardly a texel's middle lies in it, and light that is there looks like none.
#define LW_SCREEN_LEAST_RING 2.2f
// Error of what nobody can tell: above any target. Its square is a number that float has.
#define LW_SCREEN_UNTOLD 1e15f

// 1 in lanes whose texel has one of its own surface among the 3 x 3 of a level `shift` steps coarser that it would take its light from.
LW_FN mask has_coarse_texel(__global const float* coarse, int4 layout, int rows, const lw_edges e, lanei x, int y, int shift) {
    mask found = splat_mask(0);
    for (int j = -1; j <= 1; ++j) {
        const int row = (y >> shift) + j;
        if (row < 0 || row >= rows) continue;
        for (int i = -1; i <= 1; ++i) {
            const lanei column = (x >> (lanei)shift) + (lanei)i;  // rows have borders without a surface
            const lanei at = column + (lanei)(layout.x + row * layout.y);
            const real w = edge_weight(e, gather(coarse, at), gather(coarse, at + layout.z), gather(coarse, at + 2 * layout.z),
                                       gather(coarse, at + 3 * layout.z), gather(coarse, at + 4 * layout.z), gather(coarse, at + 5 * layout.z));
            found = or_(found, w > 0.0f);
        }
    }
    return found;
}

// One work-item = LW_WIDTH texels of one of the rows that are asked: every `turns`th, from `turn` on. Levels: the first, and up to two
// coarser ones, of which there are starts - 1. detail: by work-item, how many of its texels have a surface, and how many of those lose it
// by one and by two steps; a byte each.
__kernel void screen_plan_detail(__global const float* level, int4 layout, int width, int height, int4 halfLayout, int4 quarterLayout,
                                 int starts, int turn, int turns, __global int* detail) {
    const int item = (int)get_global_id(0), column = item * LW_WIDTH, asked = turn + (int)get_global_id(1) * turns;
    if (column >= LW_DETAIL_COLUMNS || asked >= LW_DETAIL_ROWS) return;
    const int y = (2 * asked + 1) * height / (2 * LW_DETAIL_ROWS), plane = layout.z;
    const lanei x = (2 * (lanei_iota() + (lanei)column) + 1) * width / (2 * LW_DETAIL_COLUMNS);
    const lanei own = x + (lanei)(layout.x + y * layout.y);
    const lw_surface s = make_surface(gather(level, own), gather(level, own + plane), gather(level, own + 2 * plane),
                                      gather(level, own + 3 * plane), gather(level, own + 4 * plane), gather(level, own + 5 * plane));
    int found = count_(s.valid);
    if (any_(s.valid)) {
        const lw_edges e = edges_of(s, (real)1.0f);
        for (int shift = 1; shift < starts; ++shift) {
            const int rows = (height + (1 << shift) - 1) >> shift;
            const mask has = has_coarse_texel(level, shift == 1 ? halfLayout : quarterLayout, rows, e, x, y, shift);
            found |= count_(and_(s.valid, not_(has))) << (8 * shift);
        }
    }
    detail[asked * (LW_DETAIL_COLUMNS / LW_WIDTH) + item] = found;
}

LW_FN float probed_at(__global const float* probed, int k, int plane, int r) {
    return probed[(k * LW_PROBED_PLANES + plane) * LW_PROBES + r];
}

// What receiver r loses of level k by samples that stand for 2^(halvings + part) times as much.
LW_FN float loss_at(__global const float* probed, int k, int r, int halvings, float part) {
    const int next = min(halvings + 1, LW_PROBED_HALVINGS);
    const float here = halvings == 0 ? 0.0f : probed_at(probed, k, LW_PROBED_LOSS + min(halvings, LW_PROBED_HALVINGS) - 1, r);
    return part > 0.0f ? here + part * (probed_at(probed, k, LW_PROBED_LOSS + next - 1, r) - here) : here;
}

// The same of all that level k takes when the picture starts there: its own ring and what the finer levels would have brought.
LW_FN float disc_loss_at(__global const float* probed, int k, int r, int halvings) {
    float loss = 0.0f;
    for (int finer = 0; finer <= k; ++finer)
        loss += loss_at(probed, finer, r, 2 * (k - finer) + halvings, finer == 0 ? 0.0f : LW_SCREEN_DISC_HALVINGS);
    return loss;
}

// Light of all levels and receivers, in units of the brightest texel of all frames that were asked; writes that, too.
LW_FN float probed_light(__global const float* probed, float* brightest) {
    float most = 0.0f, light = 0.0f;
    for (int row = 0; row < LW_PROBE_ROWS; ++row) most = fmax(most, probed[LW_PROBED_UNITS + row]);
    *brightest = most;
    if (!(most > 0.0f)) return 0.0f;
    for (int row = 0; row < LW_PROBE_ROWS; ++row) {
        float sum = 0.0f;
        for (int k = 0; k < LW_LEVELS; ++k)
            for (int c = 0; c < LW_PROBE_COLUMNS; ++c) sum += probed_at(probed, k, LW_PROBED_LIGHT, row * LW_PROBE_COLUMNS + c);
        light += sum * (probed[LW_PROBED_UNITS + row] / most);
    }
    return light;
}

// Whether the receivers tell the light of level k's ring, and of all that are larger. A disc's is that of all rings in it, so that the finest counts.
LW_FN int is_told(LwScreenRings rings, int k) { return rings.outer2[k] >= squared(LW_SCREEN_LEAST_RING); }

// Sums over receivers: squares of what is lost, by choice; of the level's share; and how much texels differ.
typedef struct { float lost2[LW_SCREEN_CHOICES], share2, spread; } lw_level_sums;

LW_FN void add_receiver(lw_level_sums* sum, __global const float* probed, LwScreenRings rings, int k, int isDisc, int r, float perLight) {
    float light = 0.0f, squares = 0.0f;
    for (int level = isDisc ? 0 : k; level <= k; ++level) {
        light += probed_at(probed, level, LW_PROBED_LIGHT, r) * perLight;
        squares += probed_at(probed, level, LW_PROBED_SQUARES, r) * perLight * perLight;
    }
    for (int c = 0; c <= LW_SCREEN_HALVINGS; ++c)
        sum->lost2[c] += squared((isDisc ? disc_loss_at(probed, k, r, c) : loss_at(probed, k, r, c, 0.0f)) * perLight);
    sum->lost2[LW_SCREEN_CHOICES - 1] += light * light;
    sum->share2 += squared(probed_at(probed, k, LW_PROBED_SHARE, r));
    const float area = isDisc && k > 0 ? rings.area[k] * (4.0f / 3.0f) : rings.area[k];
    sum->spread += fmax(area * squares - light * light, 0.0f);
}

// One work-item = one level of one start. Means over the receivers, and roots of mean squares, relative to the mean of all light.
// samples: the most; patterns: texels with patterns of their own, whose mean the filter takes; wholeDisc, wholeRing: sum of the numbers of
// samples with which the first level's disc and the others' rings are taken whole. errors: LW_ERROR_AT, and behind them all light.
__kernel void screen_plan_errors(__global const float* probed, LwScreenRings rings, int samples, int patterns, int wholeDisc,
                                 int wholeRing, int starts, __global float* errors) {
    const int k = (int)get_global_id(0), start = (int)get_global_id(1);
    if (k >= LW_LEVELS || start >= starts) return;
    float most;
    const float light = probed_light(probed, &most), inverse = light > 0.0f ? (float)LW_PROBES / light : 0.0f, each = 1.0f / LW_PROBES;
    if (k == 0 && start == 0) errors[LW_ERROR_LIGHT] = light;
    lw_level_sums sum = {{0.0f}, 0.0f, 0.0f};
    for (int row = 0; row < LW_PROBE_ROWS && k >= start; ++row) {
        const float perLight = inverse > 0.0f ? inverse * (probed[LW_PROBED_UNITS + row] / most) : 0.0f;
        for (int c = 0; c < LW_PROBE_COLUMNS; ++c) add_receiver(&sum, probed, rings, k, k == start, row * LW_PROBE_COLUMNS + c, perLight);
    }
    for (int c = 0; c < LW_SCREEN_CHOICES; ++c) {
        const int count = c > LW_SCREEN_HALVINGS ? 0 : samples >> c, whole = (k == start ? wholeDisc : wholeRing) & count;
        // Rings that are taken whole have no noise; the most has no error, being what the others are held against.
        const int noisy = count > 0 && !whole && (c > 0 || (start > 0 && k == start));
        errors[LW_ERROR_AT(start, k, LW_ERROR_LOST) + c] = sqrt(sum.lost2[c] * each);
        errors[LW_ERROR_AT(start, k, LW_ERROR_NOISE) + c] = noisy ? LW_SCREEN_NOISE * sum.spread * each / (float)(count * patterns) : 0.0f;
    }
    // Without a level its share of the hemisphere is gone, too, of which validity is made.
    const int none = LW_ERROR_AT(start, k, LW_ERROR_LOST) + LW_SCREEN_CHOICES - 1;
    if (k > start) errors[none] = fmax(errors[none], sqrt(sum.share2 * each));
    // Where the most takes a ring whole, its light is not filtered; that of fewer samples is, and blurred by a filter that with so few texels is
    // about as wide as the ring.
    const int wholeAlready = patterns > 1 ? (k == 0 ? wholeDisc : wholeRing) & samples : 0;
    for (int c = start > 0 && k == start ? 0 : 1; c < LW_SCREEN_CHOICES; ++c) {
        const int count = c > LW_SCREEN_HALVINGS ? 0 : samples >> c, whole = (k == start ? wholeDisc : wholeRing) & count;
        const int isBlurred = wholeAlready && count > 0 && !whole;
        if (most > 0.0f && (isBlurred || !is_told(rings, k == start ? 0 : k)))
            errors[LW_ERROR_AT(start, k, LW_ERROR_LOST) + c] = LW_SCREEN_UNTOLD;
    }
}
