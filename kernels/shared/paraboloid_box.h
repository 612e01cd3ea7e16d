// Which texels of a paraboloid map what lies in a cone of directions can cover, and the vectors on lanes that it takes.
#ifndef LW_PARABOLOID_BOX_H
#define LW_PARABOLOID_BOX_H

#include "paraboloid.h"

LW_FN lw_direction plus_(lw_direction a, lw_direction b) {
    const lw_direction sum = {a.x + b.x, a.y + b.y, a.z + b.z};
    return sum;
}
LW_FN lw_direction minus_(lw_direction a, lw_direction b) {
    const lw_direction difference = {a.x - b.x, a.y - b.y, a.z - b.z};
    return difference;
}
LW_FN lw_direction cross_(lw_direction a, lw_direction b) {
    const lw_direction product = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return product;
}
LW_FN real dot_(lw_direction a, lw_direction b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
LW_FN lw_direction to_frame(lw_paraboloid frame, lw_direction v) {
    const lw_direction turned = {along_axis(frame.axisX, v.x, v.y, v.z), along_axis(frame.axisY, v.x, v.y, v.z),
                                 along_axis(frame.axisZ, v.x, v.y, v.z)};
    return turned;
}

typedef struct {
    lanei x0, x1, y0, y1;  // inclusive
    mask any;              // some texel's centre at all
} lw_texel_box;

// For rounding, on the disc: a fiftieth of a texel of the largest map.
#define LW_BOX_MARGIN 1e-4f

LW_FN lw_texel_box box_of(real left, real right, real bottom, real top, int size, mask whole, mask none) {
    const float step = paraboloid_step(size), last = (float)(size - 1);
    // The disc's edge against the box's nearest point.
    const real nearX = fmax(fmax(left, -right), 0.0f), nearY = fmax(fmax(bottom, -top), 0.0f);
    const mask outside = nearX * nearX + nearY * nearY > LW_PARABOLOID_RIM * LW_PARABOLOID_RIM * 1.001f;
    lw_texel_box box;
    const real x0 = ceil(paraboloid_texel(left - LW_BOX_MARGIN, step));
    const real x1 = floor(paraboloid_texel(right + LW_BOX_MARGIN, step));
    const real y0 = ceil(paraboloid_texel(bottom - LW_BOX_MARGIN, step));
    const real y1 = floor(paraboloid_texel(top + LW_BOX_MARGIN, step));
    box.x0 = to_lanei(select_(fmin(fmax(x0, 0.0f), last + 1.0f), (real)(0.0f), whole));
    box.x1 = to_lanei(select_(fmin(fmax(x1, -1.0f), last), (real)(last), whole));
    box.y0 = to_lanei(select_(fmin(fmax(y0, 0.0f), last + 1.0f), (real)(0.0f), whole));
    box.y1 = to_lanei(select_(fmin(fmax(y1, -1.0f), last), (real)(last), whole));
    const mask some = and_(box.x0 <= box.x1, box.y0 <= box.y1);
    box.any = and_(not_(none), or_(whole, and_(some, not_(outside))));
    return box;
}

// The cap of directions around unit `axis` (the map's frame) with this cosine and sine of its half angle. A cap
// that does not hold the pole -z has a circle as its image; one near the pole may cover any texel.
LW_FN lw_texel_box box_of_cap(lw_direction axis, real cosine, real sine, int size) {
    const float rimSine = 0.96592583f;
    const mask beyond = and_(cosine > 0.26f, axis.z < LW_PARABOLOID_RIM_COSINE * cosine - rimSine * sine - LW_BOX_MARGIN);
    const mask round = and_(cosine > 0.05f, axis.z + cosine > 0.05f);
    const real scale = 1.0f / select_((real)(1.0f), axis.z + cosine, round);
    const real x = axis.x * scale, y = axis.y * scale, radius = sine * scale;
    return box_of(x - radius, x + radius, y - radius, y + radius, size, not_(round), beyond);
}

#endif
