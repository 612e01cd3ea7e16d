// Which side of a surface a pixel shows is not in a G-buffer: smooth normals lean away from their
// triangles, and a ray between the two would start into the surface. The geometric normal is estimated
// from the positions beside the pixel.
#include "rival_tile.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "simd_clones.h"

namespace studio {
namespace {

// An estimated normal is believed within this cosine of the shading normal; a neighbour that rises more
// steeply from the tangent plane than kSlope belongs to another surface.
constexpr float kFaceCosine = 0.6f, kSlope = 0.7f;

// Bits of x and y in turn: neighbours in both directions stay neighbours.
std::uint32_t morton(int x, int y) {
    const auto spread = [](std::uint32_t v) {
        v = (v | (v << 8)) & 0x00ff00ffu;
        v = (v | (v << 4)) & 0x0f0f0f0fu;
        v = (v | (v << 2)) & 0x33333333u;
        return (v | (v << 1)) & 0x55555555u;
    };
    return spread(std::uint32_t(x)) | (spread(std::uint32_t(y)) << 1);
}

struct Vec {
    float x, y, z;
};
inline float dot(const Vec& a, const Vec& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Of the ways to both neighbours the one nearer to the tangent plane (the second turned round); zero
// when neither lies on the pixel's surface.
inline Vec alongSurface(const Vec& forth, const Vec& back, const Vec& normal) {
    const float fo = dot(forth, normal), bo = dot(back, normal);
    const float f2 = dot(forth, forth), b2 = dot(back, back);
    // off^2 / d^2 against each other, without the division; a way of no length is none.
    const float f = fo * fo * b2, b = bo * bo * f2;
    const bool goesForth = (f2 > 0.0f && f <= b) || b2 <= 0.0f;
    const float off = goesForth ? fo : bo, squared = goesForth ? f2 : b2;
    const float keep = off * off < kSlope * kSlope * squared ? 1.0f : 0.0f;
    const float forthShare = goesForth ? keep : 0.0f, backShare = goesForth ? 0.0f : -keep;
    return {forthShare * forth.x + backShare * back.x, forthShare * forth.y + backShare * back.y,
            forthShare * forth.z + backShare * back.z};
}

struct Planes {
    const float* at[3];
};

Planes rowOf(const PlanarBuffer& buffer, int y) {
    return {{buffer.row(0, y), buffer.row(1, y), buffer.row(2, y)}};
}

inline Vec load(const Planes& p, int x) {
    return {p.at[0][x], p.at[1][x], p.at[2][x]};
}
inline Vec way(const Planes& p, int x, const Vec& from, float unit) {
    return {(p.at[0][x] - from.x) * unit, (p.at[1][x] - from.y) * unit, (p.at[2][x] - from.z) * unit};
}

struct RowJob {
    Planes position, above, below, normal;
    int left, step, last;  // first pixel, pixels between, last column of the picture
    float floor;           // RayScene::offsetFloor
    float unit;            // ways times this: their fourth powers stay within floats in any scene
    float *p[3], *o[3], *f[3], *n[3];
};

STUDIO_SIMD void readPixels(const RowJob& job, int count) {
    float *px = job.p[0], *py = job.p[1], *pz = job.p[2];
    float *ox = job.o[0], *oy = job.o[1], *oz = job.o[2];
    float *fx = job.f[0], *fy = job.f[1], *fz = job.f[2];
    float *mx = job.n[0], *my = job.n[1], *mz = job.n[2];
    const Planes position = job.position, above = job.above, below = job.below, normals = job.normal;
    const int left = job.left, step = job.step, last = job.last;
    const float floor = job.floor, unit = job.unit;
#pragma GCC ivdep
    for (int i = 0; i < count; ++i) {
        int x = left + i * step;
        x = x < last ? x : last;
        const int right = x < last ? x + 1 : x, before = x > 0 ? x - 1 : x;
        const Vec at = load(position, x), normal = load(normals, x);
        const Vec u =
            alongSurface(way(position, right, at, unit), way(position, before, at, unit), normal);
        const Vec v = alongSurface(way(below, x, at, unit), way(above, x, at, unit), normal);
        Vec face = {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
        const float squared = dot(face, face), cosine = dot(face, normal);
        const bool isGood = cosine * cosine > kFaceCosine * kFaceCosine * squared;
        const float scale = (cosine < 0.0f ? -1.0f : 1.0f) / std::sqrt(isGood ? squared : 1.0f);
        face.x = isGood ? face.x * scale : normal.x;
        face.y = isGood ? face.y * scale : normal.y;
        face.z = isGood ? face.z * scale : normal.z;
        const float ax = std::abs(at.x), ay = std::abs(at.y), az = std::abs(at.z);
        float size = ax > ay ? ax : ay;
        size = size > az ? size : az;
        size = (size > floor ? size : floor) * RayScene::kRelativeOffset;
        px[i] = at.x, py[i] = at.y, pz[i] = at.z;
        ox[i] = at.x + size * face.x, oy[i] = at.y + size * face.y, oz[i] = at.z + size * face.z;
        fx[i] = face.x, fy[i] = face.y, fz[i] = face.z;
        mx[i] = normal.x, my[i] = normal.y, mz[i] = normal.z;
    }
}

}  // namespace

void TilePixels::readRow(const GBuffer& view, const TracedGrid& grid, int left, int count, int y,
                         float floor, Rows& to, int at) {
    const int row = std::min(y * grid.factor + grid.factor / 2, view.height - 1);
    RowJob job;
    job.position = rowOf(view.position, row);
    // Where the picture ends the way has no length and counts for none.
    job.above = rowOf(view.position, std::max(row - 1, 0));
    job.below = rowOf(view.position, std::min(row + 1, view.height - 1));
    job.normal = rowOf(view.normal, row);
    job.left = left * grid.factor + grid.factor / 2;
    job.step = grid.factor;
    job.last = view.width - 1;
    job.floor = floor;
    job.unit = std::exp2(-std::round(std::log2(floor)));  // a power of two: nothing is rounded
    for (int c = 0; c < 3; ++c) {
        job.p[c] = to.position[c] + at;
        job.o[c] = to.origin[c] + at;
        job.f[c] = to.face[c] + at;
        job.n[c] = to.normal[c] + at;
    }
    readPixels(job, count);
}

// A block whose middle shows no surface takes the first of its pixels that does.
void TilePixels::repair(const RayScene& scene, const GBuffer& view, const TracedGrid& grid, int x, int y,
                        Rows& to, int at) {
    for (int j = 0; j < grid.factor; ++j)
        for (int i = 0; i < grid.factor; ++i) {
            const int px = x * grid.factor + i, py = y * grid.factor + j;
            if (px >= view.width || py >= view.height) continue;
            const glm::vec3 normal = view.normal.rgb(px, py);
            if (normal == glm::vec3(0.0f)) continue;
            const glm::vec3 position = view.position.rgb(px, py);
            const glm::vec3 origin = scene.offset(position, normal);
            for (int c = 0; c < 3; ++c) {
                to.position[c][at] = position[c];
                to.origin[c][at] = origin[c];
                to.face[c][at] = to.normal[c][at] = normal[c];
            }
            return;
        }
}

void TilePixels::keep(const Rows& rows, int from, std::uint32_t pixelIndex, std::int32_t pixelTarget) {
    for (int c = 0; c < 3; ++c) {
        position[c][count] = rows.origin[c][from];
        face[c][count] = rows.face[c][from];
        normal[c][count] = rows.normal[c][from];
    }
    index[count] = pixelIndex;
    target[count] = pixelTarget;
    ++count;
}

void TilePixels::take(const RayScene& scene, const GBuffer& view, const TracedGrid& grid, int left,
                      int top, int side, int n, const std::vector<PixelPlace>& order,
                      TracedSurfaces& surfaces) {
    Rows rows;
    const int columns = std::min(side, grid.width - left), lines = std::min(side, grid.height - top);
    const auto isEmpty = [&](int at) {
        return rows.normal[0][at] == 0.0f && rows.normal[1][at] == 0.0f && rows.normal[2][at] == 0.0f;
    };
    for (int y = 0; y < lines; ++y) {
        readRow(view, grid, left, columns, top + y, scene.offsetFloor(), rows, y * side);
        if (grid.factor > 1)
            for (int x = 0; x < columns; ++x)
                if (isEmpty(y * side + x))
                    repair(scene, view, grid, left + x, top + y, rows, y * side + x);
        for (int c = 0; c < 3; ++c) {
            std::copy_n(rows.position[c] + y * side, columns, surfaces.position.row(c, top + y) + left);
            std::copy_n(rows.normal[c] + y * side, columns, surfaces.normal.row(c, top + y) + left);
        }
    }
    count = 0;
    for (const PixelPlace& p : order) {
        const int at = p.y * side + p.x;
        if (p.x >= columns || p.y >= lines || isEmpty(at)) continue;
        const int x = left + p.x, y = top + p.y;
        keep(rows, at, n == 0 ? morton(x, y) : morton(x % n, y % n), at);
    }
}

void TilePixels::take(const RayScene& scene, const GBuffer& view, const PixelPlace* pixels,
                      int pixelCount) {
    const TracedGrid every{1, view.width, view.height};
    Rows rows;
    count = 0;
    for (int i = 0; i < pixelCount; ++i) {
        readRow(view, every, pixels[i].x, 1, pixels[i].y, scene.offsetFloor(), rows, 0);
        keep(rows, 0, morton(pixels[i].x, pixels[i].y), i);
    }
}

void TilePixels::addTo(PathBatch& batch, std::uint32_t perPixel, std::uint32_t sample,
                       std::int32_t targetShift) const {
    const int at = batch.count;
    const std::size_t bytes = std::size_t(count) * sizeof(float);
    for (int c = 0; c < 3; ++c) {
        std::memcpy(batch.position[c] + at, position[c], bytes);
        std::memcpy(batch.face[c] + at, face[c], bytes);
        std::memcpy(batch.normal[c] + at, normal[c], bytes);
        std::fill_n(batch.throughput[c] + at, count, 1.0f);
    }
    for (int i = 0; i < count; ++i) {
        batch.target[at + i] = target[i] + targetShift;
        batch.index[at + i] = index[i] * perPixel + sample;
    }
    batch.count += count;
}

}  // namespace studio
