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
    real depth, inverseDepth;  // along the camera's axis
    real slant;                // distance from the eye over depth
    real range2;               // squared radius of ambient occlusion
} lw_receiver;

// A side of a slice.
typedef struct {
    float lx, ly, lz;  // world vector of the line, per pixel
    real along;        // its part along V
    real horizon;      // cosine of the angle at which the side leaves the hemisphere
    lw_measure measure;
    float sign;        // 1 along the line, -1 against it
} lw_side;

LW_FN lanei border_of(real sectors, float side, real middle, float rounding) {
    const real border = fma_((real)side, sectors, middle) + rounding;
    return to_lanei(smaller(larger(border, (real)0.0f), (real)LW_HORIZON_SECTORS));
}

// What a step shows from its nearest to its farthest point in angle from V, unnormalised: the point's part along V and
// the distance on the line that it stands at.
typedef struct { real firstX, firstS, lastX, lastS, across, back; } lw_piece;

// In the slice, with V as one axis and the line across it as the other, the plane of what is seen at a step runs between
// the rays at step.begin and step.end; directions to both ends need no length, so no division is left:
//   perspective  depth of the plane at distance s:  z_q m / (m - (s - s_q) n.l),  m = -n.ray
//   end          p + slant V (1 - z / z_p) + z s l,  all over z_p and times the denominator
// across: what the distance on the line is multiplied with to be the part across V; back: what the back lies farther
// along the view. docs/techniques/horizon.md derives it.
LW_FN void cut(lw_piece* piece, const lw_seen* s, real dx, real dy, real dz, real towards, const lw_receiver* p,
               const lw_arc* arc, const lw_side* side, const lw_horizon_step* step, const lw_horizon_view* view) {
    const real facingEye = fma_(p->vx, s->nx, fma_(p->vy, s->ny, p->vz * s->nz));
    const real tilt = fma_((real)side->lx, s->nx, fma_((real)side->ly, s->ny, side->lz * s->nz));
    real beginX, endX, scale;
    if (view->eye.w != 0.0f) {
        const real deeper = fma_(dx, (real)view->axis.x, fma_(dy, (real)view->axis.y, dz * view->axis.z));
        const real ratio = fma_(deeper, p->inverseDepth, (real)1.0f);
        const real own = p->slant * facingEye, seenCosine = fma_(-towards, p->inverseDepth, own);
        const real m = larger(seenCosine, LW_LEAST_VIEW_COSINE * ratio);
        const real turn = tilt * ratio, least = LW_EXTENSION * m, start = fma_(own, ratio, m - seenCosine);
        scale = m * ratio;
        const real begin = larger(fma_((real)-step->begin, turn, start), least);
        const real end = larger(fma_((real)-step->end, turn, start), least);
        beginX = fma_(p->slant, begin - scale, scale * (step->begin * side->along));
        endX = fma_(p->slant, end - scale, scale * (step->end * side->along));
    } else {
        scale = larger(facingEye, (real)LW_LEAST_VIEW_COSINE);
        const real along = fma_(scale - facingEye, fma_(dx, p->vx, fma_(dy, p->vy, dz * p->vz)), towards);
        beginX = fma_((real)-step->begin, tilt, along);
        endX = fma_((real)-step->end, tilt, along);
    }
    // Which end is farther from V follows from cotangents alone: both lie at positive distances.
    const mask beginLast = beginX * step->end < endX * step->begin;
    piece->firstX = select_(beginX, endX, beginLast);
    piece->lastX = select_(endX, beginX, beginLast);
    piece->firstS = select_((real)step->begin, (real)step->end, beginLast);
    piece->lastS = select_((real)step->end, (real)step->begin, beginLast);
    piece->across = scale * arc->across;
    piece->back = -view->perI.w * scale;
}

// One step. The back lies `thickness` farther along the rays of the front.
LW_FN void look(lw_found* found, const lw_seen* s, const lw_receiver* p, const lw_arc* arc, const lw_side* side,
                const lw_horizon_step* step, const lw_horizon_view* view, float rounding) {
    const real dx = s->px - p->px, dy = s->py - p->py, dz = s->pz - p->pz;
    const real d2 = squared_length(dx, dy, dz);
    const real up = fma_(dx, p->nx, fma_(dy, p->ny, dz * p->nz));
    const real towards = fma_(dx, s->nx, fma_(dy, s->ny, dz * s->nz));
    lw_piece piece;
    cut(&piece, s, dx, dy, dz, towards, p, arc, side, step, view);
    const real firstY = piece.across * piece.firstS, lastY = piece.across * piece.lastS;
    const int perspective = view->eye.w != 0.0f;
    const real behindX = fma_(piece.back, perspective ? fma_(-piece.lastS, side->along, p->slant) : (real)1.0f, piece.lastX);
    const real behindY = perspective ? lastY * (1.0f + view->perI.w) : lastY;
    const real front = piece.firstX * inverse_root(fma_(piece.firstX, piece.firstX, firstY * firstY));
    const real back = behindX * inverse_root(fma_(behindX, behindX, behindY * behindY));
    const real highest = smaller(larger(front, side->horizon), (real)1.0f);
    const real lowest = smaller(larger(back, side->horizon), highest);
    const lanei from = border_of(sectors_to(side->measure, highest), side->sign, arc->middle, rounding);
    const lanei to = border_of(sectors_to(side->measure, lowest), side->sign, arc->middle, rounding);
    const mask seen = and_(and_(s->inside, squared_length(s->nx, s->ny, s->nz) > 0.25f),
                           and_(up > 0.0f, up * up > LW_ABOVE_PLANE * LW_ABOVE_PLANE * d2));
    const laneu bits = selectu_((laneu)0u, sectors_below(from) ^ sectors_below(to), seen);
    found->near |= selectu_((laneu)0u, bits, d2 < p->range2);
#if LW_LIGHT
    const real share = select_((real)0.0f, count_sectors(bits & ~found->covered), towards < 0.0f);
    found->r = fma_(share, s->r, found->r);
    found->g = fma_(share, s->g, found->g);
    found->b = fma_(share, s->b, found->b);
    found->seen += share;
    found->covered |= bits;
#endif
}

LW_FN lw_receiver receiver_of(const lw_seen s, const lw_horizon_view view) {
    lw_receiver p;
    p.px = s.px;
    p.py = s.py;
    p.pz = s.pz;
    p.nx = s.nx;
    p.ny = s.ny;
    p.nz = s.nz;
    const int perspective = view.eye.w != 0.0f;
    const real wx = view.eye.x - s.px, wy = view.eye.y - s.py, wz = view.eye.z - s.pz;
    const real distance = sqrt(squared_length(wx, wy, wz)), inverse = 1.0f / distance;
    // The sign of an orthographic camera's axis is not known: its surfaces face it.
    const real along = fma_(s.nx, (real)view.axis.x, fma_(s.ny, (real)view.axis.y, s.nz * view.axis.z));
    const real towards = select_((real)-1.0f, (real)1.0f, along > 0.0f);
    p.vx = perspective ? wx * inverse : towards * view.axis.x;
    p.vy = perspective ? wy * inverse : towards * view.axis.y;
    p.vz = perspective ? wz * inverse : towards * view.axis.z;
    const real depth = fma_(-wx, (real)view.axis.x, fma_(-wy, (real)view.axis.y, -wz * view.axis.z));
    p.depth = depth;
    p.inverseDepth = 1.0f / depth;
    p.slant = distance * p.inverseDepth;
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
    lw_seen self;
    fetch(&self, pyramid + layout.x + y * layout.y + x, layout.z, 0, 0);
    const mask valid = squared_length(self.nx, self.ny, self.nz) > 0.25f;
    const real zero = (real)0.0f;
    real sumR = zero, sumG = zero, sumB = zero, sumSeen = zero, sumOpen = zero, sumWeight = zero;
    const int slice0 = (y + view.turn) % view.rows;
    const int sliceCount = any_(valid) ? view.slices : 0;
    const lw_receiver p = receiver_of(self, view);
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
            lw_side side;
            side.sign = against ? -1.0f : 1.0f;
            side.lx = side.sign * lx;
            side.ly = side.sign * ly;
            side.lz = side.sign * lz;
            side.along = side.sign * arc.along;
            side.horizon = horizon_of(side.sign * arc.sine);
            side.measure = measure_of(arc, side.sign * arc.sine);
            for (int k = 0; k < slice.steps; ++k) {
                const lw_horizon_step step = steps[slice.first[against] + k];
                const int start = x + step.phaseX, level = step.level;
                lw_seen s;
                if (level < LW_HORIZON_BLEND) {
                    const int row = ((y + step.phaseY) >> level) + step.dy, column = (start >> level) + step.dx;
                    const int phase = start & ((1 << level) - 1);
                    if (row < 0 || row >= step.rows || column >= step.columns || column + ((LW_WIDTH - 1 + phase) >> level) < 0)
                        continue;
                    fetch(&s, pyramid + step.first + row * step.rowStride + column, step.planeStride, level, phase);
                } else {
                    const int most = 4 << (level - LW_HORIZON_BLEND);
                    const int row = ((y + step.phaseY - most) >> level) + step.dy, column = ((start - most) >> level) + step.dx;
                    if (row < -1 || row >= step.rows || column >= step.columns ||
                        ((start + LW_WIDTH - 1 + most) >> level) + step.dx < 0)
                        continue;
                    fetch_blended(&s, pyramid + step.first, &step, start, y + step.phaseY, columnShift, rowShift, column, row, width, height);
                }
                look(&found, &s, &p, &arc, &side, &step, &view, rounding);
            }
        }
        const real weight = arc.weight;
        const real sector = weight * (1.0f / LW_HORIZON_SECTORS);
        sumR = fma_(sector, found.r, sumR);
        sumG = fma_(sector, found.g, sumG);
        sumB = fma_(sector, found.b, sumB);
        sumSeen = fma_(sector, found.seen, sumSeen);
        sumOpen = fma_(sector, count_sectors(~found.near), sumOpen);
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
