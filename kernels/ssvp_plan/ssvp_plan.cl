// How much a frame of technique ssvp needs: VPLs by the effective sample size of the light, clusters by the objective of
// k-means, bounces by the flux that the next would add. All of it stays on the device, where the next kernels read it; what
// is decided depends on the frames before and on nothing else, so the same frames have the same bits.
//
// Every choice has a dead band between what makes it rise and what makes it fall: without one, light that moves slowly
// would switch to and fro between two counts, and each switch is seen.
#include "shared/cluster_types.h"
#include "shared/kmeans_types.h"
#include "shared/ssvp_plan_types.h"
#include "shared/vpl_list.h"
#include "shared/wide.h"

#define LW_PLAN_GROUP 64
// How much light varies from VPL to VPL as a pixel sees it: standard deviation by mean. 90 of 256 VPLs change the pictures
// of the Cornell box and of the rooms by 0.17 and 0.18; light of a small patch next to what it lights varies more,
// and the target is then missed, as it is by the 256 themselves.
#define LW_LIGHT_VARIATION 1.5f
// A count of VPLs stays while what is needed lies between 1 / LW_VPLS_BAND of it and all of it; a new one has
// LW_VPLS_ROOM more than is needed, so that it does not lie at the band's end.
#define LW_VPLS_BAND 1.5f
#define LW_VPLS_ROOM 1.2f
// Clusters are merged up to this share of the objective that makes them grow; a bounce in use is dropped below this
// share of the flux that brings it in.
#define LW_CLUSTERS_BAND 0.8f
#define LW_BOUNCE_BAND 0.7f

// One work-item = one row of texels: the sum of the squares of its texels' shares in the row's flux, which are the
// differences of its cumulative sums.
__kernel void ssvp_plan_rows(__global const float* texelSums, __global const int4* rows, int rowCount,
                             __global const float* rowTotals, __global float* rowSquares) {
    const int r = lw_list_index();
    if (r >= rowCount) return;
    const float total = rowTotals[r], scale = total > 0.0f ? 1.0f / total : 0.0f;
    __global const float* sums = texelSums + rows[r].x;
    float before = 0.0f, squares = 0.0f;
    for (int i = 0; i < rows[r].y; ++i) {
        const float share = (sums[i] - before) * scale;
        squares += share * share;
        before = sums[i];
    }
    // A total near the ends of float's range has no inverse; its row then counts as one texel.
    rowSquares[r] = total > 0.0f ? (isfinite(squares) && squares > 0.0f ? fmin(squares, 1.0f) : 1.0f) : 0.0f;
}

// One work-item. Effective sample size of the light (Kish 1965): (sum w)^2 / sum w^2, the number of texels of equal flux
// that would vary as much.
__kernel void ssvp_plan_vpls(__global const float* rowTotals, __global const float* rowSquares, int rowCount, int most,
                             float error, int restart, __global int* plan) {
    if (get_global_id(0) != 0) return;
    float total = 0.0f, inverse = 0.0f;
    for (int r = 0; r < rowCount; ++r) total += rowTotals[r];
    for (int r = 0; r < rowCount && total > 0.0f; ++r) {
        const float share = rowTotals[r] / total;
        inverse += share * share * rowSquares[r];
    }
    // N samples err by v / sqrt(N), v the variation. Of a light of n places those of more than n samples that are spread
    // evenly fall on the same ones again: what remains is how the last are shared out, v sqrt(n) / N. Both are equal
    // where N = n.
    const float places = inverse > 0.0f ? 1.0f / inverse : 1.0f;
    const float root = LW_LIGHT_VARIATION / error, byTarget = root * root, byLight = sqrt(places) * root;
    const float needed = ceil(fmin(byTarget, byLight));
    const int before = restart ? most : plan[LW_PLAN_VPLS];
    int used = before;
    if (!restart && (needed > (float)before || needed * LW_VPLS_BAND < (float)before))
        used = (int)fmin((float)most, ceil(needed * LW_VPLS_ROOM));
    plan[LW_PLAN_VPLS] = used;
    plan[LW_PLAN_WHY_VPLS] = restart        ? LW_WHY_FIRST
                             : used == most ? LW_WHY_MOST
                             : byLight < byTarget ? LW_WHY_LIGHT
                                                  : LW_WHY_TARGET;
}

typedef struct {
    float x, y, z, nx, ny, nz, members;
} lw_part;

LW_FN lw_part part_at(__local const float* parts, int k) {
    lw_part p;
    p.x = parts[k];
    p.y = parts[LW_PLAN_GROUP + k];
    p.z = parts[2 * LW_PLAN_GROUP + k];
    p.nx = parts[3 * LW_PLAN_GROUP + k];
    p.ny = parts[4 * LW_PLAN_GROUP + k];
    p.nz = parts[5 * LW_PLAN_GROUP + k];
    p.members = parts[6 * LW_PLAN_GROUP + k];
    return p;
}

LW_FN void store_part(lw_part p, __local float* parts, int k) {
    const float values[7] = {p.x, p.y, p.z, p.nx, p.ny, p.nz, p.members};
    for (int c = 0; c < 7; ++c) parts[c * LW_PLAN_GROUP + k] = values[c];
}

// A cluster in the frame of k-means, `scale` being the inverse of its diagonal.
LW_FN lw_part part_of(lw_cluster c, __global const float* frame, float scale) {
    lw_part p;
    p.x = (c.position.x - frame[0]) * scale;
    p.y = (c.position.y - frame[1]) * scale;
    p.z = (c.position.z - frame[2]) * scale;
    p.nx = c.normal.x;
    p.ny = c.normal.y;
    p.nz = c.normal.z;
    p.members = c.position.w;
    return p;
}

// What the objective of k-means grows by when two clusters become one (Ward 1963): exact in the positions, and no less
// than it is in the normals, whose sum is taken to be as long as there are members.
LW_FN float merged_increase(lw_part a, lw_part b, float2 weights) {
    const float dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
    const float ex = a.nx - b.nx, ey = a.ny - b.ny, ez = a.nz - b.nz;
    const float members = a.members + b.members, product = a.members * b.members;
    const float square = ex * ex + ey * ey + ez * ez;
    // |A n + B m|^2 = (A + B)^2 - A B |n - m|^2 of unit vectors; the difference of the two lengths by their squares.
    const float length = sqrt(fmax(members * members - product * square, 0.0f));
    return weights.x * (dx * dx + dy * dy + dz * dz) * product / members + weights.y * product * square / (members + length);
}

LW_FN lw_part merged(lw_part a, lw_part b) {
    lw_part m;
    m.members = a.members + b.members;
    m.x = (a.x * a.members + b.x * b.members) / m.members;
    m.y = (a.y * a.members + b.y * b.members) / m.members;
    m.z = (a.z * a.members + b.z * b.members) / m.members;
    m.nx = a.nx * a.members + b.nx * b.members;
    m.ny = a.ny * a.members + b.ny * b.members;
    m.nz = a.nz * a.members + b.nz * b.members;
    const float length = sqrt(m.nx * m.nx + m.ny * m.ny + m.nz * m.nz);
    if (length > 1e-6f * m.members) {
        m.nx /= length;
        m.ny /= length;
        m.nz /= length;
    } else {  // opposite ones: any is as good as another
        m.nx = a.nx;
        m.ny = a.ny;
        m.nz = a.nz;
    }
    return m;
}

// Merges the two clusters that raise the objective least, again and again, up to `limit`. Of several pairs the first.
LW_FN void merge_clusters(__local float* parts, __local float* keys, __local int* partners, int clusters, float2 weights,
                          float objective, float limit) {
    const int k = (int)get_local_id(0);
    for (int round = 1; round < clusters; ++round) {
        const lw_part mine = part_at(parts, k);
        float best = LW_KMEANS_FAR;
        int partner = -1;
        for (int j = k + 1; j < clusters && mine.members > 0.0f; ++j) {
            const lw_part other = part_at(parts, j);
            if (!(other.members > 0.0f)) continue;
            const float increase = merged_increase(mine, other, weights);
            if (increase < best) {
                best = increase;
                partner = j;
            }
        }
        keys[k] = best;
        partners[k] = partner;
        barrier(CLK_LOCAL_MEM_FENCE);
        int first = 0;
        for (int j = 1; j < clusters; ++j)
            if (keys[j] < keys[first]) first = j;
        objective += keys[first];
        if (!(objective <= limit)) return;  // all work-items alike
        barrier(CLK_LOCAL_MEM_FENCE);
        if (k == 0) {
            store_part(merged(part_at(parts, first), part_at(parts, partners[first])), parts, first);
            parts[6 * LW_PLAN_GROUP + partners[first]] = 0.0f;
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}

// One work-group of LW_PLAN_GROUP work-items in all, one per cluster. Which clusters the next frame uses, and where they
// start: `seeds`. The mean of the members' squared distances is held against `spread`, its most.
//
// In a still scene this comes to rest. Counts rise only while the mean is above `spread`; merging leaves it at
// LW_CLUSTERS_BAND of that or below, and from there Lloyd's iteration never raises it: after the first merge nothing
// grows, and what only falls ends.
__kernel void ssvp_plan_clusters(__global const lw_cluster* clusters, int count, __global const float* frame, float2 weights,
                                 float spread, int restart, int reports, __global uint* dead, __global lw_cluster* seeds,
                                 __global int* plan) {
    __local float parts[7 * LW_PLAN_GROUP], keys[LW_PLAN_GROUP];
    __local int partners[LW_PLAN_GROUP];
    const int k = (int)get_local_id(0);
    const float d = frame[LW_KMEANS_DIAGONAL], scale = d > 0.0f ? 1.0f / d : 0.0f;
    lw_part own = {0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f};
    float mySpread = 0.0f;
    if (k < count && clusters[k].position.w > 0.0f) {
        own = part_of(clusters[k], frame, scale);
        mySpread = clusters[k].normal.w;
    }
    store_part(own, parts, k);
    keys[k] = mySpread;
    const uint deadWords[LW_DEAD_WORDS] = {restart ? 0u : dead[0], restart ? 0u : dead[1]};
    barrier(CLK_LOCAL_MEM_FENCE);
    float objective = 0.0f, members = 0.0f;
    int used = 0, alive = 0;
    for (int j = 0; j < count; ++j) {
        objective += keys[j];
        members += parts[6 * LW_PLAN_GROUP + j];
        used += parts[6 * LW_PLAN_GROUP + j] > 0.0f;
        alive += !((deadWords[j >> 5] >> (j & 31)) & 1u);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    const int grows = objective > spread * members;
    // In two dimensions the mean falls with the number of clusters; doubling at most keeps it from going far beyond.
    const float wanted = grows ? ceil((float)alive * fmin(objective / (spread * members), 2.0f)) : 0.0f;
    if (!grows) merge_clusters(parts, keys, partners, count, weights, objective, LW_CLUSTERS_BAND * spread * members);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (k < count) {
        const lw_part p = part_at(parts, k);
        lw_cluster seed = clusters[k];
        seed.position = (float4)(p.x * d + frame[0], p.y * d + frame[1], p.z * d + frame[2], p.members);
        seed.normal = (float4)(p.nx, p.ny, p.nz, 0.0f);
        seeds[k] = seed;
    }
    if (k != 0) return;
    uint words[LW_DEAD_WORDS] = {0u, 0u};
    // Without light nothing is known of what comes: all may be used again.
    for (int j = 0, more = (int)wanted - alive; j < count && members > 0.0f; ++j) {
        int isDead = grows ? (int)((deadWords[j >> 5] >> (j & 31)) & 1u) : !(parts[6 * LW_PLAN_GROUP + j] > 0.0f);
        if (grows && isDead && more > 0) {
            isDead = 0;
            --more;
        }
        words[j >> 5] |= (uint)isDead << (j & 31);
    }
    dead[0] = words[0];
    dead[1] = words[1];
    if (!reports) return;
    plan[LW_PLAN_CLUSTERS] = used;
    plan[LW_PLAN_WHY_CLUSTERS] = restart ? LW_WHY_FIRST : used == count ? LW_WHY_MOST : LW_WHY_TARGET;
}

LW_FN float mean_flux(float4 flux) { return (flux.x + flux.y + flux.z) * (1.0f / 3.0f); }

// One work-group of LW_PLAN_GROUP work-items in all: whether a bounce is used. vpls: its own, `perCluster` of each of the
// `clusters` of the bounce before; `index`: 0 for the second bounce; `left`: bounces from this one on.
//
// What a picture shows of a bounce is the flux that arrives on surfaces: a sample that met one stands for its part of
// its cluster's. (What is sent says less: of sunlight on open ground most goes to the sky, and what the rest lights is all that
// there is to see. Samples are taken for alike, as by cosine they are.)
__kernel void ssvp_plan_bounce(__global const lw_cluster* clusters, int perCluster, __global lw_vpl* vpls, int count,
                               int index, int left, float error, int restart, __global int* plan) {
    __local float arrivals[LW_PLAN_GROUP], reflections[LW_PLAN_GROUP];
    __local int uses;
    const int item = (int)get_local_id(0);
    float arriving = 0.0f, reflecting = 0.0f;
    for (int i = item; i < count; i += LW_PLAN_GROUP) {
        const float flux = mean_flux(vpls[i].flux);
        reflecting += flux;
        if (flux > 0.0f) arriving += mean_flux(clusters[i / perCluster].flux) / (float)perCluster;
    }
    arrivals[item] = arriving;
    reflections[item] = reflecting;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item == 0) {
        float arrived = 0.0f, next = 0.0f;
        for (int j = 0; j < LW_PLAN_GROUP; ++j) {
            arrived += arrivals[j];
            next += reflections[j];
        }
        const float so_far = (index ? as_float(plan[LW_PLAN_FLUX]) : 0.0f) + arrived;
        // What this bounce and all that follow it would bring, were nothing lost to the sky and reflectances the same.
        const float ratio = arrived > 0.0f ? next / arrived : 0.0f;
        float rest = 0.0f, share = next;
        for (int b = 0; b < left; ++b, share *= ratio) rest += share;
        const int used = restart || plan[LW_PLAN_USES + index];
        // Not by the quotient: without light it is none.
        uses = restart || rest > error * (used ? LW_BOUNCE_BAND : 1.0f) * (so_far + rest);
        plan[LW_PLAN_USES + index] = uses;
        plan[LW_PLAN_FLUX] = as_int(so_far);
        if (index == 0) {
            plan[LW_PLAN_BOUNCES] = 1;
            plan[LW_PLAN_WHY_BOUNCES] = LW_WHY_TARGET;
        }
        if (uses) plan[LW_PLAN_BOUNCES] = index + 2;
        if (uses && left == 1) plan[LW_PLAN_WHY_BOUNCES] = restart ? LW_WHY_FIRST : LW_WHY_MOST;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (uses) return;
    for (int i = item; i < count; i += LW_PLAN_GROUP) vpls[i] = no_vpl();
}
