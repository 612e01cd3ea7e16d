// A texel's surface as the pyramid of pull-push has it: a point and a normal, in the map's frame, and albedo. As planes they
// may be averaged (points and normals of one plane average to that plane) and met by other texels' rays.
#ifndef LW_PULL_PUSH_H
#define LW_PULL_PUSH_H

#include "shared/paraboloid_box.h"
#include "shared/pull_push_types.h"

// Known children that make a coarse texel known. 3 of 4: a hole of one texel among them is filled, while the border of what
// was seen against the open does not grow but in its corners. At 2 every border would grow by a texel with each level.
#define LW_FILL_CHILDREN 3

// Children whose normals agree with the nearest one's by this cosine, and who leave its plane by no more than this share of
// the way to them, are its surface; others lie before or behind it and do not enter the average. Raised cosine and lowered
// share: curved surfaces fall apart, and holes take the plane of one child; the other way: planes across edges are mixed.
#define LW_FILL_AGREES 0.5f
#define LW_FILL_OFF_PLANE 0.5f

// A filled texel lies at most this many times nearer or farther than its surface's point: a plane seen at a grazing angle
// runs away within a few texels.
#define LW_FILL_REACH 2.0f

typedef struct {
    mask known;
    lw_direction point, normal, albedo;  // normal: as long as averaging left it
} lw_filled;

LW_FN lw_filled no_surface(void) {
    lw_filled f;
    const lw_direction zero = {(real)(0.0f), (real)(0.0f), (real)(0.0f)};
    f.known = splat_mask(0);
    f.point = f.normal = f.albedo = zero;
    return f;
}

LW_FN lw_direction select3_(lw_direction f, lw_direction t, mask m) {
    const lw_direction s = {select_(f.x, t.x, m), select_(f.y, t.y, m), select_(f.z, t.z, m)};
    return s;
}
LW_FN lw_direction times_(lw_direction a, real s) {
    const lw_direction product = {a.x * s, a.y * s, a.z * s};
    return product;
}

// Four children as one: the mean of those that lie on the nearest one's surface.
LW_FN lw_filled pulled(const lw_filled child[4]) {
    lw_filled mean = no_surface();
    real known = 0.0f, least = INFINITY;
    lw_filled nearest = no_surface();
    for (int i = 0; i < 4; ++i) {
        known = known + ones_(child[i].known);
        const real distance2 = select_((real)(INFINITY), dot_(child[i].point, child[i].point), child[i].known);
        const mask nearer = distance2 < least;
        least = fmin(least, distance2);
        nearest.point = select3_(nearest.point, child[i].point, nearer);
        nearest.normal = select3_(nearest.normal, child[i].normal, nearer);
    }
    real share = 0.0f;
    for (int i = 0; i < 4; ++i) {
        const lw_direction way = minus_(child[i].point, nearest.point);
        const real off = dot_(nearest.normal, way), agreement = dot_(nearest.normal, child[i].normal);
        const mask same = and_(child[i].known, and_(agreement >= LW_FILL_AGREES,
                                                    off * off <= LW_FILL_OFF_PLANE * LW_FILL_OFF_PLANE * dot_(way, way)));
        const real weight = ones_(same);
        share = share + weight;
        mean.point = plus_(mean.point, times_(child[i].point, weight));
        mean.normal = plus_(mean.normal, times_(child[i].normal, weight));
        mean.albedo = plus_(mean.albedo, times_(child[i].albedo, weight));
    }
    mean.known = known >= (float)LW_FILL_CHILDREN;
    const real scale = 1.0f / fmax(share, 1.0f);
    mean.point = times_(mean.point, scale);
    mean.albedo = times_(mean.albedo, scale);
    // Those that agree with one of them do not cancel out.
    mean.normal = times_(mean.normal, rsqrt(fmax(dot_(mean.normal, mean.normal), 0.1f)));
    return mean;
}

// A texel of coarse width `width` (fine texels: 2^level) as its parent's surface meets its ray, where that makes sense.
// (x, y): in texels of its own level, whose centre lies at (x + 1/2) `texel` - RIM on the disc.
LW_FN lw_filled pushed(lw_filled parent, lanei x, lanei y, float texel) {
    const real u = (to_real(x) + 0.5f) * texel - LW_PARABOLOID_RIM, v = (to_real(y) + 0.5f) * texel - LW_PARABOLOID_RIM;
    const lw_direction ray = paraboloid_ray(u, v);
    const real along = dot_(parent.normal, parent.point) / dot_(parent.normal, ray);
    lw_filled f = parent;
    f.point = times_(ray, along);
    const real own2 = dot_(f.point, f.point), parent2 = dot_(parent.point, parent.point);
    const mask met = and_(along > 0.0f, and_(own2 <= parent2 * (LW_FILL_REACH * LW_FILL_REACH),
                                             own2 * (LW_FILL_REACH * LW_FILL_REACH) >= parent2));
    const mask before = u * u + v * v <= LW_PARABOLOID_RIM * LW_PARABOLOID_RIM;
    f.known = and_(parent.known, and_(met, before));
    return f;
}

#endif
