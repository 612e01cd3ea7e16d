// Surfels into a map's records, in three sweeps that do the same but for what they do with a hit: the first leaves the
// least distance in each texel, the second the least normal (as the packed word) among the hits at that distance, the third
// the least albedo among those of that normal. All are integer minima over the surfels' own values, so the records depend
// neither on who comes first nor on where a surfel stands in its array.
//
// A texel's ray is intersected with the disc: the distance is that of the disc's plane, not of its centre.
#ifndef LW_SURFEL_SPLAT_H
#define LW_SURFEL_SPLAT_H

#include "shared/paraboloid_box.h"
#include "shared/paraboloid_map_types.h"
#include "shared/surfel_types.h"

#define LW_DEPTH 0
#define LW_NORMAL 1
#define LW_ALBEDO 2

// Texels of a disc's box up to which a batch of surfels is drawn at once, a texel of each; above it, a surfel's texels
// LW_WIDTH at once.
#define LW_FEW_TEXELS 16

// Radius over that of a disc of the surfel's area. Discs of equal areas leave gaps: none on a square lattice from 1.26
// (sqrt(pi / 2)) on; at 1.35 less than 4 % of a wall that surfel_sampling covers, 13 % where its triangles are as small as the
// discs. Raised, discs reach farther over edges and off curved surfaces (false shadow: on Crytek Sponza with 32 maps of 128^2
// the light was 45 % short at 1.5, 35 % at 1.26, 21 % at 1 with smaller least radii); lowered, more is seen through them.
#define LW_SURFEL_OVERLAP 1.35f

// Least radius as seen from the map, in texels: a far surfel smaller than that would fall between the texels' centres, and
// what lies behind it would be seen. 0.71: a disc that faces the map holds a centre wherever it lies.
#define LW_SURFEL_TEXELS 0.71f

// A surfel nearer than this many of its radii is left out: it is the surface that the map looks from, whose discs, tilted as
// RSM texels and curved surfaces have them, would stand before the origin. Raised, small things beside a cluster cast no
// shadow; lowered, clusters on curved surfaces shadow themselves.
#define LW_SURFEL_NEAREST 2.0f

typedef struct {
    lw_paraboloid frame;
    volatile __global uint* records;
    volatile __global uint* albedo;
    int size, first;  // first: record of the map
    float step;
} lw_canvas;

// Discs in the map's frame, one a lane.
typedef struct {
    lw_direction centre, normal;
    real offset;   // normal.x = offset on its plane
    real radius2;  // squared
} lw_disc;

// A batch of surfels as a map sees them.
typedef struct {
    lw_disc disc;
    lw_texel_box box;  // .any: drawn
    laneu normal, albedo;  // words of its texels
} lw_splats;

// Where the rays of texels (x, y) meet discs: the distance, 0 for those that miss. Either side counts.
LW_FN real disc_distance(float step, lw_disc d, lanei x, lanei y) {
    const real u = paraboloid_uv(to_real(x), step), v = paraboloid_uv(to_real(y), step);
    const real r2 = u * u + v * v;
    const lw_direction ray = paraboloid_ray(u, v);
    const real along = d.offset / dot_(d.normal, ray);
    const lw_direction hit = {along * ray.x, along * ray.y, along * ray.z};
    const lw_direction off = minus_(hit, d.centre);
    const real distance = along * (1.0f + r2);
    // Not a number where the ray lies in the disc's plane.
    const mask met = and_(and_(distance > 0.0f, distance < INFINITY),
                          and_(dot_(off, off) <= d.radius2, r2 <= LW_PARABOLOID_RIM * LW_PARABOLOID_RIM));
    return select_((real)(0.0f), distance, met);
}

// A word of a surfel's position, one for every map: which share of the surfels a map takes depends on them alone.
LW_FN laneu surfel_hash(real x, real y, real z, int map) {
    laneu h = (laneu)(0x9e3779b9u * (uint)(map + 1));
    const laneu bits[3] = {as_laneu_(x), as_laneu_(y), as_laneu_(z)};
    // Without the rotations of Murmur's rounds, which become an instruction that Oclgrind lacks.
    for (int i = 0; i < 3; ++i) {
        h = (h ^ bits[i]) * 0xcc9e2d51u;
        h = (h ^ (h >> 15)) * 0x1b873593u;
    }
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    return h ^ (h >> 16);
}

// Surfels `first`, `first + 1`, ... as seen from the map. `threshold`: of their hash, up to which the map takes them;
// `scale`: of their radii, for those that it does not take.
LW_FN lw_splats load_splats(lw_canvas c, __global const float* surfels, int stride, int first, int map, uint threshold,
                            float scale) {
    lw_splats s;
    const real px = load(surfels, first), py = load(surfels, first + stride), pz = load(surfels, first + 2 * stride);
    const real radius = load(surfels, first + LW_SURFEL_RADIUS * stride);
    mask taken = radius > 0.0f;
    if (threshold != 0xffffffffu) taken = and_(taken, surfel_hash(px, py, pz, map) <= threshold);
    s.box.any = taken;
    if (!any_(taken)) return s;

    const lw_direction world = {px - c.frame.origin.x, py - c.frame.origin.y, pz - c.frame.origin.z};
    s.disc.centre = to_frame(c.frame, world);
    const real distance = sqrt(dot_(s.disc.centre, s.disc.centre));
    const real own = radius * scale;
    const mask apart = distance > own * LW_SURFEL_NEAREST;
    const real inverse = 1.0f / select_((real)(1.0f), distance, apart);
    const lw_direction axis = {s.disc.centre.x * inverse, s.disc.centre.y * inverse, s.disc.centre.z * inverse};
    // The angle of a texel: 2 step / (1 + r^2), and 1 + r^2 = 2 / (1 + cos).
    const real texel = distance * c.step * (1.0f + axis.z);
    const real drawn = fmax(own * LW_SURFEL_OVERLAP, texel * LW_SURFEL_TEXELS);
    const real sine = fmin(drawn * inverse * 1.0001f, 1.0f);
    s.box = box_of_cap(axis, sqrt(fmax(1.0f - sine * sine, 0.0f)), sine, c.size);
    s.box.any = and_(s.box.any, and_(taken, apart));
    if (!any_(s.box.any)) return s;

    const lw_direction n = {load(surfels, first + 3 * stride), load(surfels, first + 4 * stride),
                            load(surfels, first + 5 * stride)};
    s.disc.normal = to_frame(c.frame, n);
    s.disc.offset = dot_(s.disc.normal, s.disc.centre);
    s.disc.radius2 = drawn * drawn;
    // Against the rays that meet it.
    const real turn = select_((real)(1.0f), (real)(-1.0f), s.disc.offset > 0.0f);
    const real most = 1.0f;
    s.normal = pack_normal(fmax(fmin(s.disc.normal.x * turn, most), -most), fmax(fmin(s.disc.normal.y * turn, most), -most),
                           fmax(fmin(s.disc.normal.z * turn, most), -most));
    s.albedo = as_laneu_(load(surfels, first + LW_SURFEL_ALBEDO * stride));
    return s;
}

// One hit. 1: it may be the nearest. The distance is tested before the atomic, which costs ten times as much and mostly
// changes nothing; a value read too early is only too large.
LW_FN int touch(lw_canvas c, int texel, float distance, uint normal, uint albedo, const int sweep) {
    volatile __global uint* record = c.records + 2 * (c.first + texel);
    const uint bits = as_uint(distance), nearest = record[0];
    if (sweep == LW_DEPTH) {
        if (bits < nearest) atomic_min(record, bits);
        return bits <= nearest;
    }
    if (bits != nearest) return 0;
    if (sweep == LW_NORMAL) {
        if (normal < record[1]) atomic_min(record + 1, normal);
    } else if (normal == record[1]) {
        atomic_min(c.albedo + c.first + texel, albedo);
    }
    return 0;
}

// Words of a batch's surfels, by lane.
typedef struct {
    uint normal[LW_WIDTH], albedo[LW_WIDTH];
} lw_words;

// In every step one texel of each surfel. Bit l of the result: touch() of lane l.
LW_FN uint draw_few(lw_canvas c, lw_splats s, mask live, const lw_words* words, const int sweep) {
    uint reached = 0;
    lanei x = s.box.x0, y = s.box.y0;
    do {
        const real distance = select_((real)(0.0f), disc_distance(c.step, s.disc, x, y), live);
        if (any_(distance > 0.0f)) {
            float distances[LW_WIDTH];
            int texels[LW_WIDTH];
            store(distance, distances, 0);
            store(y * c.size + x, texels, 0);
            for (int l = 0; l < LW_WIDTH; ++l)
                if (distances[l] > 0.0f)
                    reached |= (uint)touch(c, texels[l], distances[l], words->normal[l], words->albedo[l], sweep) << l;
        }
        x = x + 1;
        const mask next = x > s.box.x1;
        x = selecti_(x, s.box.x0, next);
        y = selecti_(y, y + 1, next);
        live = and_(live, y <= s.box.y1);
    } while (any_(live));
    return reached;
}

// One surfel, the same in every lane: row by row, LW_WIDTH texels at a time. 1: a texel was reached.
LW_FN uint draw_rows(lw_canvas c, lw_disc disc, int x0, int x1, int y0, int y1, uint normal, uint albedo, const int sweep) {
    int reached = 0;
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; x += LW_WIDTH) {
            // A row's last texels instead of the next row's first: drawn twice, they stay the same.
            const int start = min(x, c.size - LW_WIDTH);
            const real distance = disc_distance(c.step, disc, lanei_iota() + start, (lanei)(y));
            if (!any_(distance > 0.0f)) continue;
            float distances[LW_WIDTH];
            store(distance, distances, 0);
            for (int l = 0; l < LW_WIDTH; ++l)
                if (distances[l] > 0.0f) reached |= touch(c, y * c.size + start + l, distances[l], normal, albedo, sweep);
        }
    return (uint)reached;
}

// The surfels of a batch that need rows, lane by lane.
LW_FN uint draw_many(lw_canvas c, lw_splats s, mask many, const lw_words* words, const int sweep) {
    int wanted[LW_WIDTH], x0[LW_WIDTH], x1[LW_WIDTH], y0[LW_WIDTH], y1[LW_WIDTH];
    float v[8][LW_WIDTH];
    store(many, wanted, 0);
    store(s.box.x0, x0, 0);
    store(s.box.x1, x1, 0);
    store(s.box.y0, y0, 0);
    store(s.box.y1, y1, 0);
    store(s.disc.centre.x, v[0], 0);
    store(s.disc.centre.y, v[1], 0);
    store(s.disc.centre.z, v[2], 0);
    store(s.disc.normal.x, v[3], 0);
    store(s.disc.normal.y, v[4], 0);
    store(s.disc.normal.z, v[5], 0);
    store(s.disc.offset, v[6], 0);
    store(s.disc.radius2, v[7], 0);
    uint reached = 0;
    for (int l = 0; l < LW_WIDTH; ++l) {
        if (!wanted[l]) continue;
        lw_disc d;
        d.centre.x = v[0][l];
        d.centre.y = v[1][l];
        d.centre.z = v[2][l];
        d.normal.x = v[3][l];
        d.normal.y = v[4][l];
        d.normal.z = v[5][l];
        d.offset = v[6][l];
        d.radius2 = v[7][l];
        reached |= draw_rows(c, d, x0[l], x1[l], y0[l], y1[l], words->normal[l], words->albedo[l], sweep) << l;
    }
    return reached;
}

// LW_WIDTH surfels from `first` on, those of `which` (a bit each): the bits of those that reached a texel.
LW_FN uint draw_batch(lw_canvas c, __global const float* surfels, int stride, int first, uint which, int map, uint threshold,
                      float scale, const int sweep) {
    const lw_splats s = load_splats(c, surfels, stride, first, map, threshold, scale);
    const mask drawn = and_(s.box.any, to_mask(((lanei)((int)which) >> lanei_iota()) & 1));
    if (!any_(drawn)) return 0;
    lw_words words;
    store(s.normal, words.normal, 0);
    store(s.albedo, words.albedo, 0);
    const lanei texels = (s.box.x1 - s.box.x0 + 1) * (s.box.y1 - s.box.y0 + 1);
    const mask few = and_(drawn, texels <= LW_FEW_TEXELS), many = and_(drawn, texels > LW_FEW_TEXELS);
    uint reached = 0;
    if (any_(few)) reached |= draw_few(c, s, few, &words, sweep);
    if (any_(many)) reached |= draw_many(c, s, many, &words, sweep);
    return reached;
}

#endif
