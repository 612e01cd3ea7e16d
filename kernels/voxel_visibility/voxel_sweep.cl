// Visibility swept outward from eyes, one shell of voxels after the other: a voxel takes what its straight way to the eye met in
// the shell before, between the four voxels that the way passes there (short characteristics, Kunasz and Auer 1988).
//
// A shell is the voxels whose largest coordinate from the eye's voxel is `shell`. Its way leaves a voxel along the axis of that
// coordinate, by one voxel along it and by 0 to 1 along each of the others: always into the shell before, but for voxels on the
// shell's edges, whose way is taken to be the diagonal.
#include "shared/voxel_visibility_types.h"
#include "shared/wide.h"

#if LW_WIDTH == 1
LW_FN lanei load_bytes(__global const uchar* p, int i) { return p[i]; }
LW_FN void store_bytes(lanei v, __global uchar* p, int i) { p[i] = (uchar)v; }
LW_FN lanei gather_bytes(__global const uchar* p, lanei i) { return p[i]; }
LW_FN void scatter_bytes(lanei v, __global uchar* p, lanei i) { p[i] = (uchar)v; }
#else
#define LWV_GATHER(l) p[i.s##l]
#define LWV_SCATTER(l) p[i.s##l] = (uchar)v.s##l;
LW_FN lanei load_bytes(__global const uchar* p, int i) { return LW_CAT(convert_int, LW_WIDTH)(load(p, i)); }
LW_FN void store_bytes(lanei v, __global uchar* p, int i) {
    LW_CAT(vstore, LW_WIDTH)(LW_CAT(convert_uchar, LW_WIDTH)(v), 0, p + i);
}
LW_FN lanei gather_bytes(__global const uchar* p, lanei i) { return (lanei)LW_LANES(LWV_GATHER); }
LW_FN void scatter_bytes(lanei v, __global uchar* p, lanei i) { LW_EACH_LANE(LWV_SCATTER) }
#endif

// What goes on from a voxel.
LW_FN real onward(lanei byte) { return to_real(selecti_(byte, (lanei)0, byte >= LW_SIGHT_SOLID)); }

LW_FN real mix_(real a, real b, real t) { return fma_(t, b - a, a); }

// A voxel's byte, from that of the solid voxels and from what goes on in the four before it: near and far along each of two axes.
LW_FN lanei sight_of(real nn, real fn, real nf, real ff, real t, real u, lanei solid) {
    const real light = mix_(mix_(nn, fn, t), mix_(nf, ff, t), u);
    return to_lanei(light + 0.5f) | solid;
}

// Along one axis: the voxel next to this one towards the eye, and how far the way goes to it while it goes one voxel along the main
// axis. Once in the eye's row a way stays there: interpolated between it and the next one, light would be lost to the surface
// that the eye stands off by a voxel.
LW_FN float share_of(int voxel, float eye, int eyeVoxel, float perVoxel, int shell, int* next) {
    const int off = voxel - eyeVoxel;
    *next = off > 0 ? voxel - 1 : off < 0 ? voxel + 1 : voxel;
    if (off == 0) return 0.0f;
    if (off >= shell || -off >= shell) return 1.0f;
    return fmin(fabs((float)voxel + 0.5f - eye) * perVoxel, 1.0f);
}

// The lanes' coordinates likewise; those of other shells, which are worked out anew later, take anything.
LW_FN real shares_of(lanei voxel, float eye, int eyeVoxel, float perVoxel, int shell, lanei* next) {
    const lanei off = voxel - eyeVoxel;
    const mask isOwn = off == 0;
    *next = selecti_(selecti_(voxel + 1, voxel - 1, off > 0), voxel, isOwn);
    const real share = fmin(fabs(to_real(voxel) + (0.5f - eye)) * perVoxel, (real)1.0f);
    return select_(select_(share, (real)1.0f, or_(off >= shell, -off >= shell)), (real)0.0f, isOwn);
}

// One work-item = one eye: its own voxel and those about it, which nothing stands before.
__kernel void voxel_sweep_start(__global const LwVoxelEye* eyes, int count, int size, __global const uchar* solid,
                                __global uchar* sights) {
    const int e = (int)get_global_id(0);
    if (e >= count || !eyes[e].sweep.x) return;
    const int ex = (int)eyes[e].position.x, ey = (int)eyes[e].position.y, ez = (int)eyes[e].position.z;
    __global uchar* sight = sights + LW_SIGHT_PAD + (long)e * size * size * size;
    for (int z = max(ez - 1, 0); z <= min(ez + 1, size - 1); ++z)
        for (int y = max(ey - 1, 0); y <= min(ey + 1, size - 1); ++y)
            for (int x = max(ex - 1, 0); x <= min(ex + 1, size - 1); ++x) {
                const int i = x + size * (y + size * z);
                sight[i] = solid[i] | LW_SIGHT_FULL;
            }
}

// A shell of an eye.
typedef struct {
    float4 eye;
    int x, y, z;  // the eye's voxel
    int shell, size;
    __global const uchar* solid;
    __global uchar* sight;
} lw_shell;

LW_FN lw_shell shell_of(__global const LwVoxelEye* eyes, int e, int size, int shell, __global const uchar* solid,
                        __global uchar* sights) {
    lw_shell s;
    s.eye = eyes[e].position;
    s.x = (int)s.eye.x;
    s.y = (int)s.eye.y;
    s.z = (int)s.eye.z;
    s.shell = shell;
    s.size = size;
    s.solid = solid;
    s.sight = sights + LW_SIGHT_PAD + (long)e * size * size * size;
    return s;
}

// Slice z of a side across x.
LW_FN void sweep_across(const lw_shell s, int side, int x, int z) {
    const float perVoxel = 1.0f / fabs((float)x + 0.5f - s.eye.x);
    int nextZ;
    const real u = (real)share_of(z, s.eye.z, s.z, perVoxel, s.shell, &nextZ);
    const int size = s.size, near = x - side + size * size * z, far = x - side + size * size * nextZ;
    for (int y = max(s.y - s.shell + 1, 0) / LW_WIDTH * LW_WIDTH; y <= min(s.y + s.shell - 1, size - 1); y += LW_WIDTH) {
        const lanei row = lanei_iota() + y;
        lanei next;
        const real t = shares_of(row, s.eye.y, s.y, perVoxel, s.shell, &next);
        const lanei own = row * size + (x + size * size * z);
        const real nn = onward(gather_bytes(s.sight, row * size + near)), fn = onward(gather_bytes(s.sight, next * size + near));
        const real nf = onward(gather_bytes(s.sight, row * size + far)), ff = onward(gather_bytes(s.sight, next * size + far));
        scatter_bytes(sight_of(nn, fn, nf, ff, t, u, gather_bytes(s.solid, own)), s.sight, own);
    }
}

// The two sides of a shell across x, but for their edges. One work-item = LW_SWEEP_ROWS slices (x) of one of an eye's sides (y):
// lanes are rows, so each is fetched for itself.
__kernel void voxel_sweep_across(__global const LwVoxelEye* eyes, int count, int size, int shell,
                                 __global const uchar* solid, __global uchar* sights) {
    const int e = (int)get_global_id(1) / 2, side = (int)get_global_id(1) % 2 * 2 - 1;
    if (e >= count || !eyes[e].sweep.x) return;
    const lw_shell s = shell_of(eyes, e, size, shell, solid, sights);
    const int x = s.x + side * shell;
    if (x < 0 || x >= size) return;
    const int first = max(s.z - shell + 1, 0) + (int)get_global_id(0) * LW_SWEEP_ROWS;
    for (int z = first; z < min(first + LW_SWEEP_ROWS, min(s.z + shell, size)); ++z) sweep_across(s, side, x, z);
}

// What goes on from a row of voxels, and from the next ones along it.
LW_FN void load_onward(__global const uchar* sight, int first, mask isUp, real* near, real* far) {
    *near = onward(load_bytes(sight, first));
    *far = onward(selecti_(load_bytes(sight, first + 1), load_bytes(sight, first - 1), isUp));
}

// Row `other` of a side across z or y, at `main` along that axis.
LW_FN void sweep_along(const lw_shell s, bool isZ, int side, int main, int other) {
    const int size = s.size, mainStep = isZ ? size * size : size, otherStep = isZ ? size : size * size;
    const float perVoxel = 1.0f / fabs((float)main + 0.5f - (isZ ? s.eye.z : s.eye.y));
    int nextOther;
    const float u = share_of(other, isZ ? s.eye.y : s.eye.z, isZ ? s.y : s.z, perVoxel, s.shell, &nextOther);
    const int own = main * mainStep + other * otherStep, before = (main - side) * mainStep;
    // On an edge the nearer row is this shell's, and counts nothing.
    const int near = before + (u < 1.0f ? other : nextOther) * otherStep, far = before + nextOther * otherStep;
    for (int x = max(s.x - s.shell, 0) / LW_WIDTH * LW_WIDTH; x <= min(s.x + s.shell, size - 1); x += LW_WIDTH) {
        const lanei column = lanei_iota() + x;
        lanei next;
        const real t = shares_of(column, s.eye.x, s.x, perVoxel, s.shell, &next);
        const mask isUp = next < column;
        real nn, fn, nf, ff;
        load_onward(s.sight, near + x, isUp, &nn, &fn);
        load_onward(s.sight, far + x, isUp, &nf, &ff);
        store_bytes(sight_of(nn, fn, nf, ff, t, (real)u, load_bytes(s.solid, own + x)), s.sight, own + x);
    }
}

// The other four sides, after those: across z with all their edges, across y without those. One work-item = LW_SWEEP_ROWS rows
// (x) of one of an eye's sides (y).
__kernel void voxel_sweep_along(__global const LwVoxelEye* eyes, int count, int size, int shell, __global const uchar* solid,
                                __global uchar* sights) {
    const int e = (int)get_global_id(1) / 4, face = (int)get_global_id(1) % 4;
    if (e >= count || !eyes[e].sweep.x) return;
    const lw_shell s = shell_of(eyes, e, size, shell, solid, sights);
    const int side = face % 2 * 2 - 1;
    const bool isZ = face < 2;
    const int main = (isZ ? s.z : s.y) + side * shell, middle = isZ ? s.y : s.z, reach = isZ ? shell : shell - 1;
    if (main < 0 || main >= size) return;
    const int first = max(middle - reach, 0) + (int)get_global_id(0) * LW_SWEEP_ROWS;
    for (int other = first; other < min(first + LW_SWEEP_ROWS, min(middle + reach + 1, size)); ++other)
        sweep_along(s, isZ, side, main, other);
}

// All shells of an eye. One work-item = one eye: for devices of few work-items, whose caches hold what one eye sees but not
// what all of them do.
__kernel void voxel_sweep_whole(__global const LwVoxelEye* eyes, int count, int size, __global const uchar* solid,
                                __global uchar* sights) {
    const int e = (int)get_global_id(0);
    if (e >= count || !eyes[e].sweep.x) return;
    for (int shell = 2; shell < size; ++shell) {
        const lw_shell s = shell_of(eyes, e, size, shell, solid, sights);
        for (int side = -1; side <= 1; side += 2) {
            const int x = s.x + side * shell;
            if (x < 0 || x >= size) continue;
            for (int z = max(s.z - shell + 1, 0); z < min(s.z + shell, size); ++z) sweep_across(s, side, x, z);
        }
        for (int face = 0; face < 4; ++face) {
            const int side = face % 2 * 2 - 1;
            const bool isZ = face < 2;
            const int main = (isZ ? s.z : s.y) + side * shell, middle = isZ ? s.y : s.z, reach = isZ ? shell : shell - 1;
            if (main < 0 || main >= size) continue;
            for (int other = max(middle - reach, 0); other < min(middle + reach + 1, size); ++other)
                sweep_along(s, isZ, side, main, other);
        }
    }
}
