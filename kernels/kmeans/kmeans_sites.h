// Sites, places in the space that k-means clusters, and the squared distance of two.
#ifndef LW_KMEANS_SITES_H
#define LW_KMEANS_SITES_H

#include "shared/wide.h"
#include "shared/kmeans_types.h"
#include "shared/vpl_list.h"

typedef struct {
    real x, y, z, nx, ny, nz;
} lw_site;

// LW_WIDTH sites from `i` on; the planes of `p` lie `stride` floats apart.
LW_FN lw_site site_lanes(__global const float* p, int stride, int i) {
    lw_site s;
    s.x = load(p, i);
    s.y = load(p, stride + i);
    s.z = load(p, 2 * stride + i);
    s.nx = load(p, 3 * stride + i);
    s.ny = load(p, 4 * stride + i);
    s.nz = load(p, 5 * stride + i);
    return s;
}

// Site `i` in every lane.
LW_FN lw_site site_splat(__global const float* p, int stride, int i) {
    lw_site s;
    s.x = (real)(p[i]);
    s.y = (real)(p[stride + i]);
    s.z = (real)(p[2 * stride + i]);
    s.nx = (real)(p[3 * stride + i]);
    s.ny = (real)(p[4 * stride + i]);
    s.nz = (real)(p[5 * stride + i]);
    return s;
}

LW_FN lw_site select_site(lw_site f, lw_site t, mask m) {
    lw_site s;
    s.x = select_(f.x, t.x, m);
    s.y = select_(f.y, t.y, m);
    s.z = select_(f.z, t.z, m);
    s.nx = select_(f.nx, t.nx, m);
    s.ny = select_(f.ny, t.ny, m);
    s.nz = select_(f.nz, t.nz, m);
    return s;
}

LW_FN void store_site(lw_site s, __global float* p, int stride, int i) {
    store(s.x, p, i);
    store(s.y, p, stride + i);
    store(s.z, p, 2 * stride + i);
    store(s.nx, p, 3 * stride + i);
    store(s.ny, p, 4 * stride + i);
    store(s.nz, p, 5 * stride + i);
}

// w1 |a - b|^2 + w2 (1 - n_a . n_b), `weights` being w1 and w2. For unit normals 1 - n_a . n_b = |n_a - n_b|^2 / 2, which
// is never negative and exactly 0 between equal ones.
LW_FN real squared_distance(lw_site a, lw_site b, float2 weights) {
    const real x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
    const real nx = a.nx - b.nx, ny = a.ny - b.ny, nz = a.nz - b.nz;
    const real place = fma_(z, z, fma_(y, y, x * x)), turn = fma_(nz, nz, fma_(ny, ny, nx * nx));
    return fma_((real)(weights.x), place, (0.5f * weights.y) * turn);
}

// What a work-item of those that sum has to sum: a chunk of slots, and LW_WIDTH of the clusters. (The remainder is written
// out: beside the quotient, LLVM turns % into an instruction that Oclgrind lacks.)
LW_FN void chunk_and_clusters(int clusters, int* chunk, int* first) {
    const int groups = (clusters + LW_WIDTH - 1) / LW_WIDTH, index = lw_list_index();
    *chunk = index / groups;
    *first = (index - *chunk * groups) * LW_WIDTH;
}

#endif
