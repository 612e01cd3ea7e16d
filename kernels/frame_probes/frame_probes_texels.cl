// The light's side of a frame's probes: a grid of texels over all RSMs, their flux and what of it the view shows, and emitters
// drawn from them by flux. Sums run in a fixed order: chunks of texels, then the chunks (frame_probes.cl).
#include "shared/frame_probes_types.h"
#include "shared/input_limits.h"
#include "shared/rsm_types.h"
#include "shared/screen_types.h"
#include "shared/vpl_list.h"

typedef struct {
    float4 p, n;  // w: 0
    int valid;
} probe_point;

// As surface.h's is_surface, of one point.
LW_FN probe_point point_of(float4 p, float4 n) {
    probe_point s;
    const float n2 = n.x * n.x + n.y * n.y + n.z * n.z;
    s.valid = n2 > 0.25f && n2 < 4.0f &&
              p.x * p.x + p.y * p.y + p.z * p.z <= LW_LARGEST_DISTANCE * LW_LARGEST_DISTANCE;
    s.p = s.valid ? p : (float4)(0.0f);
    s.n = s.valid ? n * rsqrt(n2) : (float4)(0.0f);
    return s;
}

LW_FN float4 at_plane(__global const float* plane, int step) {
    return (float4)(plane[0], plane[step], plane[2 * step], 0.0f);
}

LW_FN float along(float4 row, float4 v) { return row.x * v.x + row.y * v.y + row.z * v.z; }

// What lengths are measured by: the depth, or the size of an orthographic view.
LW_FN float probe_scale(LwScreenCamera camera, float depth, int width, int height) {
    return camera.axis.w != 0.0f ? depth : sqrt(camera.eye.w * (float)width * (float)height);
}

// Whether the view shows that place: within its picture, and the surface there is the same.
LW_FN int is_shown(probe_point t, LwScreenCamera camera, __global const float* position, int4 positionLayout,
                   __global const float* normal, int4 normalLayout, int width, int height) {
    const float4 v = t.p - (float4)(camera.eye.xyz, 0.0f);
    const float w = along(camera.rowW, v) + camera.rowW.w;
    const float column = (along(camera.rowX, v) + camera.rowX.w) / w, row = (along(camera.rowY, v) + camera.rowY.w) / w;
    if (!(w > 0.0f && column >= 0.0f && row >= 0.0f && column < (float)width && row < (float)height)) return 0;
    const int x = min((int)column, width - 1), y = min((int)row, height - 1);
    const probe_point s = point_of(at_plane(position + positionLayout.x + y * positionLayout.y + x, positionLayout.z),
                                   at_plane(normal + normalLayout.x + y * normalLayout.y + x, normalLayout.z));
    const float depth = along(camera.axis, v), scale = probe_scale(camera, depth, width, height);
    return s.valid && fabs(along(s.n, t.p - s.p)) <= LW_PROBE_PLANE * scale && along(s.n, t.n) > 0.0f &&
           fabs(along(camera.axis, t.p - s.p)) <= LW_PROBE_DEPTH * scale;
}

LW_FN void write_texel(__global float* planes, int step, int i, float weight, probe_point t, int shown) {
    planes[LW_PROBE_WEIGHT * step + i] = weight;
    planes[LW_PROBE_SHOWN * step + i] = shown ? 1.0f : 0.0f;
    planes[LW_PROBE_SURFACE * step + i] = t.valid ? 1.0f : 0.0f;
    planes[(LW_PROBE_X + 0) * step + i] = t.p.x;
    planes[(LW_PROBE_X + 1) * step + i] = t.p.y;
    planes[(LW_PROBE_X + 2) * step + i] = t.p.z;
}

// One work-item = one of `sampleCount` texels, `side` x `side` of each map, or behind them one of `authoredCount` VPLs of the
// host's. places: which texel, or VPL.
__kernel void frame_probes_texels(__global const float* texels, int4 layout, __global const LwProbeMap* maps, int side,
                                  int sampleCount, __global const lw_vpl* authored, int authoredCount, LwScreenCamera camera,
                                  int hasCamera, __global const float* position, int4 positionLayout,
                                  __global const float* normal, int4 normalLayout, int width, int height, int step,
                                  __global float* planes, __global int* places) {
    const int i = lw_list_index();
    if (i >= sampleCount + authoredCount) return;
    float weight;
    probe_point t;
    if (i < sampleCount) {
        const LwProbeMap map = maps[i / (side * side)];
        const int column = i % side, row = i / side % side;
        const int x = min((int)(((float)column + lw_probe_jitter((uint)(2 * i))) * (float)map.width / (float)side), map.width - 1);
        const int y = min((int)(((float)row + lw_probe_jitter((uint)(2 * i + 1))) * (float)map.height / (float)side), map.height - 1);
        const int place = map.firstTexel + y * map.rowLength + x;
        __global const float* texel = texels + layout.x + place;
        t = point_of(at_plane(texel, layout.z), at_plane(texel + LW_RSM_NORMAL * layout.z, layout.z));
        __global const float* flux = texel + LW_RSM_FLUX * layout.z;
        weight = (flux[0] + flux[layout.z] + flux[2 * layout.z]) * (1.0f / 3.0f) *
                 ((float)map.width / (float)side) * ((float)map.height / (float)side);
        places[i] = place;
    } else {
        const lw_vpl vpl = authored[i - sampleCount];
        t = point_of((float4)(vpl.positionArea.xyz, 0.0f), (float4)(vpl.normal.xyz, 0.0f));
        weight = (vpl.flux.x + vpl.flux.y + vpl.flux.z) * (1.0f / 3.0f);
        places[i] = i - sampleCount;
    }
    // Without weight it does not matter.
    const int shown = hasCamera && t.valid && weight > 0.0f && is_shown(t, camera, position, positionLayout, normal, normalLayout, width, height);
    write_texel(planes, step, i, t.valid ? weight : 0.0f, t, shown);
}

// One work-item = one of LW_PROBE_CHUNKS chunks of `length` texels.
__kernel void frame_probes_chunks(__global const float* planes, int step, int count, int length, __global LwProbeChunk* chunks) {
    const int c = (int)get_global_id(0);
    if (c >= LW_PROBE_CHUNKS) return;
    const int first = min(c * length, count), last = min(first + length, count);
    LwProbeChunk chunk;
    chunk.weight = chunk.shown = chunk.squares = chunk.count = chunk.spread = 0.0f;
    float x = 0.0f, y = 0.0f, z = 0.0f;
    for (int i = first; i < last; ++i) {
        const float w = planes[LW_PROBE_WEIGHT * step + i], surface = planes[LW_PROBE_SURFACE * step + i];
        chunk.weight += w;
        chunk.shown += w * planes[LW_PROBE_SHOWN * step + i];
        chunk.count += surface;
        x += planes[LW_PROBE_X * step + i];  // 0 without a surface
        y += planes[(LW_PROBE_X + 1) * step + i];
        z += planes[(LW_PROBE_X + 2) * step + i];
    }
    const float mean = 1.0f / fmax(chunk.count, 1.0f);
    chunk.mean[0] = x * mean;
    chunk.mean[1] = y * mean;
    chunk.mean[2] = z * mean;
    for (int i = first; i < last; ++i) {
        // Shares before they are squared: fluxes to the square would leave float's range.
        const float share = chunk.weight > 0.0f ? planes[LW_PROBE_WEIGHT * step + i] / chunk.weight : 0.0f;
        chunk.squares += share * share;
        const float dx = planes[LW_PROBE_X * step + i] - chunk.mean[0], dy = planes[(LW_PROBE_X + 1) * step + i] - chunk.mean[1],
                    dz = planes[(LW_PROBE_X + 2) * step + i] - chunk.mean[2];
        chunk.spread += planes[LW_PROBE_SURFACE * step + i] * (dx * dx + dy * dy + dz * dz);
    }
    chunks[c] = chunk;
}

// One work-item = one of LW_PROBE_EMITTERS, each with an even share of the flux: where the sum of all flux up to a texel passes
// the middle of its share. Divided by its own flux, a texel's area and colours are those of the share.
__kernel void frame_probes_draw(__global const float* planes, int step, int count, int length, __global const LwProbeChunk* chunks,
                                __global const int* places, __global const float* texels, int4 layout, int sampleCount,
                                __global const lw_vpl* authored, __global lw_vpl* emitters) {
    const int k = (int)get_global_id(0);
    if (k >= LW_PROBE_EMITTERS) return;
    float total = 0.0f;
    for (int c = 0; c < LW_PROBE_CHUNKS; ++c) total += chunks[c].weight;
    lw_vpl vpl = no_vpl();
    if (total > 0.0f && isfinite(total)) {
        const float target = ((float)k + 0.5f) / (float)LW_PROBE_EMITTERS * total;
        // Of the last that had any flux, where rounding leaves none beyond the target.
        int chosen = -1;
        float sum = 0.0f;
        for (int c = 0; c < LW_PROBE_CHUNKS; ++c) {
            const float next = sum + chunks[c].weight;
            if (chunks[c].weight > 0.0f) chosen = c;
            if (next > target) break;
            sum = next;
        }
        const int first = min(chosen * length, count), last = min(first + length, count);
        int texel = -1;
        for (int i = first; i < last; ++i) {
            const float weight = planes[LW_PROBE_WEIGHT * step + i];
            if (!(weight > 0.0f)) continue;
            texel = i;
            sum += weight;
            if (sum > target) break;
        }
        const int place = places[texel];
        if (texel < sampleCount) {
            __global const float* p = texels + layout.x + place;
            const int s = layout.z;
            vpl.positionArea = (float4)(p[0], p[s], p[2 * s], p[LW_RSM_AREA * s]);
            vpl.normal = at_plane(p + LW_RSM_NORMAL * s, s);
            vpl.flux = at_plane(p + LW_RSM_FLUX * s, s);
        } else {
            vpl = authored[place];
            vpl.normal.w = vpl.flux.w = 0.0f;
        }
        const float factor = total / (float)LW_PROBE_EMITTERS / ((vpl.flux.x + vpl.flux.y + vpl.flux.z) * (1.0f / 3.0f));
        vpl.positionArea.w *= factor;
        vpl.flux *= factor;
        vpl.normal *= rsqrt(vpl.normal.x * vpl.normal.x + vpl.normal.y * vpl.normal.y + vpl.normal.z * vpl.normal.z);
        const float largest = fmax(fmax(vpl.positionArea.w, vpl.flux.x), fmax(vpl.flux.y, vpl.flux.z));
        if (!isfinite(largest)) vpl = no_vpl();
    }
    emitters[k] = bounded(vpl);
}
