// Horizon gather: what a pixel sees of its own view, slice by slice with a visibility bitmask (Therrien et al. 2023), the
// sectors of which have equal measure. One pass gives ambient occlusion, the light of one bounce and the share of the
// hemisphere that it came from. Steps grow with the distance and look at coarser and coarser levels of a mip pyramid.
// LW_LIGHT 1: light, validity and ambient occlusion; 0: ambient occlusion alone. LW_UNIFORM: as in horizon_arc.h.
#ifndef LW_LIGHT
#define LW_LIGHT 1
#endif
#ifndef LW_UNIFORM
#define LW_UNIFORM 0
#endif
#include "horizon_arc.h"
#include "horizon_fetch.h"

// A step lies above the receiver's plane when its direction leaves it by more than this sine. Smaller: neighbours on the
// same curved or coarsely meshed surface shadow it. Larger: shallow creases lose their shadow.
#define LW_ABOVE_PLANE 0.01f
// What a step shows is extended to both sides in its own plane, to at most 1 / LW_EXTENSION times its depth. Larger:
// surfaces seen at grazing angles fall into pieces with gaps between the steps. Smaller: a normal that leans away from the
// surface throws up a wall.
#define LW_EXTENSION 0.25f
// Least cosine between the view and the normal of what a step shows, for the same reason.
#define LW_LEAST_VIEW_COSINE 0.02f

typedef struct {
    real r, g, b, seen;  // weighted: radiance and share of sectors
    laneu covered, near;
} lw_found;

typedef struct {
    real px, py, pz, nx, ny, nz, vx, vy, vz;
    real inverseDepth;   // along the camera's axis
    real slant;          // distance from the eye over depth; 1 without perspective
    real range2;         // squared radius of ambient occlusion
} lw_receiver;

// A side of a slice.
typedef struct {
    float lx, ly, lz;     // world vector of the line, per pixel
    real along, across;   // its part along V and its length across V, over the receiver's slant
    lw_measure measure;
} lw_side;

// From the receiver to the point that a step shows.
typedef struct {
    real dx, dy, dz, squared;
    mask above;  // the receiver's plane
} lw_way;

// What a step shows from its nearest to its farthest point in angle from V, unnormalised, and how much farther along the
// view its back lies.
typedef struct {
    real firstX, firstY, lastX, lastY, behindX, behindY;
    real towards;  // negative: its front faces the receiver
    mask shown;    // a surface at all
} lw_piece;

LW_FN lw_way way_to(const lw_place* at, const lw_receiver* p) {
    real qx, qy, qz;
    take(at, 0, &qx, &qy, &qz);
    lw_way way;
    way.dx = qx - p->px;
    way.dy = qy - p->py;
    way.dz = qz - p->pz;
    way.squared = squared_length(way.dx, way.dy, way.dz);
    const real up = fma_(way.dx, p->nx, fma_(way.dy, p->ny, way.dz * p->nz));
    way.above = and_(at->inside, and_(up > 0.0f, up * up > LW_ABOVE_PLANE * LW_ABOVE_PLANE * way.squared));
    return way;
}

// In the slice, with V as one axis and the line across it as the other, the plane of what is seen at a step runs between
// the rays at step.begin and step.end; directions to both ends need no length, so no division is left:
//   perspective  depth of the plane at distance s:  z_q m / (m - (s - s_q) n.l),  m = -n.ray
//   end          p + slant V (1 - z / z_p) + z s l,  all over z_p slant and times the denominator
// docs/techniques/horizon.md derives it. The back lies `thickness` farther along the rays of the front.
LW_FN lw_piece cut(const lw_place* at, const lw_way* way, const lw_receiver* p, const lw_side* side, const lw_horizon_step* step,
                   const lw_horizon_view* view) {
    real nx, ny, nz;
    take(at, 3, &nx, &ny, &nz);
    const real facingEye = fma_(p->vx, nx, fma_(p->vy, ny, p->vz * nz));
    const real tilt = fma_((real)side->lx, nx, fma_((real)side->ly, ny, side->lz * nz));
    lw_piece piece;
    piece.towards = fma_(way->dx, nx, fma_(way->dy, ny, way->dz * nz));
    const int perspective = view->eye.w != 0.0f;
    real beginX, endX, scale;
    if (perspective) {
        const real deeper = fma_(way->dx, (real)view->axis.x, fma_(way->dy, (real)view->axis.y, way->dz * view->axis.z));
        const real ratio = fma_(deeper, p->inverseDepth, (real)1.0f);
        const real own = p->slant * facingEye, seenCosine = fma_(-piece.towards, p->inverseDepth, own);
        const real m = larger(seenCosine, LW_LEAST_VIEW_COSINE * ratio);
        const real turn = tilt * ratio, least = LW_EXTENSION * m, start = fma_(own, ratio, m - seenCosine);
        scale = m * ratio;
        const real begin = larger(fma_((real)-step->begin, turn, start), least);
        const real end = larger(fma_((real)-step->end, turn, start), least);
        const real along = scale * side->along;
        beginX = fma_((real)step->begin, along, begin - scale);
        endX = fma_((real)step->end, along, end - scale);
        piece.shown = seenCosine != 0.0f;
    } else {
        scale = larger(facingEye, (real)LW_LEAST_VIEW_COSINE);
        const real along = fma_(scale - facingEye, fma_(way->dx, p->vx, fma_(way->dy, p->vy, way->dz * p->vz)), piece.towards);
        beginX = fma_((real)-step->begin, tilt, along);
        endX = fma_((real)-step->end, tilt, along);
        piece.shown = facingEye != 0.0f;
    }
    // Which end is farther from V follows from cotangents alone: both lie at positive distances.
    const mask beginLast = beginX * step->end < endX * step->begin;
    const real across = scale * side->across, back = -view->perI.w * scale;
    const real firstS = select_((real)step->begin, (real)step->end, beginLast), lastS = select_((real)step->end, (real)step->begin, beginLast);
    piece.firstX = select_(beginX, endX, beginLast);
    piece.lastX = select_(endX, beginX, beginLast);
    piece.firstY = across * firstS;
    piece.lastY = across * lastS;
    piece.behindX = fma_(back, perspective ? fma_(-lastS, side->along, (real)1.0f) : (real)1.0f, piece.lastX);
    piece.behindY = perspective ? piece.lastY * (1.0f + view->perI.w) : piece.lastY;
    return piece;
}

// One step. Most of a picture's steps lie below the plane or in covered sectors of all lanes: they end early.
LW_FN void look(lw_found* found, const lw_place* at, const lw_receiver* p, const lw_side* side, const lw_horizon_step* step,
                const lw_horizon_view* view) {
    const lw_way way = way_to(at, p);
    if (!any_(way.above)) return;
    const lw_piece piece = cut(at, &way, p, side, step, view);
    const lanei from = border_of(&side->measure, piece.firstX, piece.firstY);
    const lanei to = border_of(&side->measure, piece.behindX, piece.behindY);
    const laneu bits = selectu_((laneu)0u, sectors_between(from, to), and_(way.above, piece.shown));
    found->near |= selectu_((laneu)0u, bits, way.squared < p->range2);
#if LW_LIGHT
    const laneu lit = selectu_((laneu)0u, bits & ~found->covered, piece.towards < 0.0f);
    found->covered |= bits;
    if (!any_(to_mask(lit))) return;
    const real share = count_sectors(lit);
    real r, g, b;
    take(at, 6, &r, &g, &b);
    found->r = fma_(share, r, found->r);
    found->g = fma_(share, g, found->g);
    found->b = fma_(share, b, found->b);
    found->seen += share;
#endif
}

LW_FN lw_receiver receiver_of(real px, real py, real pz, real nx, real ny, real nz, mask valid, const lw_horizon_view view) {
    const int perspective = view.eye.w != 0.0f;
    lw_receiver p = {px, py, pz, nx, ny, nz};
    // Background stands anywhere before the eye, so that no lane computes with NaN.
    const real wx = select_((real)-view.axis.x, view.eye.x - px, valid);
    const real wy = select_((real)-view.axis.y, view.eye.y - py, valid);
    const real wz = select_((real)-view.axis.z, view.eye.z - pz, valid);
    const real distance = sqrt(squared_length(wx, wy, wz)), inverse = 1.0f / distance;
    // The sign of an orthographic camera's axis is not known: its surfaces face it.
    const real along = fma_(nx, (real)view.axis.x, fma_(ny, (real)view.axis.y, nz * view.axis.z));
    const real towards = select_((real)-1.0f, (real)1.0f, along > 0.0f);
    p.vx = perspective ? wx * inverse : towards * view.axis.x;
    p.vy = perspective ? wy * inverse : towards * view.axis.y;
    p.vz = perspective ? wz * inverse : towards * view.axis.z;
    const real depth = fma_(-wx, (real)view.axis.x, fma_(-wy, (real)view.axis.y, -wz * view.axis.z));
    p.inverseDepth = 1.0f / depth;
    p.slant = perspective ? distance * p.inverseDepth : (real)1.0f;
    p.range2 = sq(view.axis.w * (perspective ? depth * view.perJ.w : (real)view.perJ.w));
    return p;
}

LW_FN float3 crossed(float4 a, float4 b) {
    return (float3)(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

// One work-item = LW_WIDTH adjacent pixels of a row of the pyramid's first level here (layout, width, height). slices:
// row y looks at those congruent to y modulo view.rows. gathered: weighted sums, which the filter divides by the weight;
// planes: with LW_LIGHT radiance (3) and seen share, in both the open share within the radius, last the weight.
__kernel void horizon_gather_gather(__global const float* pyramid, int4 layout, int width, int height,
                                    __global const lw_horizon_slice* slices, __global const lw_horizon_step* steps,
                                    lw_horizon_view view, __global float* gathered, int4 gatheredLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    __global const float* self = pyramid + layout.x + y * layout.y + x;
    const real nx = load(self, 3 * layout.z), ny = load(self, 4 * layout.z), nz = load(self, 5 * layout.z);
    const mask valid = squared_length(nx, ny, nz) > 0.25f;
    const real zero = (real)0.0f;
    real sumR = zero, sumG = zero, sumB = zero, sumSeen = zero, sumOpen = zero, sumWeight = zero;
    const int slice0 = (y + view.turn) % view.rows;
    const int sliceCount = any_(valid) ? view.slices : 0;
    const lw_receiver p = receiver_of(load(self, 0), load(self, layout.z), load(self, 2 * layout.z), nx, ny, nz, valid, view);
    const real perSlant = 1.0f / p.slant;
    const float3 across = crossed(view.perI, view.perJ);
    const real crossSection = fabs(fma_(p.vx, (real)across.x, fma_(p.vy, (real)across.y, p.vz * across.z)));
    const lanei at = lanei_iota() + (lanei)x;
    // lw_horizon_column, lw_horizon_row, and a turn of both
    const lanei columnShift = (((at + (lanei)(3 * view.turn)) & (lanei)7) << 1) - (lanei)7;
    const lanei rowShift = (((at * 3 + (lanei)(5 * (y + view.turn) + (view.turn >> 3))) & (lanei)7) << 1) - (lanei)7;
    for (int i = 0; i < sliceCount; ++i) {
        const lw_horizon_slice slice = slices[slice0 + i * view.rows];
        const float lx = slice.dx * view.perI.x + slice.dy * view.perJ.x;
        const float ly = slice.dx * view.perI.y + slice.dy * view.perJ.y;
        const float lz = slice.dx * view.perI.z + slice.dy * view.perJ.z;
        const lw_arc arc = make_arc(p.nx, p.ny, p.nz, p.vx, p.vy, p.vz, lx, ly, lz, crossSection, slice.share);
        const float turned = slice.rounding + view.rounding, rounding = turned < 0.95f ? turned : turned - 0.9f;
        lw_found found = {zero, zero, zero, zero, (laneu)0u, (laneu)0u};
        for (int against = 0; against < 2; ++against) {
            const float sign = against ? -1.0f : 1.0f;
            const lw_side side = {sign * lx, sign * ly, sign * lz, sign * arc.along * perSlant, arc.across * perSlant,
                                  measure_of(arc, sign, rounding)};
            for (int k = 0; k < slice.steps; ++k) {
                const lw_horizon_step step = steps[slice.first[against] + k];
                lw_place at;
                const int inside = step.level < LW_HORIZON_BLEND
                                       ? place_fine(&at, pyramid, &step, x, y)
                                       : place_coarse(&at, pyramid, &step, x, y, columnShift, rowShift, width, height);
                if (inside) look(&found, &at, &p, &side, &step, &view);
            }
        }
        const real weight = arc.weight;
        const real sector = weight * (1.0f / LW_HORIZON_SECTORS);
        sumR = fma_(sector, found.r, sumR);
        sumG = fma_(sector, found.g, sumG);
        sumB = fma_(sector, found.b, sumB);
        sumSeen = fma_(sector, found.seen, sumSeen);
        sumOpen = fma_(sector, LW_HORIZON_SECTORS - count_sectors(found.near), sumOpen);
        sumWeight += weight;
    }
    int out = gatheredLayout.x + y * gatheredLayout.y + x;
    const int plane = gatheredLayout.z;
#if LW_LIGHT
    store(select_(zero, sumR, valid), gathered, out);
    store(select_(zero, sumG, valid), gathered, out + plane);
    store(select_(zero, sumB, valid), gathered, out + 2 * plane);
    store(select_(zero, sumSeen, valid), gathered, out + 3 * plane);
    out += 4 * plane;
#endif
    store(select_(zero, sumOpen, valid), gathered, out);
    store(select_(zero, sumWeight, valid), gathered, out + plane);
}
