// Surfels of what hosts hand over: their own, texels of reflective shadow maps, pixels of G-buffers. Planes of `surfels` are
// `stride` floats apart. A radius of 0 is no surfel.
#include "shared/paraboloid.h"
#include "shared/rsm_texel.h"
#include "shared/surface.h"
#include "shared/surfel_types.h"

// Cosine up to which neighbouring pixels are one surface, and the share of the way between them by which they may leave each
// other's plane: pixels beyond an edge say nothing about a pixel's area. 30 degrees.
#define LW_SURFEL_SMOOTH 0.5f
// A pixel seen at a grazing angle covers a strip of its surface; a disc of the strip's area reaches far beyond its sides. It
// is taken for at most this many times as long as it is wide. Raised, false shadow beside edges; lowered, gaps along strips.
#define LW_SURFEL_LONGEST 4.0f

LW_FN void store_surfels(lw_surface s, real radius, laneu albedo, __global float* surfels, int stride, int at) {
    store(s.px, surfels, at);
    store(s.py, surfels, at + stride);
    store(s.pz, surfels, at + 2 * stride);
    store(s.nx, surfels, at + 3 * stride);
    store(s.ny, surfels, at + 4 * stride);
    store(s.nz, surfels, at + 5 * stride);
    store(radius, surfels, at + LW_SURFEL_RADIUS * stride);
    store(as_real_(albedo), surfels, at + LW_SURFEL_ALBEDO * stride);
}

LW_FN real radius_of(real area, mask valid) {
    return select_((real)(0.0f), sqrt(select_((real)(0.0f), area, valid) * M_1_PI_F), valid);
}

LW_FN mask is_share(real v) { return and_(v >= 0.0f, v <= 1.0f); }

// One work-item = LW_WIDTH of a host's surfels, in place: area and albedo, as unpacked, become radius and word. Those beyond
// `count` become none.
__kernel void surfel_input_finish(__global float* surfels, int stride, int count, int hasAlbedo, int hasEmission,
                                  volatile __global uint* counters) {
    const int at = (int)get_global_id(0) * LW_WIDTH;
    if (at >= stride) return;
    const mask inside = lanei_iota() + at < count;
    const real unknown = LW_UNKNOWN_ALBEDO;
    const lw_surface s =
        make_surface(load(surfels, at), load(surfels, at + stride), load(surfels, at + 2 * stride),
                     load(surfels, at + 3 * stride), load(surfels, at + 4 * stride), load(surfels, at + 5 * stride));
    const real area = load(surfels, at + LW_SURFEL_RADIUS * stride);
    real r = unknown, g = unknown, b = unknown;
    if (hasAlbedo) {
        r = load(surfels, at + LW_SURFEL_ALBEDO * stride);
        g = load(surfels, at + (LW_SURFEL_ALBEDO + 1) * stride);
        b = load(surfels, at + (LW_SURFEL_ALBEDO + 2) * stride);
    }
    // No larger than the space that positions lie in.
    const mask sized = and_(area > 0.0f, area <= LW_LARGEST_DISTANCE * LW_LARGEST_DISTANCE);
    const mask coloured = and_(is_share(r), and_(is_share(g), is_share(b)));
    const real zero = 0.0f;
    mask emits = splat_mask(1);
    if (hasEmission)
        for (int c = 0; c < 3; ++c) {
            const real v = load(surfels, at + (LW_SURFEL_EMISSION + c) * stride);
            emits = and_(emits, and_(v >= 0.0f, v <= LW_LARGEST_EMISSION));
        }
    const mask valid = and_(and_(and_(inside, s.valid), and_(sized, coloured)), emits);
    const mask rejected = and_(inside, or_(s.rejected, and_(s.valid, not_(valid))));
    if (hasEmission)
        for (int c = 0; c < 3; ++c) {
            const int plane = at + (LW_SURFEL_EMISSION + c) * stride;
            const real v = select_(zero, load(surfels, plane), valid);
            store(v, surfels, plane);
            // Of floats that are not below 0 the bits are ordered as the numbers are.
            const float most = max_lane(v);
            if (most > 0.0f) atomic_max(counters + LW_SURFEL_LARGEST, as_uint(most));
        }
    store_surfels(s, radius_of(area, valid),
                  pack_albedo(select_(zero, r, valid), select_(zero, g, valid), select_(zero, b, valid)), surfels, stride, at);
    if (any_(rejected)) atomic_add(counters + LW_SURFEL_REJECTED, (uint)count_(rejected));
}

// Reflected over incident flux of a texel, or the unknown albedo where the light sends none.
LW_FN real reflectance(real flux, real incident) {
    const mask lit = incident > 0.0f;
    return select_((real)(LW_UNKNOWN_ALBEDO), fmin(flux / select_((real)(1.0f), incident, lit), (real)(1.0f)), lit);
}

// One work-item = LW_WIDTH texels of a row of one RSM; `texels`: LW_RSM_PLANES planes, `texelStride` apart; the texels'
// surfels begin at `first`. Incident flux is E_perp A_p c_l, or I A_p c_l / d^2: see rsm_input_unpack.
__kernel void surfel_input_rsm(__global const float* texels, int texelStride, const LwRsmSpan span,
                               const lw_surfel_light light, __global float* surfels, int stride, int first) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    const int padded = (span.width + 15) & ~15;
    if (x >= padded || y >= span.height) return;
    __global const float* at = texels + span.firstTexel + y * padded + x;
    lw_surface s;
    s.px = load(at, 0);
    s.py = load(at, texelStride);
    s.pz = load(at, 2 * texelStride);
    s.nx = load(at, 3 * texelStride);
    s.ny = load(at, 4 * texelStride);
    s.nz = load(at, 5 * texelStride);
    const real area = load(at, LW_RSM_AREA * texelStride);
    // A coarse texel has no flux where a finer cascade has surfels of its own.
    const mask valid = and_(area > 0.0f, not_(rsm_covered(span, lane_iota() + ((float)x + 0.5f), (real)((float)y + 0.5f))));
    real received;
    if (span.perspective) {
        const real lx = span.light.x - s.px, ly = span.light.y - s.py, lz = span.light.z - s.pz;
        const real d2 = squared_length(lx, ly, lz);
        const real distance = sqrt(select_((real)(1.0f), d2, d2 > 0.0f));
        const real cosine = fma_(s.nx, lx, fma_(s.ny, ly, s.nz * lz)) / distance;
        const real way = -fma_(light.axis.x, lx, fma_(light.axis.y, ly, light.axis.z * lz)) / distance;
        const real ramp = fmin(fmax(fma_(light.coneScale, way, light.coneOffset), 0.0f), 1.0f);
        received = ramp * ramp * area * fmax(cosine, (real)(LW_MIN_LIGHT_COSINE)) / (distance * distance);
    } else {
        const real cosine = fabs(fma_(s.nx, span.light.x, fma_(s.ny, span.light.y, s.nz * span.light.z)));
        received = area * fmax(cosine, (real)(LW_MIN_LIGHT_COSINE));
    }
    const laneu albedo = pack_albedo(reflectance(load(at, LW_RSM_FLUX * texelStride), received * light.emitted.x),
                                     reflectance(load(at, (LW_RSM_FLUX + 1) * texelStride), received * light.emitted.y),
                                     reflectance(load(at, (LW_RSM_FLUX + 2) * texelStride), received * light.emitted.z));
    store_surfels(s, radius_of(area, valid), albedo, surfels, stride, first + y * padded + x);
}

// ---- pixels

LW_FN real gather_plane(__global const float* p, int4 layout, int plane, lanei x, int y) {
    return gather(p + layout.x + plane * layout.z + y * layout.y, x);
}

// The way to the pixel (x, y), and its square; infinite where that is no neighbour on this pixel's surface.
LW_FN real way_to(lw_surface s, __global const float* position, int4 positionLayout, __global const float* normal,
                  int4 normalLayout, lanei x, int y, mask inside, lw_direction* way) {
    way->x = gather_plane(position, positionLayout, 0, x, y) - s.px;
    way->y = gather_plane(position, positionLayout, 1, x, y) - s.py;
    way->z = gather_plane(position, positionLayout, 2, x, y) - s.pz;
    const real nx = gather_plane(normal, normalLayout, 0, x, y), ny = gather_plane(normal, normalLayout, 1, x, y),
               nz = gather_plane(normal, normalLayout, 2, x, y);
    const real length2 = squared_length(way->x, way->y, way->z), n2 = squared_length(nx, ny, nz);
    const real off = fma_(s.nx, way->x, fma_(s.ny, way->y, s.nz * way->z));
    const real agreement = fma_(s.nx, nx, fma_(s.ny, ny, s.nz * nz));
    const mask same = and_(and_(n2 > 0.25f, agreement >= LW_SURFEL_SMOOTH * sqrt(n2)),
                           and_(length2 > 0.0f, off * off <= LW_SURFEL_SMOOTH * LW_SURFEL_SMOOTH * length2));
    return select_((real)(INFINITY), length2, and_(inside, same));
}

// One work-item = LW_WIDTH pixels of a row of a G-buffer. A pixel's area is spanned by the ways to its nearer neighbours in
// its row and its column. A pixel without either, thinner than its surface can be told from others, is no surfel.
__kernel void surfel_input_view(__global const float* position, int4 positionLayout, __global const float* normal,
                                int4 normalLayout, __global const float* albedo, int4 albedoLayout, int hasAlbedo, int width,
                                int height, __global float* surfels, int stride, int first,
                                volatile __global uint* counters) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    const int padded = (width + 15) & ~15;
    if (x >= padded || y >= height) return;
    lw_surface s = load_surface(position, positionLayout, normal, normalLayout, x, y);
    const lanei column = lanei_iota() + x;
    const mask inside = column < width;
    const lanei here = min(column, (lanei)(width - 1));
    const lanei left = max(here - 1, (lanei)(0)), right = min(here + 1, (lanei)(width - 1));
    const int up = max(y - 1, 0), down = min(y + 1, height - 1);
    lw_direction a, b, c, d;
    const real a2 = way_to(s, position, positionLayout, normal, normalLayout, left, y, left != here, &a);
    const real b2 = way_to(s, position, positionLayout, normal, normalLayout, right, y, right != here, &b);
    const real c2 = way_to(s, position, positionLayout, normal, normalLayout, here, up, splat_mask(up != y), &c);
    const real d2 = way_to(s, position, positionLayout, normal, normalLayout, here, down, splat_mask(down != y), &d);
    const mask leftward = a2 < b2, upward = c2 < d2;
    real row2 = fmin(a2, b2), column2 = fmin(c2, d2);
    const real ux = select_(b.x, a.x, leftward), uy = select_(b.y, a.y, leftward), uz = select_(b.z, a.z, leftward);
    const real vx = select_(d.x, c.x, upward), vy = select_(d.y, c.y, upward), vz = select_(d.z, c.z, upward);
    const mask both = and_(row2 < INFINITY, column2 < INFINITY);
    const real least2 = fmin(row2, column2);
    const real spanned = sqrt(squared_length(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx));
    const real area = select_(least2, fmin(spanned, least2 * LW_SURFEL_LONGEST), both);
    const mask valid = and_(and_(inside, s.valid), and_(area > 0.0f, area < INFINITY));
    const real unknown = LW_UNKNOWN_ALBEDO, zero = 0.0f, one = 1.0f;
    real red = unknown, green = unknown, blue = unknown;
    if (hasAlbedo) {
        const int at = albedoLayout.x + y * albedoLayout.y + x;
        // fmax and fmin also take what is not a number for one.
        red = fmin(fmax(load(albedo, at), zero), one);
        green = fmin(fmax(load(albedo, at + albedoLayout.z), zero), one);
        blue = fmin(fmax(load(albedo, at + 2 * albedoLayout.z), zero), one);
    }
    store_surfels(s, radius_of(area, valid), pack_albedo(red, green, blue), surfels, stride, first + y * padded + x);
    const mask rejected = and_(inside, s.rejected);
    if (any_(rejected)) atomic_add(counters + LW_SURFEL_REJECTED, (uint)count_(rejected));
}

// ---- extent

// Whole numbers in the order of the floats, and back.
LW_FN int ordered(float v) { return as_int(v) ^ ((as_int(v) >> 31) & 0x7fffffff); }
LW_FN float unordered(int v) { return as_float(v ^ ((v >> 31) & 0x7fffffff)); }

#define LW_BOUNDS_SURFELS 1024

// One work-item = LW_BOUNDS_SURFELS surfels: the bounds of their centres.
__kernel void surfel_input_bounds(__global const float* surfels, int stride, volatile __global int* counters) {
    const int first = (int)get_global_id(0) * LW_BOUNDS_SURFELS;
    if (first >= stride) return;
    for (int axis = 0; axis < 3; ++axis) {
        real lower = INFINITY, upper = -INFINITY;
        for (int at = first; at < min(first + LW_BOUNDS_SURFELS, stride); at += LW_WIDTH) {
            const mask is = load(surfels, at + LW_SURFEL_RADIUS * stride) > 0.0f;
            const real v = load(surfels, at + axis * stride);
            lower = fmin(lower, select_((real)(INFINITY), v, is));
            upper = fmax(upper, select_((real)(-INFINITY), v, is));
        }
        const float least = min_lane(lower), most = max_lane(upper);
        if (!(least <= most)) continue;
        atomic_min(counters + LW_SURFEL_LOWER + axis, ordered(least));
        atomic_max(counters + LW_SURFEL_UPPER + axis, ordered(most));
    }
}

// One work-item: the bounds' diagonal, 0 without surfels.
__kernel void surfel_input_diagonal(__global const int* counters, __global float* diagonal) {
    if (get_global_id(0) != 0) return;
    float sum = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
        const int lower = counters[LW_SURFEL_LOWER + axis], upper = counters[LW_SURFEL_UPPER + axis];
        const float side = lower <= upper ? unordered(upper) - unordered(lower) : 0.0f;
        sum += side * side;
    }
    *diagonal = sqrt(sum);
}
