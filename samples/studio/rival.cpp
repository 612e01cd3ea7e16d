// A frame of the rival: tiles of paths, filter, up-sampling, and the pixels that these leave over.
#include "rival.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "rival_filter.h"
#include "rival_paths.h"
#include "rival_scene.h"
#include "sampler.h"

namespace studio {
namespace {

using Clock = std::chrono::steady_clock;

// Pixels that no neighbour on their surface could light take this many times the paths: they are few,
// and nothing smooths them.
constexpr std::uint32_t kLeftOverPaths = 4;
// A normal estimated from neighbouring positions is believed within this cosine of the shading normal.
constexpr float kFaceCosine = 0.6f;

double millisecondsSince(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// Bits of x and y in turn: neighbours in both directions stay neighbours.
std::uint32_t morton(std::uint32_t x, std::uint32_t y) {
    const auto spread = [](std::uint32_t v) {
        v = (v | (v << 8)) & 0x00ff00ffu;
        v = (v | (v << 4)) & 0x0f0f0f0fu;
        v = (v | (v << 2)) & 0x33333333u;
        return (v | (v << 1)) & 0x55555555u;
    };
    return spread(x) | (spread(y) << 1);
}

// The side of the surface that the G-buffer shows, from the positions beside the pixel; `position` and
// `normal` are the pixel's. Its shading normal where the neighbours belong to something else.
glm::vec3 faceAt(const GBuffer& g, int x, int y, const glm::vec3& position, const glm::vec3& normal) {
    const auto step = [&](int dx, int dy) {
        glm::vec3 best(0.0f);
        float flattest = 0.7f;
        for (const int sign : {1, -1}) {
            const int nx = x + sign * dx, ny = y + sign * dy;
            if (nx < 0 || ny < 0 || nx >= g.width || ny >= g.height) continue;
            if (g.normal.rgb(nx, ny) == glm::vec3(0.0f)) continue;
            const glm::vec3 way = float(sign) * (g.position.rgb(nx, ny) - position);
            const float slope = std::abs(glm::dot(way, normal)) / (glm::length(way) + 1e-30f);
            if (slope < flattest) flattest = slope, best = way;
        }
        return best;
    };
    const glm::vec3 face = glm::cross(step(1, 0), step(0, 1));
    const float length = glm::length(face);
    if (!(length > 0.0f)) return normal;
    const float cosine = glm::dot(face, normal) / length;
    return std::abs(cosine) > kFaceCosine ? face * ((cosine < 0.0f ? -1.0f : 1.0f) / length) : normal;
}

void require(bool isTrue, const char* name, const char* expectation, std::uint64_t came) {
    if (isTrue) return;
    throw std::invalid_argument(std::string("rival: ") + name + ": expected " + expectation + ", got " +
                                std::to_string(came));
}

}  // namespace

struct Rival::Impl {
    RivalOptions options;
    int factor, width, height;  // of the traced image
    int tileSide;
    WorkerPool pool;
    std::unique_ptr<RivalScene> scene;
    std::vector<PixelPlace> order;  // of a tile's pixels
    struct Worker {
        std::unique_ptr<PathBatch> batch = std::make_unique<PathBatch>();
        RivalPaths paths;
        std::vector<float> sums[3];
        Worker(const RivalOptions& o) : paths(int(o.bounces), o.rays == RivalRays::Packets) {}
    };
    std::vector<Worker> workers;
    PlanarBuffer position, normal;  // of traced pixels, when not every pixel is
    PlanarBuffer images[2];

    Impl(const RivalOptions& o, int fullWidth, int fullHeight);
    PixelPlace sourceOf(const GBuffer& g, int x, int y) const;
    bool place(const GBuffer& g, const PixelPlace& pixel, PathBatch& batch, std::uint32_t index,
               int target);
    void traceTile(const GBuffer& g, int tile, Worker& worker, PlanarBuffer& to);
    void traceLeftOver(const GBuffer& g, const std::vector<PixelPlace>& pixels, PlanarBuffer& to);
};

Rival::Impl::Impl(const RivalOptions& o, int fullWidth, int fullHeight)
    : options(o), factor(1 << int(o.resolution)) {
    require(o.bounces == 1 || o.bounces == 2, "bounces", "1 or 2", o.bounces);
    require(o.spp >= 1, "spp", "at least 1", o.spp);
    require(o.pattern <= 8 && (o.pattern & (o.pattern - 1)) == 0, "pattern", "0, 1, 2, 4 or 8",
            o.pattern);
    width = (fullWidth + factor - 1) / factor;
    height = (fullHeight + factor - 1) / factor;
    tileSide = o.pattern == 8 ? 32 : 16;
    for (int i = 0; i < pool.threads(); ++i) {
        workers.emplace_back(o);
        for (auto& plane : workers.back().sums) plane.resize(std::size_t(tileSide * tileSide));
    }
    if (factor > 1) {
        position = PlanarBuffer(width, height, 3);
        normal = PlanarBuffer(width, height, 3);
    }
    for (PlanarBuffer& image : images) image = PlanarBuffer(width, height, 3);

    for (int y = 0; y < tileSide; ++y)
        for (int x = 0; x < tileSide; ++x) order.push_back({x, y});
    // Rays with the same sample point side by side; without a pattern, pixels near each other.
    const int n = int(o.pattern);
    const auto key = [n](const PixelPlace& p) {
        const std::uint32_t near = morton(std::uint32_t(p.x), std::uint32_t(p.y));
        return n == 0 ? near : (std::uint32_t(p.y % n * n + p.x % n) << 16) + near;
    };
    std::sort(order.begin(), order.end(),
              [&](const PixelPlace& a, const PixelPlace& b) { return key(a) < key(b); });
}

// The pixel that stands for its block: in the middle, or the first with a surface.
PixelPlace Rival::Impl::sourceOf(const GBuffer& g, int x, int y) const {
    const auto isSurface = [&](int px, int py) {
        return px < g.width && py < g.height && g.normal.rgb(px, py) != glm::vec3(0.0f);
    };
    const PixelPlace middle{x * factor + factor / 2, y * factor + factor / 2};
    if (isSurface(middle.x, middle.y)) return middle;
    for (int j = 0; j < factor; ++j)
        for (int i = 0; i < factor; ++i)
            if (isSurface(x * factor + i, y * factor + j)) return {x * factor + i, y * factor + j};
    return {-1, -1};
}

bool Rival::Impl::place(const GBuffer& g, const PixelPlace& pixel, PathBatch& batch, std::uint32_t index,
                        int target) {
    const glm::vec3 at = g.position.rgb(pixel.x, pixel.y), n = g.normal.rgb(pixel.x, pixel.y);
    const glm::vec3 face = faceAt(g, pixel.x, pixel.y, at, n);
    const glm::vec3 origin = scene->rays().offset(at, face);
    const int i = batch.count++;
    for (int c = 0; c < 3; ++c) {
        batch.position[c][i] = origin[c];
        batch.face[c][i] = face[c];
        batch.normal[c][i] = n[c];
        batch.throughput[c][i] = 1.0f;
    }
    batch.index[i] = index;
    batch.target[i] = target;
    return true;
}

void Rival::Impl::traceTile(const GBuffer& g, int tile, Worker& worker, PlanarBuffer& to) {
    const int across = (width + tileSide - 1) / tileSide;
    const int left = tile % across * tileSide, top = tile / across * tileSide;
    PathBatch& batch = *worker.batch;
    float* const sums[3] = {worker.sums[0].data(), worker.sums[1].data(), worker.sums[2].data()};
    for (auto& plane : worker.sums) std::fill(plane.begin(), plane.end(), 0.0f);
    const std::uint64_t seed = mixBits(options.seed);
    const int n = int(options.pattern);

    struct Traced {
        PixelPlace pixel;
        int target;
        std::uint32_t index;
    };
    std::vector<Traced> traced;
    for (const PixelPlace& inTile : order) {
        const int x = left + inTile.x, y = top + inTile.y;
        if (x >= width || y >= height) continue;
        const PixelPlace source = sourceOf(g, x, y);
        const bool isSurface = source.x >= 0;
        if (factor > 1) {
            position.setRgb(x, y, isSurface ? g.position.rgb(source.x, source.y) : glm::vec3(0.0f));
            normal.setRgb(x, y, isSurface ? g.normal.rgb(source.x, source.y) : glm::vec3(0.0f));
        }
        if (!isSurface) continue;
        const std::uint32_t index = n == 0 ? morton(std::uint32_t(x), std::uint32_t(y))
                                           : morton(std::uint32_t(x % n), std::uint32_t(y % n));
        traced.push_back({source, inTile.y * tileSide + inTile.x, index});
    }
    // As many samples at a time as the batch holds; the surface is looked up once for each.
    const auto fits =
        std::max<std::size_t>(1, PathBatch::kSize / std::max<std::size_t>(1, traced.size()));
    for (std::uint32_t s = 0; s < options.spp;) {
        batch.count = 0;
        for (std::size_t j = 0; j < fits && s < options.spp; ++j, ++s)
            for (const Traced& each : traced)
                place(g, each.pixel, batch, each.index * options.spp + s, each.target);
        worker.paths.trace(*scene, seed, batch, sums);
    }
    const float perSample = 1.0f / float(options.spp);
    for (int y = 0; y < tileSide && top + y < height; ++y)
        for (int x = 0; x < tileSide && left + x < width; ++x) {
            const std::size_t at = std::size_t(y * tileSide + x);
            to.setRgb(left + x, top + y,
                      glm::vec3(worker.sums[0][at], worker.sums[1][at], worker.sums[2][at]) * perSample);
        }
}

void Rival::Impl::traceLeftOver(const GBuffer& g, const std::vector<PixelPlace>& pixels,
                                PlanarBuffer& to) {
    const std::uint32_t spp = options.spp * kLeftOverPaths;
    const std::size_t perJob = 16;
    pool.run((pixels.size() + perJob - 1) / perJob, [&](std::size_t job, int thread) {
        Worker& worker = workers[std::size_t(thread)];
        PathBatch& batch = *worker.batch;
        float* const sums[3] = {worker.sums[0].data(), worker.sums[1].data(), worker.sums[2].data()};
        for (auto& plane : worker.sums) std::fill(plane.begin(), plane.end(), 0.0f);
        const std::size_t first = job * perJob, last = std::min(first + perJob, pixels.size());
        for (std::uint32_t s = 0; s < spp;) {
            batch.count = 0;
            for (; s < spp && batch.count + int(perJob) <= PathBatch::kSize; ++s)
                for (std::size_t i = first; i < last; ++i) {
                    const PixelPlace& p = pixels[i];
                    const std::uint32_t index = morton(std::uint32_t(p.x), std::uint32_t(p.y));
                    place(g, p, batch, index * spp + s, int(i - first));
                }
            worker.paths.trace(*scene, mixBits(options.seed), batch, sums);
        }
        for (std::size_t i = first; i < last; ++i) {
            const std::size_t at = i - first;
            to.setRgb(
                pixels[i].x, pixels[i].y,
                glm::vec3(worker.sums[0][at], worker.sums[1][at], worker.sums[2][at]) / float(spp));
        }
    });
}

Rival::Rival(const RivalOptions& options, int width, int height)
    : impl_(std::make_unique<Impl>(options, width, height)) {}
Rival::~Rival() = default;

RivalTimes Rival::render(const RayScene& rayScene, const GBuffer& g, PlanarBuffer& irradiance,
                         PlanarBuffer& validity) {
    Impl& s = *impl_;
    if (s.scene == nullptr || &s.scene->rays() != &rayScene)
        s.scene = std::make_unique<RivalScene>(rayScene);
    RivalTimes times;
    Clock::time_point start = Clock::now();
    const Clock::time_point begin = start;
    const auto finishPass = [&](const char* name) {
        times.passes.emplace_back(name, millisecondsSince(start));
        start = Clock::now();
    };
    for (Impl::Worker& worker : s.workers) worker.paths.rays = worker.paths.shadowRays = 0;

    std::vector<std::vector<Tap>> windows;
    if (s.options.filter != 0) {
        if (s.options.pattern > 1) windows.push_back(patternWindow(int(s.options.pattern)));
        for (std::uint32_t level = 0; level < s.options.levels; ++level)
            windows.push_back(splineWindow(1 << level));
    }
    const bool isFull = s.factor == 1;
    PlanarBuffer* from = isFull && windows.empty() ? &irradiance : &s.images[0];
    const int across = (s.width + s.tileSide - 1) / s.tileSide;
    const int down = (s.height + s.tileSide - 1) / s.tileSide;
    s.pool.run(std::size_t(across * down), [&](std::size_t tile, int thread) {
        s.traceTile(g, int(tile), s.workers[std::size_t(thread)], *from);
    });
    finishPass("rival.trace");

    const SurfacePlanes full{&g.position, &g.normal};
    const SurfacePlanes traced = isFull ? full : SurfacePlanes{&s.position, &s.normal};
    for (std::size_t i = 0; i < windows.size(); ++i) {
        PlanarBuffer* to = isFull && i + 1 == windows.size() ? &irradiance
                           : from == &s.images[0]            ? &s.images[1]
                                                             : &s.images[0];
        filterImage(s.pool, traced, windows[i], *from, *to);
        from = to;
    }
    if (!windows.empty()) finishPass("rival.filter");
    if (!isFull) {
        const std::vector<PixelPlace> leftOver =
            upsampleImage(s.pool, s.factor, traced, *from, full, irradiance);
        finishPass("rival.upsample");
        s.traceLeftOver(g, leftOver, irradiance);
        finishPass("rival.left_over");
        times.leftOver = leftOver.size();
    }
    s.pool.run(std::size_t(g.height), [&](std::size_t y, int) {
        float* to = validity.row(0, int(y));
        const float *nx = g.normal.row(0, int(y)), *ny = g.normal.row(1, int(y)),
                    *nz = g.normal.row(2, int(y));
        for (int x = 0; x < g.width; ++x)
            to[x] = nx[x] != 0.0f || ny[x] != 0.0f || nz[x] != 0.0f ? 1.0f : 0.0f;
    });
    finishPass("rival.validity");
    times.total = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
    for (const Impl::Worker& worker : s.workers) {
        times.rays += worker.paths.rays;
        times.shadowRays += worker.paths.shadowRays;
    }
    return times;
}

std::uint64_t Rival::bytes() const {
    std::uint64_t sum = impl_->scene == nullptr ? 0 : impl_->scene->bytes();
    for (const PlanarBuffer* buffer :
         {&impl_->position, &impl_->normal, &impl_->images[0], &impl_->images[1]})
        sum += buffer->planeFloats() * std::size_t(buffer->planes()) * sizeof(float);
    return sum;
}

}  // namespace studio
