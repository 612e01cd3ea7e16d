// Light that arrives at surfaces along their glossy lobes, by marching the cells of a light propagation volume (after Kaplanyan and
// Dachsbacher 2010, who march the grid along the mirrored ray). Here in absolute units, through what surfaces in the cells send:
// a cell's flux Phi, spread over its depth s, adds to a ray of direction r
//   dL = I(-r) / s^3 dt,
// and a wall of exitance M, whose cells have M s^2 each and are s / |n.r| deep along the ray, M / pi at any angle and distance.
// docs/techniques/lpv_specular.md has the derivation.
//
// One sample a plane of cells across the axis that the ray runs along most, interpolated between four cells: between planes there is
// nothing to interpolate, and a wall across the ray is in one plane or the next, whole. Then what closes the way to that plane's
// nearest cell. A wall's light goes before what blocks behind it.
//
// A lobe is that of the GGX distribution of normals (Walter et al. 2007) for alpha = roughness^2, drawn at a fixed set of points and
// weighted by n.l (Karis, Real Shading in Unreal Engine 4, 2013). Each ray widens to its share of directions, 1 / (rays * density)
// (Krivanek and Colbert, Real-time Shading with Filtered Importance Sampling, 2008), which chooses the level of cells.
#include "shared/input_limits.h"
#include "shared/lpv_specular_types.h"
#include "shared/lpv_types.h"
#include "shared/surface.h"
#include "shared/wide.h"

// Points of the lobe: u / (1 - u) of u = (i + 1/2) / 8, cos and sin of 2 pi times i with its bits reversed, over 8 (Hammersley's).
__constant float kTangents[LW_SPECULAR_RAYS] = {
    0.0666666667f, 0.2307692308f, 0.4545454545f, 0.7777777778f, 1.2857142857f, 2.2f, 4.3333333333f, 15.0f};
__constant float kCosines[LW_SPECULAR_RAYS] = {
    1.0f, -1.0f, 0.0f, 0.0f, 0.7071067812f, -0.7071067812f, -0.7071067812f, 0.7071067812f};
__constant float kSines[LW_SPECULAR_RAYS] = {
    0.0f, 0.0f, 1.0f, -1.0f, 0.7071067812f, -0.7071067812f, 0.7071067812f, -0.7071067812f};

typedef struct {
    __global const float16* cells;
    __global const float4* ways;
    int size, levels, hasFaces;
    float4 environment;
} specular_grid;

LW_FN float along_axis(float4 way, int axis) { return axis == 0 ? way.x : axis == 1 ? way.y : way.z; }

// What gets from one cell into the next along an axis. Faces are of the finest cells alone: a cell's lower one, so that a way down is
// closed by the cell it leaves. isCoarse, wasCoarse: of the cells on both sides.
LW_FN float passes(float4 from, float4 to, int axis, int isUp, int hasFaces, int wasCoarse, int isCoarse) {
    if (!hasFaces || isUp) return 1.0f - along_axis(to, axis);
    return (wasCoarse ? 1.0f : 1.0f - along_axis(from, axis)) * (isCoarse ? 1.0f - along_axis(to, axis) : 1.0f);
}

// What surfaces of a cell send against direction d: all of one normal n Phi / pi max(0, -n.d), exactly; of several the mean normal's
// share as if it were one, the rest evenly. (Two bands of harmonics would send 0.75 of a wall's light straight on.)
LW_FN float4 sent_against(float16 cell, float dx, float dy, float dz) {
    const float4 x = cell.s4567, y = cell.s89ab, z = cell.scdef;
    const float4 length_ = sqrt(x * x + y * y + z * z);
    return fmax(-(x * dx + y * dy + z * dz), 0.0f) + 0.25f * fmax(cell.s0123 - length_, 0.0f);
}

// The nearest cell across a ray, and the mean of the four around it.
LW_FN int nearest(float p, float inverse, int n) { return clamp((int)(p * inverse), 0, n - 1); }

LW_FN float16 mean_of_four(__global const float16* plane, int n, float pu, float pv, int toU, int toV) {
    const float border = (float)(n - 1), xu = clamp(pu - 0.5f, 0.0f, border), xv = clamp(pv - 0.5f, 0.0f, border);
    const int iu = min((int)xu, n - 2), iv = min((int)xv, n - 2);
    const float fu = xu - (float)iu, fv = xv - (float)iv;
    __global const float16* corner = plane + iu * toU + iv * toV;
    return (1.0f - fv) * ((1.0f - fu) * corner[0] + fu * corner[toU]) + fv * ((1.0f - fu) * corner[toV] + fu * corner[toU + toV]);
}

// Where a ray is: in plane k of a level, counted along the ray's main axis a; its nearest cell in the plane before, (lu, lv).
typedef struct {
    __global const float16* cells;  // the level's
    __global const float4* ways;
    int n, level, k, lu, lv, toA, toU, toV;
    float scale, inverse, through;
} specular_place;

LW_FN void set_steps(specular_place* s, int a, int u, int v) {
    s->toA = a == 0 ? 1 : a == 1 ? s->n : s->n * s->n;
    s->toU = u == 0 ? 1 : s->n;
    s->toV = v == 2 ? s->n * s->n : s->n;
}

// On to the next level. What closes the way to the other half of the coarser cell, aside, is left behind: it counts now.
LW_FN void coarsen(specular_place* s, const float* d, int a, int u, int v, int hasFaces) {
    if (s->k > 0) {
        const int along = d[a] > 0.0f ? s->k - 1 : s->n - s->k, isCoarse = s->level > 0;
        __global const float4* here = s->ways + along * s->toA + s->lu * s->toU + s->lv * s->toV;
        if ((s->lu & 1) == (d[u] < 0.0f))
            s->through *= passes(here[0], here[d[u] < 0.0f ? -s->toU : s->toU], u, d[u] > 0.0f, hasFaces, isCoarse, isCoarse);
        if ((s->lv & 1) == (d[v] < 0.0f))
            s->through *= passes(here[0], here[d[v] < 0.0f ? -s->toV : s->toV], v, d[v] > 0.0f, hasFaces, isCoarse, isCoarse);
    }
    const int count = s->n * s->n * s->n;
    s->cells += count;
    s->ways += count;
    s->n /= 2;
    s->k /= 2;
    s->lu /= 2;
    s->lv /= 2;
    s->scale *= 2.0f;
    s->inverse *= 0.5f;
    ++s->level;
    set_steps(s, a, u, v);
}

// Planes that a ray leaps over from one whose nearest cell has nothing nearer than `distance`; not beyond one that a coarser level may
// begin at.
LW_FN int leap(const specular_place* s, float distance, float start, float widening, int hasNext) {
    const int empty = (int)distance - 1;
    if (empty < 1 || !hasNext || !(widening > 0.0f)) return empty;
    const float next = (s->scale / widening + start) * s->inverse - (float)s->k;
    return next < 1.0f ? 1 : min(empty, (int)fmin(next, LW_SPECULAR_FAR));
}

// Radiance along one ray that starts at `at`, in cells from the grid's corner, and widens by `tangent`.
LW_FN float4 march(const specular_grid grid, const float* at, const float* d, float tangent) {
    const float ax = fabs(d[0]), ay = fabs(d[1]), az = fabs(d[2]), most = (float)grid.size;
    const int a = ax >= ay && ax >= az ? 0 : ay >= az ? 1 : 2, u = a == 0 ? 1 : 0, v = a == 2 ? 1 : 2, up = d[a] > 0.0f;
    const float slope = 1.0f / fabs(d[a]), start = up ? at[a] : most - at[a], su = d[u] * slope, sv = d[v] * slope;
    specular_place s = {grid.cells, grid.ways, grid.size, 0, clamp((int)start, 0, grid.size - 1), nearest(at[u], 1.0f, grid.size),
                        nearest(at[v], 1.0f, grid.size), 0, 0, 0, 1.0f, 1.0f, 1.0f};
    set_steps(&s, a, u, v);
    float4 light = (float4)(0.0f), last = s.ways[(up ? s.k : s.n - 1 - s.k) * s.toA + s.lu * s.toU + s.lv * s.toV];
    int lastLevel = 0, isEntered = (float)s.k + 0.5f < start;
    for (s.k += isEntered; s.k < s.n; isEntered = 1) {
        while (s.level + 1 < grid.levels && (s.k & 1) == 0 && tangent * ((float)s.k * s.scale - start) * slope >= s.scale)
            coarsen(&s, d, a, u, v, grid.hasFaces);
        const float along = ((float)s.k + 0.5f) * s.scale - start, pu = at[u] + su * along, pv = at[v] + sv * along;
        if (!(pu >= 0.0f && pu <= most && pv >= 0.0f && pv <= most)) break;
        const int plane = (up ? s.k : s.n - 1 - s.k) * s.toA, nu = nearest(pu, s.inverse, s.n), nv = nearest(pv, s.inverse, s.n);
        const float4 own = s.ways[plane + nu * s.toU + nv * s.toV];
        const int empty = leap(&s, own.w, start, tangent * slope, s.level + 1 < grid.levels);
        if (empty > 0) {
            const float behind = along + (float)(empty - 1) * s.scale;
            s.lu = nearest(at[u] + su * behind, s.inverse, s.n);
            s.lv = nearest(at[v] + sv * behind, s.inverse, s.n);
            last = (float4)(0.0f);
            lastLevel = s.level;
            s.k += empty;
            continue;
        }
        const float16 mean = mean_of_four(s.cells + plane, s.n, pu * s.inverse, pv * s.inverse, s.toU, s.toV);
        if (fmax(fmax(mean.s0, mean.s1), mean.s2) > 0.0f)
            light += s.through * s.scale * slope * sent_against(mean, d[0], d[1], d[2]);
        // To the nearest cell along one axis after the other: where two walls meet there is no way between them. Without branches,
        // which nobody could foresee.
        const int isCoarse = s.level > 0;
        const float4 ahead = s.ways[plane + s.lu * s.toU + s.lv * s.toV], aside = s.ways[plane + nu * s.toU + s.lv * s.toV];
        const float alongA = passes(last, ahead, a, up, grid.hasFaces, lastLevel > 0, isCoarse),
                    alongU = passes(ahead, aside, u, nu > s.lu, grid.hasFaces, isCoarse, isCoarse),
                    alongV = passes(aside, own, v, nv > s.lv, grid.hasFaces, isCoarse, isCoarse);
        s.through *= (isEntered ? alongA : 1.0f) * (nu != s.lu ? alongU : 1.0f) * (nv != s.lv ? alongV : 1.0f);
        if (s.through < LW_SPECULAR_LEAST) return light;
        last = own;
        lastLevel = s.level;
        s.lu = nu;
        s.lv = nv;
        ++s.k;
    }
    return light + s.through * grid.environment;
}

// The mean over the lobe. n, v: unit; v . n > 0.
LW_FN float4 lobe_mean(const specular_grid grid, const float* at, const float* n, const float* v, float roughness) {
    const float alpha = roughness * roughness, square = alpha * alpha;
    const float nv = n[0] * v[0] + n[1] * v[1] + n[2] * v[2];
    if (roughness <= LW_SPECULAR_ONE_RAY) {
        const float d[3] = {2.0f * nv * n[0] - v[0], 2.0f * nv * n[1] - v[1], 2.0f * nv * n[2] - v[2]};
        return march(grid, at, d, 2.0f * alpha * sqrt(nv));
    }
    // Across the normal: towards the eye, and aside; the lobe is the same on both sides of the two.
    float t[3] = {v[0] - nv * n[0], v[1] - nv * n[1], v[2] - nv * n[2]};
    float length_ = t[0] * t[0] + t[1] * t[1] + t[2] * t[2];
    if (length_ < 1e-6f) {  // straight on any will do
        const int flat = fabs(n[0]) < 0.6f;
        t[0] = flat ? 1.0f - n[0] * n[0] : -n[1] * n[0];
        t[1] = flat ? -n[0] * n[1] : 1.0f - n[1] * n[1];
        t[2] = flat ? -n[0] * n[2] : -n[1] * n[2];
        length_ = t[0] * t[0] + t[1] * t[1] + t[2] * t[2];
    }
    const float unit = rsqrt(length_);
    for (int i = 0; i < 3; ++i) t[i] *= unit;
    const float b[3] = {n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]};
    float4 sum = (float4)(0.0f);
    float weights = 0.0f;
    for (int i = 0; i < LW_SPECULAR_RAYS; ++i) {
        const float tangent2 = square * kTangents[i], cosine = rsqrt(1.0f + tangent2), sine = sqrt(tangent2) * cosine;
        const float x = sine * kCosines[i], y = sine * kSines[i];
        const float h[3] = {x * t[0] + y * b[0] + cosine * n[0], x * t[1] + y * b[1] + cosine * n[1],
                            x * t[2] + y * b[2] + cosine * n[2]};
        const float hv = h[0] * v[0] + h[1] * v[1] + h[2] * v[2];
        const float d[3] = {2.0f * hv * h[0] - v[0], 2.0f * hv * h[1] - v[1], 2.0f * hv * h[2] - v[2]};
        const float weight = d[0] * n[0] + d[1] * n[1] + d[2] * n[2];
        if (!(weight > 0.0f && hv > 0.0f)) continue;
        // Density of l: alpha^2 cos / (pi (cos^2 (alpha^2 - 1) + 1)^2) / (4 v.h); a cone of tangent t has pi t^2 of directions.
        const float spread = cosine * cosine * (square - 1.0f) + 1.0f;
        const float share = 4.0f * hv * spread * spread / (LW_SPECULAR_RAYS * square * cosine);
        sum += weight * march(grid, at, d, LW_SPECULAR_WIDTH * sqrt(share));
        weights += weight;
    }
    return weights > 0.0f ? sum / weights : sum;
}

// One work-item = a pixel of half resolution: the roughness of the surface that was taken of its 2 x 2.
__kernel void lpv_specular_pick(__global const float* position, int4 positionLayout, __global const float* roughness,
                                int4 roughnessLayout, int width, int height, __global const float* halfPosition, int4 halfLayout,
                                __global float* half_, int4 halfRoughnessLayout) {
    const int hx = (int)get_global_id(0), hy = (int)get_global_id(1);
    if (hx >= (width + 1) / 2 || hy >= (height + 1) / 2) return;
    __global const float* taken = halfPosition + halfLayout.x + hy * halfLayout.y + hx;
    float found = 0.0f;
    for (int i = 0; i < 4; ++i) {
        const int x = min(2 * hx + (i & 1), width - 1), y = min(2 * hy + (i >> 1), height - 1);
        __global const float* p = position + positionLayout.x + y * positionLayout.y + x;
        if (p[0] == taken[0] && p[positionLayout.z] == taken[halfLayout.z] && p[2 * positionLayout.z] == taken[2 * halfLayout.z])
            found = roughness[roughnessLayout.x + y * roughnessLayout.y + x];
    }
    half_[halfRoughnessLayout.x + hy * halfRoughnessLayout.y + hx] = found;
}

typedef struct { real x, y, z; } specular_directions;

// Unit vectors towards the eye, on the visible side also where a normal leans away from it.
LW_FN specular_directions towards_eye(const LwSpecularRays view, const lw_surface s) {
    const real one = (real)1.0f, none = (real)0.0f;
    specular_directions v = {view.eye.x - s.px * view.eye.w, view.eye.y - s.py * view.eye.w, view.eye.z - s.pz * view.eye.w};
    const real squared = squared_length(v.x, v.y, v.z), inverse = rsqrt(fmax(squared, (real)1e-30f));
    const mask some = squared > 1e-30f;  // an eye in the surface itself looks straight on
    v.x = select_(s.nx, v.x * inverse, some);
    v.y = select_(s.ny, v.y * inverse, some);
    v.z = select_(s.nz, v.z * inverse, some);
    const real nv = fma_(v.x, s.nx, fma_(v.y, s.ny, v.z * s.nz));
    // Of an orthographic camera the way back is known as well; else the part along the normal turns.
    const real turn = view.eye.w > 0.0f ? one : select_(one, -one, nv < 0.0f);
    const real behind = view.eye.w > 0.0f ? fmin(nv, none) * 2.0f : none;
    v.x = turn * v.x - behind * s.nx;
    v.y = turn * v.y - behind * s.ny;
    v.z = turn * v.z - behind * s.nz;
    return v;
}

// One work-item = LW_WIDTH pixels of a row. roughness: where hasRoughness. hasFaces: the cells' ways are closed by faces (see
// lpv_specular_pack_steps). counts[0]: pixels that are neither surface nor background; counts[1]: whose light was brought down;
// counts[2]: surfaces that the grid does not have; counts[3]: surfaces.
__kernel void lpv_specular_march(__global const float* position, int4 positionLayout, __global const float* normal,
                                 int4 normalLayout, __global const float* roughness, int4 roughnessLayout, int hasRoughness, int width,
                                 int height, LwSpecularRays view, __global const LwLpvPlace* place_, int size, int hasFaces,
                                 __global const float16* cells, __global const float4* ways, __global float* radiance, int4 radianceLayout,
                                 __global int* counts) {
    const int x = (int)get_global_id(0) * LW_WIDTH, y = (int)get_global_id(1);
    if (x >= width || y >= height) return;
    const LwLpvPlace place = *place_;
    const lw_surface s = load_surface(position, positionLayout, normal, normalLayout, x, y);
    const mask shown = lanei_iota() + x < width;
    const float inverse = place.origin.w, most = (float)size;
    const real gx = fma_(s.nx, (real)LW_SPECULAR_START, (s.px - place.origin.x) * inverse);
    const real gy = fma_(s.ny, (real)LW_SPECULAR_START, (s.py - place.origin.y) * inverse);
    const real gz = fma_(s.nz, (real)LW_SPECULAR_START, (s.pz - place.origin.z) * inverse);
    const mask within = and_(and_(and_(gx >= 0.0f, gx <= most), and_(gy >= 0.0f, gy <= most)), and_(gz >= 0.0f, gz <= most));
    const mask has = and_(and_(s.valid, shown), and_(within, splat_mask(inverse > 0.0f)));
    const mask rejected = and_(s.rejected, shown), missing = and_(and_(s.valid, not_(has)), shown);
    if (any_(rejected)) atomic_add(counts, count_(rejected));
    if (any_(missing)) atomic_add(counts + 2, count_(missing));
    if (any_(has)) atomic_add(counts + 3, count_(has));

    const specular_directions to = towards_eye(view, s);
    const real one = (real)1.0f, none = (real)0.0f;
    real rough = (real)view.roughness.x;
    if (hasRoughness) rough = load(roughness, roughnessLayout.x + y * roughnessLayout.y + x);
    rough = select_(one, clamp(rough, none, one), rough == rough);

    float p[3][LW_WIDTH], n[3][LW_WIDTH], v[3][LW_WIDTH], r[LW_WIDTH], light[3][LW_WIDTH], live[LW_WIDTH];
    store(gx, p[0], 0);
    store(gy, p[1], 0);
    store(gz, p[2], 0);
    store(s.nx, n[0], 0);
    store(s.ny, n[1], 0);
    store(s.nz, n[2], 0);
    store(to.x, v[0], 0);
    store(to.y, v[1], 0);
    store(to.z, v[2], 0);
    store(rough, r, 0);
    store(ones_(has), live, 0);
    const specular_grid grid = {cells, ways, size, specular_levels(size), hasFaces, view.environment};
    for (int l = 0; l < LW_WIDTH; ++l) {
        float4 found = (float4)(0.0f);
        if (live[l] > 0.0f) {
            const float at[3] = {p[0][l], p[1][l], p[2][l]}, nl[3] = {n[0][l], n[1][l], n[2][l]}, vl[3] = {v[0][l], v[1][l], v[2][l]};
            found = lobe_mean(grid, at, nl, vl, r[l]);
        }
        light[0][l] = found.x;
        light[1][l] = found.y;
        light[2][l] = found.z;
    }
    const int out = radianceLayout.x + y * radianceLayout.y + x;
    mask saturated = splat_mask(0);
    for (int c = 0; c < 3; ++c) {
        const real value = load(light[c], 0);
        saturated = or_(saturated, not_(value <= LW_LARGEST_IRRADIANCE));
        store(fmin(value, (real)LW_LARGEST_IRRADIANCE), radiance, out + c * radianceLayout.z);
    }
    saturated = and_(saturated, shown);
    if (any_(saturated)) atomic_add(counts + 1, count_(saturated));
}
