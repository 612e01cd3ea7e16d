// Single cones at a view's pixels: along the glossy lobe, along the refracted view direction, and towards a light. Each is a kernel of its
// own, so that what is not asked for costs nothing. docs/techniques/cone_gather.md derives the apertures.
#include "cone_surface.h"
#include "shared/input_limits.h"

// Towards the eye.
LW_FN void towards_eye(real* v, const LwConeView* view, const lw_surface* s) {
    real x = (real)view->eye.x, y = (real)view->eye.y, z = (real)view->eye.z;
    if (view->eye.w > 0.0f) {
        x -= s->px;
        y -= s->py;
        z -= s->pz;
    }
    const real n2 = squared_length(x, y, z), inverse = select_((real)0.0f, rsqrt(n2), n2 > 0.0f);
    v[0] = x * inverse;
    v[1] = y * inverse;
    v[2] = z * inverse;
}

LW_FN real dot_normal(const lw_surface* s, const real* d) { return fma_(s->nx, d[0], fma_(s->ny, d[1], s->nz * d[2])); }

// GGX alpha to half the aperture whose cone has half of its light within the lobe's median angle,
//   1 - cos(a) = 2 (1 - cos(2 atan alpha)) = 4 alpha^2 / (1 + alpha^2),
// as one of the classes: their edges are values of 1 - cos, the first one's at `cones`' weights.
LW_FN lanei class_of(real alpha, __global const LwCone* cones) {
    const real a2 = alpha * alpha, wide = 4.0f * a2 / (1.0f + a2);
    lanei found = (lanei)0;
    for (int k = 0; k + 1 < LW_CONE_APERTURES; ++k)
        found += selecti_((lanei)0, (lanei)1, wide > (real)cones[k].direction.w);
    return found;
}

// One cone of each lane along d, of the lane's class; begun: lanes whose cone begins inside the grid. height: cosine of the direction and
// the surface that it leaves.
LW_FN void trace_classes(cone_light* l, const cone_volume* volumes, const lw_surface* s, const cone_origin* o, mask has, const real* d,
                         real height, real far, lanei kind, __global const LwCone* cones, __global const LwConeStep* steps, const LwConeView* view) {
    l->r = l->g = l->b = l->occluded = (real)0.0f;
    l->through = (real)1.0f;
    const int size = volumes[0].grids.size;
    cone_plane plane;
    plane_of(&plane, s, o, d[0], d[1], d[2], has);
    // Steps are counted from where the cone begins, nudge / cosine off the surface.
    const real begin = view->rough.z / fmax(height, (real)0.1f);
    for (int grid = 0; grid < LW_CONE_CASCADES; ++grid) {
        const mask own = own_lanes(o, grid, size, has);
        if (!any_(own)) continue;
        cone_origin from;
        for (int c = 0; c < LW_CONE_CASCADES; ++c) {
            const real off = begin * ((float)(1 << grid) / (float)(1 << c));
            from.x[c] = fma_(d[0], off, o->x[c]);
            from.y[c] = fma_(d[1], off, o->y[c]);
            from.z[c] = fma_(d[2], off, o->z[c]);
        }
        // Of what is asked for, what lies behind that beginning: a lamp's own wall would shadow it else.
        const real ahead = far - begin * (float)(1 << grid);
        mask left = own;
        while (any_(left)) {
            const int least = mini_lane(selecti_((lanei)LW_CONE_APERTURES, kind, left));
            const mask these = and_(left, kind == (lanei)least);
            const LwCone cone = cones[least];
            march(l, volumes, &from, grid, d[0], d[1], d[2], steps + cone.first, cone.count, view->environment.w, ahead, these, &plane);
            left = and_(left, not_(these));
        }
    }
}

// What a kernel's pixels are, and where their light goes.
LW_FN void store_light(const cone_light* l, mask has, const LwConeView* view, __global float* radiance, int4 layout, int x, int y, int width,
                       __global int* counts) {
    const real none = (real)0.0f, most = (real)LW_LARGEST_IRRADIANCE;
    const real found[3] = {fma_(l->through, (real)view->environment.x, l->r), fma_(l->through, (real)view->environment.y, l->g),
                           fma_(l->through, (real)view->environment.z, l->b)};
    mask saturated = splat_mask(0);
    for (int c = 0; c < 3; ++c) {
        saturated = or_(saturated, not_(found[c] <= most));
        store(select_(none, fmin(found[c], most), has), radiance, layout.x + c * layout.z + y * layout.y + x);
    }
    saturated = and_(and_(saturated, has), lanei_iota() + (lanei)x < (lanei)width);
    if (any_(saturated)) atomic_add(counts + 1, count_(saturated));
}

LW_FN real roughness_of(__global const float* roughness, int4 layout, int hasRoughness, const LwConeView* view, int x, int y) {
    real rough = (real)view->rough.x;
    if (hasRoughness) rough = load(roughness, layout.x + y * layout.y + x);
    const real one = (real)1.0f;
    return select_(one, fmin(fmax(rough, (real)0.0f), one), rough == rough);
}

// One work-item = LW_WIDTH pixels. radiance: 3 planes, W/(sr m^2): of the mirrored direction, bent towards the normal as rough lobes are
// (Lagarde and de Rousiers, Moving Frostbite to PBR, 2014: l = lerp(n, r, (1 - rough)(sqrt(1 - rough) + rough))); refracts: of the refracted one,
// from behind the surface. counts: as cone_gather_trace's.
__kernel void cone_gather_rays(__global const float* position, int4 positionLayout, __global const float* normal, int4 normalLayout,
                               __global const float* roughness, int4 roughnessLayout, int hasRoughness, int refracts, int width, int height,
                               __global const LwGridPlace* places, LwConeGrids grids, __global const int* table, __global const uint* base,
                               __global const uint* mips, __global const LwVoxelState* states, __global const LwCone* cones,
                               __global const LwConeStep* steps, LwConeView view, __global float* radiance, int4 radianceLayout,
                               __global int* counts) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const lw_surface s = load_surface(position, positionLayout, normal, normalLayout, x, y);
    const mask shown = lanei_iota() + (lanei)x < (lanei)width;
    cone_volume volumes[LW_CONE_CASCADES];
    volumes_of(volumes, grids, table, base, mips, states);
    cone_origin o;
    const mask has = and_(origins_of(&o, &s, places, grids.size), shown);
    const mask missing = and_(and_(s.valid, not_(has)), shown), rejected = and_(s.rejected, shown);
    if (any_(rejected)) atomic_add(counts, count_(rejected));
    if (any_(missing)) atomic_add(counts + 2, count_(missing));

    const real one = (real)1.0f, none = (real)0.0f;
    const real rough = roughness_of(roughness, roughnessLayout, hasRoughness, &view, x, y);
    real v[3], d[3];
    towards_eye(v, &view, &s);
    const real nv = dot_normal(&s, v), n[3] = {s.nx, s.ny, s.nz};
    if (refracts) {
        // Snell's law; from inside, where n.v < 0, with the inverse index, and beyond the critical angle mirrored.
        const real side = select_(one, -one, nv < none), cosine = side * nv;
        const real eta = select_((real)(1.0f / view.rough.y), (real)view.rough.y, nv < none);
        const real k = 1.0f - eta * eta * (1.0f - cosine * cosine);
        const mask whole = k < 0.0f;
        const real along = select_(-eta, -one, whole), across = select_(eta * cosine - sqrt(fmax(k, none)), 2.0f * cosine, whole) * side;
        for (int a = 0; a < 3; ++a) d[a] = fma_(along, v[a], across * n[a]);
    } else {
        const real bend = (1.0f - rough) * (sqrt(1.0f - rough) + rough);
        for (int a = 0; a < 3; ++a) d[a] = fma_(bend, 2.0f * nv * n[a] - v[a] - n[a], n[a]);
    }
    const real length2 = squared_length(d[0], d[1], d[2]), inverse = select_(none, rsqrt(length2), length2 > none);
    for (int a = 0; a < 3; ++a) d[a] = select_(n[a], d[a] * inverse, length2 > none);
    cone_light l;
    trace_classes(&l, volumes, &s, &o, has, d, fabs(dot_normal(&s, d)), (real)INFINITY, class_of(rough * rough, cones), cones, steps, &view);
    store_light(&l, has, &view, radiance, radianceLayout, x, y, width, counts);
}

// One work-item = LW_WIDTH pixels. shadow: share of a light that arrives, by one cone towards it; 0 where the surface faces away, 1 where the
// grid has no surface that could know. Opacity alone.
__kernel void cone_gather_shadow(__global const float* position, int4 positionLayout, __global const float* normal, int4 normalLayout,
                                 int width, int height, __global const LwGridPlace* places, LwConeGrids grids, __global const int* table,
                                 __global const uint* base, __global const uint* mips, __global const LwVoxelState* states,
                                 __global const LwCone* cones, __global const LwConeStep* steps, LwConeView view, __global float* shadow,
                                 int4 shadowLayout) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const lw_surface s = load_surface(position, positionLayout, normal, normalLayout, x, y);
    cone_volume volumes[LW_CONE_CASCADES];
    volumes_of(volumes, grids, table, base, mips, states);
    cone_origin o;
    const mask has = origins_of(&o, &s, places, grids.size);
    real d[3] = {(real)view.light.x, (real)view.light.y, (real)view.light.z}, far = (real)INFINITY;
    if (view.light.w > 0.0f) {
        d[0] -= s.px;
        d[1] -= s.py;
        d[2] -= s.pz;
        // In voxels of the finest grid.
        far = sqrt(squared_length(d[0], d[1], d[2])) * places[0].origin.w;
    }
    const real length2 = squared_length(d[0], d[1], d[2]), inverse = select_((real)0.0f, rsqrt(length2), length2 > 0.0f);
    for (int a = 0; a < 3; ++a) d[a] *= inverse;
    const real facing = dot_normal(&s, d), one = (real)1.0f, none = (real)0.0f;
    cone_light l;
    trace_classes(&l, volumes, &s, &o, and_(has, facing > none), d, facing, far, (lanei)0, cones, steps, &view);
    const real open = select_(one, l.through, has);
    store(select_(none, open, and_(s.valid, facing > none)), shadow, shadowLayout.x + y * shadowLayout.y + x);
}
