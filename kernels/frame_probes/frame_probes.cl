// The view's side of a frame's probes: a grid of pixels, lit by the emitters without visibility, each compared with its
// neighbours, and with the view between it and a few emitters. Then all sums, in a fixed order.
#define LW_INTERLEAVE 1  // of vpl_light.h's headers: nothing is interleaved here
#include "shared/frame_probes_types.h"
#include "shared/screen_types.h"
#include "shared/vpl_light.h"
#include "shared/vpl_types.h"

#define PROBE_LUMINANCE(r, g, b) (0.2126f * (r) + 0.7152f * (g) + 0.0722f * (b))

typedef struct {
    __global const float* position;
    __global const float* normal;
    int4 positionLayout, normalLayout;
    int width, height;
    LwScreenCamera camera;
    float orthographicScale;
} probe_view;

LW_FN lanei at_pixel(int4 layout, lanei x, lanei y) { return layout.x + y * layout.y + x; }

LW_FN lw_surface surface_at(const probe_view* v, lanei x, lanei y) {
    const lanei p = at_pixel(v->positionLayout, x, y), n = at_pixel(v->normalLayout, x, y);
    const int ps = v->positionLayout.z, ns = v->normalLayout.z;
    return make_surface(gather(v->position, p), gather(v->position, p + ps), gather(v->position, p + 2 * ps),
                        gather(v->normal, n), gather(v->normal, n + ns), gather(v->normal, n + 2 * ns));
}

// The luminance of three planes; what is no number of 0 or more counts as 0, more than `most` as that: sums stay finite.
LW_FN real luminance_at(__global const float* image, int4 layout, lanei x, lanei y, float most, real* colour) {
    const lanei at = at_pixel(layout, x, y);
    LW_UNROLL for (int c = 0; c < 3; ++c) {
        const real v = gather(image, at + c * layout.z);
        colour[c] = fmin(select_((real)0.0f, v, v > 0.0f), (real)most);
    }
    return PROBE_LUMINANCE(colour[0], colour[1], colour[2]);
}

LW_FN real along(float4 row, real x, real y, real z) { return fma_(row.x, x, fma_(row.y, y, row.z * z)); }

LW_FN real depth_of(const probe_view* v, real x, real y, real z) {
    return along(v->camera.axis, x - v->camera.eye.x, y - v->camera.eye.y, z - v->camera.eye.z);
}

// What lengths are measured by: the depth, or the size of an orthographic view.
LW_FN real scale_of(const probe_view* v, real depth) {
    return v->camera.axis.w != 0.0f ? fabs(depth) : (real)(v->orthographicScale);
}

// Adds a pair of neighbours: surfaces, or one and the background. They lie on one when each lies near the other's plane.
LW_FN void compare_neighbours(const probe_view* v, lw_surface a, real depth, lw_surface b, mask inside, real* pairs, real* edges) {
    const real x = b.px - a.px, y = b.py - a.py, z = b.pz - a.pz;
    const real off = fmin(fabs(fma_(x, a.nx, fma_(y, a.ny, z * a.nz))), fabs(fma_(x, b.nx, fma_(y, b.ny, z * b.nz))));
    const mask both = and_(a.valid, b.valid), some = and_(or_(a.valid, b.valid), inside);
    const mask one = and_(both, off <= LW_PROBE_PLANE * scale_of(v, depth));
    *pairs += ones_(some);
    *edges += ones_(and_(some, not_(one)));
}

// Where something is shown in front of the segment from pixel to emitter, near enough to lie in its way.
LW_FN mask is_hidden(const probe_view* v, lw_surface s, mask faces, real ex, real ey, real ez) {
    mask hidden = not_(faces);  // of the others nothing is asked
    for (int k = 1; k <= LW_PROBE_STEPS; ++k) {
        const float t = (float)k / (float)(LW_PROBE_STEPS + 1);
        const real x = fma_(t, ex - s.px, s.px), y = fma_(t, ey - s.py, s.py), z = fma_(t, ez - s.pz, s.pz);
        const real dx = x - v->camera.eye.x, dy = y - v->camera.eye.y, dz = z - v->camera.eye.z;
        const real w = along(v->camera.rowW, dx, dy, dz) + v->camera.rowW.w;
        const real column = (along(v->camera.rowX, dx, dy, dz) + v->camera.rowX.w) / w;
        const real row = (along(v->camera.rowY, dx, dy, dz) + v->camera.rowY.w) / w;
        const mask inside = and_(and_(w > 0.0f, and_(column >= 0.0f, row >= 0.0f)),
                                 and_(column < (float)v->width, row < (float)v->height));
        const lanei px = min(to_lanei(select_((real)0.0f, column, inside)), (lanei)(v->width - 1));
        const lanei py = min(to_lanei(select_((real)0.0f, row, inside)), (lanei)(v->height - 1));
        // As surface_at, but without a struct: Oclgrind refuses those of calls in loops.
        const lanei p = at_pixel(v->positionLayout, px, py), n = at_pixel(v->normalLayout, px, py);
        const int ps = v->positionLayout.z, ns = v->normalLayout.z;
        const real sx = gather(v->position, p), sy = gather(v->position, p + ps), sz = gather(v->position, p + 2 * ps);
        const real depth = depth_of(v, x, y, z), scale = scale_of(v, depth);
        const real front = depth - depth_of(v, sx, sy, sz);
        const mask blocks = and_(inside, and_(front > LW_PROBE_LEAST * scale, front < LW_PROBE_MOST * scale));
        // Memory that is far apart is what this costs: normals only where they decide.
        if (!any_(and_(blocks, not_(hidden)))) continue;
        const mask shown = is_surface(sx, sy, sz, gather(v->normal, n), gather(v->normal, n + ns), gather(v->normal, n + 2 * ns));
        hidden = or_(hidden, and_(shown, blocks));
    }
    return and_(hidden, faces);
}

// Of the pixels in column `column` on of the grid's row `row`: which pixel each is.
LW_FN lanei grid_x(lanei column, int width) {
    return min(to_lanei((to_real(column) + 0.5f) * ((float)width / (float)LW_PROBE_COLUMNS)), (lanei)(width - 1));
}
LW_FN int grid_y(int row, int height) {
    return min((int)(((float)row + 0.5f) * ((float)height / (float)LW_PROBE_ROWS)), height - 1);
}

// One work-item = LW_WIDTH pixels of a row of the grid. `has`: LW_PROBE_HAS_*.
__kernel void frame_probes_pixels(__global const float* position, int4 positionLayout, __global const float* normal,
                                  int4 normalLayout, __global const float* albedo, int4 albedoLayout,
                                  __global const float* radiance, int4 radianceLayout, int width, int height, int has,
                                  LwScreenCamera camera, __global const float* emitters, __global float* planes) {
    const int column = (int)get_global_id(0) * LW_WIDTH, row = (int)get_global_id(1);
    if (column >= LW_PROBE_COLUMNS || row >= LW_PROBE_ROWS) return;
    const probe_view v = {position, normal, positionLayout, normalLayout, width, height, camera,
                          sqrt(camera.eye.w * (float)width * (float)height)};
    const lanei lane = lanei_iota() + column;
    const lanei x = grid_x(lane, width), y = (lanei)grid_y(row, height);
    const lw_surface s = surface_at(&v, x, y), away = turned_away(s);
    const real none = (real)0.0f;

    rgb e = {none, none, none};
    real facing = none;
    for (int k = 0; k < LW_PROBE_EMITTERS; k += 2) {
        __global const float* const two[2] = {emitters + 12 * k, emitters + 12 * k + 12};
        real w[2];
        weigh_two_vpls(w, away, two);
        LW_UNROLL for (int u = 0; u < 2; ++u) {
            add_light(&e, w[u], two[u]);
            facing += ones_(w[u] > 0.0f);
        }
    }

    real rho[3] = {none, none, none}, direct[3] = {none, none, none}, reflectance = none, shown = none;
    if (has & LW_PROBE_HAS_ALBEDO) reflectance = luminance_at(albedo, albedoLayout, x, y, 1.0f, rho);
    if (has & LW_PROBE_HAS_RADIANCE) shown = luminance_at(radiance, radianceLayout, x, y, LW_LARGEST_EMISSION, direct);
    // Emitters send flux / pi, surfaces rho / pi of what arrives.
    const real indirect = PROBE_LUMINANCE(rho[0] * e.r, rho[1] * e.g, rho[2] * e.b) * (M_1_PI_F * M_1_PI_F);

    real tested = none, hidden = none, pairs = none, edges = none;
    if (has & LW_PROBE_HAS_CAMERA) {
        const real depth = depth_of(&v, s.px, s.py, s.pz);
        const int below = min(row + 1, LW_PROBE_ROWS - 1);
        compare_neighbours(&v, s, depth, surface_at(&v, grid_x(min(lane + 1, (lanei)(LW_PROBE_COLUMNS - 1)), width), y),
                           lane < LW_PROBE_COLUMNS - 1, &pairs, &edges);
        compare_neighbours(&v, s, depth, surface_at(&v, x, (lanei)grid_y(below, height)), splat_mask(below > row), &pairs, &edges);
        for (int j = 0; j < LW_PROBE_PAIRS; ++j) {
            // Neighbours ask for emitters far apart.
            const lanei k = (37 * lane + (11 * row + j * (LW_PROBE_EMITTERS / LW_PROBE_PAIRS))) & (LW_PROBE_EMITTERS - 1);
            const lanei at = 12 * k;
            const real ex = gather(emitters, at), ey = gather(emitters, at + 1), ez = gather(emitters, at + 2);
            const real dx = s.px - ex, dy = s.py - ey, dz = s.pz - ez;
            const real here = -fma_(dx, s.nx, fma_(dy, s.ny, dz * s.nz));
            const real there = fma_(dx, gather(emitters, at + 4), fma_(dy, gather(emitters, at + 5), dz * gather(emitters, at + 6)));
            const mask faces = and_(here > 0.0f, there > 0.0f);
            tested += ones_(faces);
            hidden += ones_(is_hidden(&v, s, faces, ex, ey, ez));
        }
    }

    const mask valid = s.valid;
    const int at = row * LW_PROBE_COLUMNS + column;
    store(ones_(valid), planes, at + LW_PROBE_VALID * LW_PROBE_PIXELS);
    store(s.px, planes, at + LW_PROBE_PX * LW_PROBE_PIXELS);
    store(s.py, planes, at + (LW_PROBE_PX + 1) * LW_PROBE_PIXELS);
    store(s.pz, planes, at + (LW_PROBE_PX + 2) * LW_PROBE_PIXELS);
    store(select_(none, indirect, valid), planes, at + LW_PROBE_INDIRECT * LW_PROBE_PIXELS);
    store(select_(none, shown, valid), planes, at + LW_PROBE_DIRECT * LW_PROBE_PIXELS);
    store(select_(none, reflectance, valid), planes, at + LW_PROBE_ALBEDO * LW_PROBE_PIXELS);
    store(select_(none, facing, valid), planes, at + LW_PROBE_FACING * LW_PROBE_PIXELS);
    store(tested, planes, at + LW_PROBE_TESTED * LW_PROBE_PIXELS);
    store(hidden, planes, at + LW_PROBE_HIDDEN * LW_PROBE_PIXELS);
    store(pairs, planes, at + LW_PROBE_NEIGHBOURS * LW_PROBE_PIXELS);
    store(edges, planes, at + LW_PROBE_EDGES * LW_PROBE_PIXELS);
}

// One work-item = one row of the grid.
__kernel void frame_probes_rows(__global const float* planes, __global LwFrameProbes* rows) {
    const int row = (int)get_global_id(0);
    if (row >= LW_PROBE_ROWS) return;
    __global const float* line = planes + row * LW_PROBE_COLUMNS;
    __global LwFrameProbes* to = rows + row;
    for (int p = 0; p < LW_PROBE_PIXEL_PLANES; ++p) {
        float sum = 0.0f;
        for (int i = 0; i < LW_PROBE_COLUMNS; ++i) sum += line[p * LW_PROBE_PIXELS + i];
        to->sums[p] = sum;
    }
    const float count = to->sums[LW_PROBE_VALID], inverse = 1.0f / fmax(count, 1.0f);
    float spread = 0.0f;
    for (int c = 0; c < 3; ++c) {
        const float mean = to->sums[LW_PROBE_PX + c] * inverse;
        to->pixels.mean[c] = mean;
        for (int i = 0; i < LW_PROBE_COLUMNS; ++i) {
            const float d = line[(LW_PROBE_PX + c) * LW_PROBE_PIXELS + i] - mean;
            spread += line[i] * d * d;
        }
    }
    to->pixels.count = count;
    to->pixels.spread = spread;
    to->pixels.weight = to->pixels.shown = to->pixels.squares = 0.0f;
}

// Means and spreads of two sets joined (Chan, Golub and LeVeque 1979); and their weights.
LW_FN void join_chunks(LwProbeChunk* a, LwProbeChunk b) {
    const float count = a->count + b.count;
    if (b.count > 0.0f) {
        const float share = b.count / count;
        float squared = 0.0f;
        for (int c = 0; c < 3; ++c) {
            const float d = b.mean[c] - a->mean[c];
            a->mean[c] += d * share;
            squared += d * d;
        }
        a->spread += b.spread + squared * a->count * share;
    }
    a->count = count;
    const float weight = a->weight + b.weight;
    if (b.weight > 0.0f) {
        const float mine = a->weight / weight, its = b.weight / weight;
        a->squares = a->squares * mine * mine + b.squares * its * its;
    }
    a->weight = weight;
    a->shown += b.shown;
}

// One work-item.
__kernel void frame_probes_join(__global const LwFrameProbes* rows, __global const LwProbeChunk* chunks, int chunkCount,
                                __global const lw_vpl* emitters, __global LwFrameProbes* probes) {
    if (get_global_id(0) != 0) return;
    LwFrameProbes all = rows[0];
    for (int r = 1; r < LW_PROBE_ROWS; ++r) {
        join_chunks(&all.pixels, rows[r].pixels);
        for (int p = 0; p < LW_PROBE_PIXEL_PLANES; ++p) all.sums[p] += rows[r].sums[p];
    }
    all.texels.weight = all.texels.shown = all.texels.squares = all.texels.count = all.texels.spread = 0.0f;
    for (int c = 0; c < 3; ++c) all.texels.mean[c] = 0.0f;
    for (int c = 0; c < chunkCount; ++c) join_chunks(&all.texels, chunks[c]);
    all.emitters = 0.0f;
    for (int k = 0; k < LW_PROBE_EMITTERS; ++k)
        all.emitters += emitters[k].flux.x + emitters[k].flux.y + emitters[k].flux.z > 0.0f ? 1.0f : 0.0f;
    all.reserved[0] = all.reserved[1] = all.reserved[2] = 0.0f;
    probes[0] = all;
}
