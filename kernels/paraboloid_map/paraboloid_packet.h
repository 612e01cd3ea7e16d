// The rays of a block of neighbouring texels, one a lane, and the frustum around them: what lies outside no ray meets.
#ifndef LW_PARABOLOID_PACKET_H
#define LW_PARABOLOID_PACKET_H

#include "paraboloid_hit.h"
#include "shared/paraboloid_map_types.h"

#define LW_BLOCK_COLUMNS LW_BLOCK_COLUMNS_OF(LW_WIDTH)
#define LW_BLOCK_ROWS (LW_WIDTH / LW_BLOCK_COLUMNS)

// By how much the frustum is wider than its rays, as a slope, and off its planes, as a share of the coordinates: a hundred
// times the rounding of a ray, ten times that of a coordinate. Lowered, what a ray just meets is lost.
#define LW_FRUSTUM_MARGIN 2e-5f
#define LW_FRUSTUM_ROUNDING 1e-6f

typedef struct {
    lw_direction ray;  // axes of the world, of this length
    real length;
    real cosine;    // to the frustum's axis
    mask inside;    // before the rim
    float4 axis;    // unit
    float4 side[4];  // inward normals
} lw_packet;

LW_FN real along_(float4 axis, lw_direction v) { return fma_(axis.x, v.x, fma_(axis.y, v.y, axis.z * v.z)); }

// Written in place: Oclgrind does not know what clang leaves where a structure that is returned stays in memory.
LW_FN void set_packet(lw_packet* p, lw_paraboloid frame, float step, lanei x, lanei y, float middleX, float middleY) {
    const real u = paraboloid_uv(to_real(x), step), v = paraboloid_uv(to_real(y), step), r2 = u * u + v * v;
    p->ray = world_ray(frame, u, v);
    p->length = 1.0f + r2;
    p->inside = r2 <= LW_PARABOLOID_RIM * LW_PARABOLOID_RIM;
    const float mu = (middleX + 0.5f) * step - LW_PARABOLOID_RIM, mv = (middleY + 0.5f) * step - LW_PARABOLOID_RIM;
    const float scale = 1.0f / (1.0f + mu * mu + mv * mv);
    p->axis = (2.0f * mu * scale) * frame.axisX + (2.0f * mv * scale) * frame.axisY +
              ((1.0f - mu * mu - mv * mv) * scale) * frame.axisZ;
    p->axis.w = 0.0f;
    p->axis = p->axis * rsqrt(dot(p->axis, p->axis));
    float4 across[2];
    paraboloid_axes(p->axis, &across[0], &across[1]);
    const real depth = along_(p->axis, p->ray), inverse = 1.0f / depth;
    p->cosine = depth / p->length;
    for (int i = 0; i < 2; ++i) {
        const real slope = along_(across[i], p->ray) * inverse;
        p->side[2 * i] = across[i] - (min_lane(slope) - LW_FRUSTUM_MARGIN) * p->axis;
        p->side[2 * i + 1] = (max_lane(slope) + LW_FRUSTUM_MARGIN) * p->axis - across[i];
    }
}

// Boxes of centres `c` and half extents `h`, one a lane: those that reach into the frustum, and how far along its axis
// they begin.
LW_FN mask boxes_inside(const lw_packet* p, lw_direction c, lw_direction h, real* nearest) {
    mask inside = h.x >= 0.0f;
    for (int i = 0; i < 4; ++i) inside = and_(inside, along_(p->side[i], c) + along_(fabs(p->side[i]), h) >= 0.0f);
    const real middle = along_(p->axis, c), half_ = along_(fabs(p->axis), h);
    *nearest = fmax(middle - half_, 0.0f);
    return and_(inside, middle + half_ >= 0.0f);
}

// How far a box may begin behind the hits: rounding of hits on planes seen edge-on.
#define LW_LIMIT_MARGIN 1.0001f

// Which children of a node reach into the frustum no farther along its axis than `limit`, a bit each, and where they begin.
LW_FN uint children_inside(const lw_packet* p, __global const float* node, float4 origin, float limit, float* begins) {
    uint reached = 0;
    for (int i = 0; i < LW_TREE_CHILDREN; i += LW_WIDTH) {
        const lw_direction c = {load(node, i) - origin.x, load(node, i + 16) - origin.y, load(node, i + 32) - origin.z};
        const lw_direction h = {load(node, LW_TREE_HALF + i), load(node, LW_TREE_HALF + i + 16),
                                load(node, LW_TREE_HALF + i + 32)};
        real nearest;
        const mask inside = boxes_inside(p, c, h, &nearest);
        reached |= bits_(and_(inside, nearest <= limit)) << i;
        store(nearest, begins, i);
    }
    return reached;
}

LW_FN mask some_beyond(float4 axis, lw_corners t, real least) {
    return or_(or_(along_(axis, t.a) >= least, along_(axis, t.b) >= least), along_(axis, t.c) >= least);
}
LW_FN real size_of(lw_direction v) { return fabs(v.x) + fabs(v.y) + fabs(v.z); }

// Triangles, one a lane, that may reach into the frustum.
LW_FN mask triangles_inside(const lw_packet* p, lw_corners t) {
    const real least = -LW_FRUSTUM_ROUNDING * (size_of(t.a) + size_of(t.b) + size_of(t.c));
    mask inside = some_beyond(p->axis, t, least);
    for (int i = 0; i < 4; ++i) inside = and_(inside, some_beyond(p->side[i], t, least));
    return inside;
}

#endif
