// What the maps see: a block of texels at a time, its rays go through the tree of triangles together, nearest boxes first.
// Of the triangles behind what they met they see no more than a box, so time grows with the texels and hardly with the
// triangles, most of which are smaller than a texel.
#include "paraboloid_packet.h"

// Where rays have come to. The nearest hit, of equally near ones the least triangle by its values: no bit depends on the
// order in which boxes are opened.
typedef struct {
    real distance;   // 0 where there is no ray
    lanei triangle;  // -1: none yet
    float limit;     // boxes that begin farther along the axis hide behind what all rays met
} lw_nearest;

// Children of the nodes on the way to the deepest leaf.
#define LW_TREE_STACK (LW_TREE_LEVELS * LW_TREE_CHILDREN)

// Where `triangle` comes before those that rays met, by their own values: of equally near ones the same is seen whatever
// the others in the tree are, and a map that is not redrawn holds what it would hold if it were.
LW_FN mask comes_before(__global const float* triangles, int stride, int triangle, lanei others) {
    mask before = splat_mask(0), same = splat_mask(1);
    for (int plane = 0; plane < LW_TRIANGLE_PLANES; ++plane) {
        __global const float* const values = triangles + plane * stride;
        const real own = values[triangle], other = gather(values, others);
        before = or_(before, and_(same, own < other));
        same = and_(same, own == other);
    }
    return before;
}

LW_FN void meet_triangle(lw_nearest* n, const lw_packet* p, __global const float* triangles, int stride,
                         const lw_group_planes* g, int t, int triangle, int* met) {
    const mask within = within_edges(g, t, p->ray);
    if (!any_(within)) return;
    const real distance = plane_distance(g, t, p->ray, p->length);
    mask first = distance < n->distance;
    const mask tie = and_(and_(within, distance == n->distance), n->triangle >= 0);
    if (any_(tie)) first = or_(first, and_(tie, comes_before(triangles, stride, triangle, selecti_((lanei)(0), n->triangle, tie))));
    const mask nearer = and_(and_(within, first), and_(distance > 0.0f, distance < INFINITY));
    n->distance = select_(n->distance, distance, nearer);
    n->triangle = selecti_(n->triangle, (lanei)(triangle), nearer);
    *met = 1;
}

// Triangles of a leaf.
LW_FN void meet_leaf(lw_nearest* n, const lw_packet* p, __global const float* triangles, int stride, float4 origin,
                     int first, int count) {
    lw_group_planes planes;
    uint reached = 0;
    for (int i = 0; i < count; i += LW_WIDTH) {
        const lw_corners corners = load_corners(triangles, stride, first + i, origin);
        reached |= bits_(triangles_inside(p, corners)) << i;
        store_planes(planes_of(corners), &planes, i);
    }
    // Vectors are loaded whole: what follows the leaf is another's.
    reached &= (1u << count) - 1u;
    int met = 0;
    while (reached) {
        const int t = take_lowest(&reached);
        meet_triangle(n, p, triangles, stride, &planes, t, first + t, &met);
    }
    if (met) n->limit = max_lane(n->distance * p->cosine) * LW_LIMIT_MARGIN;
}

// What is still to be opened, the nearest last.
typedef struct {
    int nearest[LW_TREE_STACK];  // where its box begins along the axis, as bits of a float
    int child[LW_TREE_STACK];    // node * 16 + child
    int count;
} lw_open;

// Puts the children of a node that the rays may reach.
LW_FN void open_node(lw_open* open, const lw_packet* p, __global const float* nodes, int number, float4 origin, float limit) {
    float begins[LW_TREE_CHILDREN];
    uint reached = children_inside(p, nodes + LW_TREE_NODE * number, origin, limit, begins);
    const int first = open->count;
    while (reached) {
        const int child = take_lowest(&reached), begin = as_int(begins[child]);
        int at = open->count++;
        for (; at > first && open->nearest[at - 1] < begin; --at) {
            open->nearest[at] = open->nearest[at - 1];
            open->child[at] = open->child[at - 1];
        }
        open->nearest[at] = begin;
        open->child[at] = number * LW_TREE_CHILDREN + child;
    }
}

LW_FN void trace(lw_nearest* n, const lw_packet* p, __global const float* triangles, int stride,
                 __global const float* nodes, float4 origin) {
    lw_open open;
    open.count = 0;
    open_node(&open, p, nodes, 0, origin, n->limit);
    while (open.count > 0) {
        --open.count;
        if (open.nearest[open.count] > as_int(n->limit)) continue;
        const int number = open.child[open.count];
        __global const int* const child =
            (__global const int*)nodes + LW_TREE_NODE * (number / LW_TREE_CHILDREN) + LW_TREE_CHILD + number % LW_TREE_CHILDREN;
        const int at = child[0], count = child[LW_TREE_COUNT - LW_TREE_CHILD];
        if (count)
            meet_leaf(n, p, triangles, stride, origin, at, count);
        else
            open_node(&open, p, nodes, at, origin, n->limit);
    }
}

LW_FN lw_direction gather3(__global const float* triangles, int stride, int plane, lanei t) {
    const lw_direction v = {gather(triangles + plane * stride, t), gather(triangles + (plane + 1) * stride, t),
                            gather(triangles + (plane + 2) * stride, t)};
    return v;
}

// The normal of triangles that rays met, turned against them, as a record has it.
LW_FN laneu normal_word(lw_paraboloid frame, __global const float* triangles, int stride, lanei t, lw_direction ray) {
    const lw_direction a = gather3(triangles, stride, LW_TRIANGLE_A, t);
    lw_direction normal = cross_(minus_(gather3(triangles, stride, LW_TRIANGLE_B, t), a),
                                 minus_(gather3(triangles, stride, LW_TRIANGLE_C, t), a));
    // Of a sliver that rounding leaves no plane: towards the ray's origin, as whatever its plane is it is next to none.
    const mask plane = or_(or_(normal.x != 0.0f, normal.y != 0.0f), normal.z != 0.0f);
    normal.x = select_(ray.x, normal.x, plane);
    normal.y = select_(ray.y, normal.y, plane);
    normal.z = select_(ray.z, normal.z, plane);
    // So that no square leaves float's range, in whatever unit of length.
    const real largest = 1.0f / fmax(fmax(fabs(normal.x), fabs(normal.y)), fmax(fabs(normal.z), FLT_MIN));
    normal.x = normal.x * largest;
    normal.y = normal.y * largest;
    normal.z = normal.z * largest;
    const real length = rsqrt(dot_(normal, normal));
    const real scale = select_(length, -length, dot_(normal, ray) > 0.0f);
    const lw_direction n = to_frame(frame, normal);
    return pack_normal(n.x * scale, n.y * scale, n.z * scale);
}

// One work-item = a block of LW_WIDTH texels of the maps one below the other: distance, normal and albedo of what each
// texel's ray meets first. Triangles' planes are `stride` floats apart. `size` texels a side: a multiple of 16.
__kernel void paraboloid_map_trace(__global const float* triangles, int stride, __global const float* nodes,
                                   int hasTriangles, __global const lw_paraboloid* frames,
                                   __global const int* states, int mapCount, int size, __global uint* records,
                                   __global uint* albedo) {
    const int column = (int)get_global_id(0) * LW_BLOCK_COLUMNS, row = (int)get_global_id(1) * LW_BLOCK_ROWS;
    const int map = row / size;
    if (column >= size || map >= mapCount || !(states[map] & LW_MAP_STALE)) return;
    const lanei x = (lanei_iota() & (LW_BLOCK_COLUMNS - 1)) + column, y = lanei_iota() / LW_BLOCK_COLUMNS + row % size;
    real distance = INFINITY;
    laneu normal = 0, colour = 0;
    if (states[map] & LW_MAP_DRAWN && hasTriangles) {
        const lw_paraboloid frame = frames[map];
        lw_packet p;
        set_packet(&p, frame, paraboloid_step(size), x, y, (float)column + 0.5f * (LW_BLOCK_COLUMNS - 1),
                   (float)(row % size) + 0.5f * (LW_BLOCK_ROWS - 1));
        lw_nearest n = {select_((real)(0.0f), (real)(INFINITY), p.inside), (lanei)(-1), INFINITY};
        if (any_(p.inside)) trace(&n, &p, triangles, stride, nodes, frame.origin);
        const mask hit = n.triangle >= 0;
        if (any_(hit)) {
            const lanei t = selecti_((lanei)(0), n.triangle, hit);
            const lw_direction rgb = gather3(triangles, stride, LW_TRIANGLE_ALBEDO, t);
            distance = select_(distance, n.distance, hit);
            normal = selectu_(normal, normal_word(frame, triangles, stride, t, p.ray), hit);
            colour = selectu_(colour, pack_albedo(rgb.x, rgb.y, rgb.z), hit);
        }
    }
    const lanei at = map * size * size + y * size + x;
    scatter(distance, (__global float*)records, 2 * at);
    scatter(as_real_(normal), (__global float*)records, 2 * at + 1);
    scatter(as_real_(colour), (__global float*)albedo, at);
}

// One work-item = such a block. Where something that has changed, in boxes of the node `changes`, begins nearer than what
// the block's rays met, the map is stale: what came may be seen, and what went was. All else hides behind what is still there.
__kernel void paraboloid_map_notice(__global const float* changes, __global const lw_paraboloid* frames,
                                    __global const uint* records, int mapCount, int size, volatile __global int* states,
                                    volatile __global uint* counters) {
    const int column = (int)get_global_id(0) * LW_BLOCK_COLUMNS, row = (int)get_global_id(1) * LW_BLOCK_ROWS;
    const int map = row / size;
    if (column >= size || map >= mapCount || (states[map] & LW_MAP_STALE) || frames[map].origin.w == 0.0f) return;
    const lanei x = (lanei_iota() & (LW_BLOCK_COLUMNS - 1)) + column, y = lanei_iota() / LW_BLOCK_COLUMNS + row % size;
    lw_packet p;
    set_packet(&p, frames[map], paraboloid_step(size), x, y, (float)column + 0.5f * (LW_BLOCK_COLUMNS - 1),
               (float)(row % size) + 0.5f * (LW_BLOCK_ROWS - 1));
    if (!any_(p.inside)) return;
    const real met = gather((__global const float*)records, 2 * (map * size * size + y * size + x));
    const float limit = max_lane(select_((real)(0.0f), met * p.cosine, p.inside)) * LW_LIMIT_MARGIN;
    float begins[LW_TREE_CHILDREN];
    if (!children_inside(&p, changes, frames[map].origin, limit, begins)) return;
    if (!(atomic_or(states + map, LW_MAP_STALE | LW_MAP_DRAWN) & LW_MAP_STALE)) atomic_inc(counters + LW_MAP_REDRAWN);
}
