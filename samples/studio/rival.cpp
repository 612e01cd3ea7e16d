// A frame of the rival: tiles of paths, filter, up-sampling, and the pixels that these leave over.
#include "rival.h"

#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "rival_filter.h"
#include "rival_paths.h"
#include "rival_scene.h"
#include "rival_shrink.h"
#include "rival_tile.h"
#include "sampler.h"

namespace studio {
namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double processorMilliseconds() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e3 * double(time.tv_sec) + 1e-6 * double(time.tv_nsec);
}

// Places that a picture shows, on a coarse grid.
std::vector<Surface> receiversOf(const GBuffer& g) {
    constexpr int kGrid = 16;
    std::vector<Surface> receivers;
    for (int j = 0; j < kGrid; ++j)
        for (int i = 0; i < kGrid; ++i) {
            const int x = (2 * i + 1) * g.width / (2 * kGrid), y = (2 * j + 1) * g.height / (2 * kGrid);
            const glm::vec3 normal = g.normal.rgb(x, y);
            if (normal != glm::vec3(0.0f)) receivers.push_back({g.position.rgb(x, y), normal, normal});
        }
    return receivers;
}

// Levels of the filter where the options leave them open. At half the resolution the traced image's next
// pixel is two pixels away, at a quarter four: reaching farther helps only where noise is all there is.
std::uint32_t filterLevels(const RivalOptions& options) {
    if (options.levels != 0) return options.levels;
    if (options.resolution == RivalResolution::Quarter) return 2;
    return options.resolution == RivalResolution::Half && options.spp >= 4 ? 2 : 3;
}

std::vector<std::vector<Tap>> filterWindows(const RivalOptions& options) {
    std::vector<std::vector<Tap>> windows;
    if (options.filter == 0) return windows;
    if (options.pattern > 1) windows.push_back(patternWindow(int(options.pattern)));
    for (std::uint32_t level = 0; level < filterLevels(options); ++level)
        windows.push_back(splineWindow(1 << level));
    return windows;
}

void require(bool isTrue, const char* name, const char* expectation, std::uint64_t came) {
    if (isTrue) return;
    throw std::invalid_argument(std::string("rival: ") + name + ": expected " + expectation + ", got " +
                                std::to_string(came));
}

void requireSize(const char* name, int width, int height, const PlanarBuffer& buffer) {
    if (buffer.width() == width && buffer.height() == height) return;
    throw std::invalid_argument("rival: " + std::string(name) + ": expected " + std::to_string(width) +
                                " x " + std::to_string(height) + " pixels, got " +
                                std::to_string(buffer.width()) + " x " +
                                std::to_string(buffer.height()));
}

}  // namespace

struct Rival::Impl {
    RivalOptions options;
    int pictureWidth, pictureHeight;
    TracedGrid grid;
    int tileSide;
    WorkerPool pool;
    std::unique_ptr<LitPoints> litPoints;  // of `scene`
    std::unique_ptr<RivalScene> scene;
    std::uint64_t sceneId = 0;      // of the RayScene that `scene` was made of
    std::vector<PixelPlace> order;  // of a tile's pixels
    struct Worker {
        std::unique_ptr<PathBatch> batch = std::make_unique<PathBatch>();
        std::unique_ptr<TilePixels> pixels = std::make_unique<TilePixels>();
        RivalPaths paths;
        std::vector<float> sums[3];
        Worker(const RivalOptions& o) : paths(int(o.bounces), o.rays == RivalRays::Packets) {}
    };
    std::vector<Worker> workers;
    TracedSurfaces surfaces;
    std::vector<std::vector<Tap>> windows;  // of the filter
    bool isGuided;                          // by the noise: two paths or more
    PaddedPlanes images[2];                 // where it is not
    ShrinkFilter shrink;                    // where it is

    Impl(const RivalOptions& o, int fullWidth, int fullHeight);
    // Sums of worker.pixels; those of the second half of the paths lie `halfShift` behind the first's.
    void tracePixels(Worker& worker, std::int32_t halfShift);
    void traceTile(const GBuffer& g, int tile, Worker& worker);
    const PaddedPlanes& filter();
    void writeOutput(const GBuffer& g, const PaddedPlanes& from, PlanarBuffer& irradiance,
                     PlanarBuffer& validity);
    void traceLeftOver(const GBuffer& g, const std::vector<PixelPlace>& pixels, PlanarBuffer& to);
};

Rival::Impl::Impl(const RivalOptions& o, int fullWidth, int fullHeight)
    : options(o), pictureWidth(fullWidth), pictureHeight(fullHeight) {
    const int factor = 1 << int(o.resolution);
    require(o.bounces == 1 || o.bounces == 2, "bounces", "1 or 2", o.bounces);
    require(o.levels <= 5, "levels", "0 to 5", o.levels);  // wider windows pass PaddedPlanes::kPad
    require(o.spp >= 1, "spp", "at least 1", o.spp);
    require(o.pattern <= 8 && (o.pattern & (o.pattern - 1)) == 0, "pattern", "0, 1, 2, 4 or 8",
            o.pattern);
    grid = {factor, (fullWidth + factor - 1) / factor, (fullHeight + factor - 1) / factor};
    tileSide = o.pattern == 8 ? 32 : 16;
    for (int i = 0; i < pool.threads(); ++i) {
        workers.emplace_back(o);
        for (auto& plane : workers.back().sums) plane.resize(std::size_t(2 * tileSide * tileSide));
    }
    surfaces = TracedSurfaces(grid.width, grid.height);
    windows = filterWindows(o);
    isGuided = !windows.empty() && o.spp > 1;
    if (isGuided)
        shrink = ShrinkFilter(grid.width, grid.height);
    else
        for (PaddedPlanes& image : images) image = PaddedPlanes(grid.width, grid.height, 3);

    for (int y = 0; y < tileSide; ++y)
        for (int x = 0; x < tileSide; ++x) order.push_back({x, y});
    // Rays with the same sample point side by side; without a pattern, pixels near each other.
    const int n = int(o.pattern);
    const auto key = [n](const PixelPlace& p) {
        const int within = p.y * 64 + p.x;
        return n == 0 ? (p.y / 4 * 64 + p.x / 4) * 64 + p.y % 4 * 4 + p.x % 4
                      : (p.y % n * n + p.x % n) * 4096 + within;
    };
    std::sort(order.begin(), order.end(),
              [&](const PixelPlace& a, const PixelPlace& b) { return key(a) < key(b); });
}

void Rival::Impl::tracePixels(Worker& worker, std::int32_t halfShift) {
    PathBatch& batch = *worker.batch;
    const TilePixels& pixels = *worker.pixels;
    for (auto& plane : worker.sums) std::fill(plane.begin(), plane.end(), 0.0f);
    if (pixels.count == 0) return;
    float* const sums[3] = {worker.sums[0].data(), worker.sums[1].data(), worker.sums[2].data()};
    for (std::uint32_t sample = 0; sample < options.spp;) {
        for (batch.count = 0; sample < options.spp && batch.count + pixels.count <= PathBatch::kSize;
             ++sample)
            pixels.addTo(batch, options.spp, sample, sample < options.spp / 2 ? 0 : halfShift);
        worker.paths.trace(*scene, litPoints.get(), mixBits(options.seed), batch, sums);
    }
}

void Rival::Impl::traceTile(const GBuffer& g, int tile, Worker& worker) {
    const int across = (grid.width + tileSide - 1) / tileSide;
    const int left = tile % across * tileSide, top = tile / across * tileSide;
    worker.pixels->take(scene->rays(), g, grid, left, top, tileSide, int(options.pattern), order,
                        surfaces);
    const int halfShift = isGuided ? tileSide * tileSide : 0;
    tracePixels(worker, halfShift);
    const int first = int(options.spp / 2), second = int(options.spp) - first;
    const float perSample = 1.0f / float(options.spp);
    PaddedPlanes& to = isGuided ? shrink.input() : images[0];
    for (int y = 0; y < tileSide && top + y < grid.height; ++y) {
        const int width = std::min(tileSide, grid.width - left);
        float* noise = isGuided ? to.row(ShrinkFilter::kNoisePlane, top + y) + left : nullptr;
        if (isGuided) std::fill_n(noise, width, 0.0f);
        for (int c = 0; c < 3; ++c) {
            const float* from = worker.sums[c].data() + y * tileSide;
            float* row = to.row(c, top + y) + left;
            if (!isGuided) {
                for (int x = 0; x < width; ++x) row[x] = from[x] * perSample;
                continue;
            }
            const float scale = ShrinkFilter::noiseScale(first, second) / 3.0f;
            const float perFirst = scale / float(first), perSecond = scale / float(second);
            for (int x = 0; x < width; ++x) {
                row[x] = (from[x] + from[x + halfShift]) * perSample;
                noise[x] += from[x] * perFirst - from[x + halfShift] * perSecond;
            }
        }
    }
}

const PaddedPlanes& Rival::Impl::filter() {
    if (isGuided) return shrink.filter(pool, surfaces, windows, int(options.spp));
    PaddedPlanes *from = &images[0], *to = &images[1];
    for (const std::vector<Tap>& window : windows) {
        filterImage(pool, surfaces, window, *from, *to);
        std::swap(from, to);
    }
    return *from;
}

void Rival::Impl::traceLeftOver(const GBuffer& g, const std::vector<PixelPlace>& pixels,
                                PlanarBuffer& to) {
    const std::uint32_t spp = options.spp;
    constexpr std::size_t kPerJob = 64;
    pool.run((pixels.size() + kPerJob - 1) / kPerJob, [&](std::size_t job, int thread) {
        Worker& worker = workers[std::size_t(thread)];
        const std::size_t first = job * kPerJob, count = std::min(kPerJob, pixels.size() - first);
        worker.pixels->take(scene->rays(), g, &pixels[first], int(count));
        tracePixels(worker, 0);
        for (std::size_t i = 0; i < count; ++i)
            for (int c = 0; c < 3; ++c)
                to.row(c, pixels[first + i].y)[pixels[first + i].x] = worker.sums[c][i] / float(spp);
    });
}

// Validity, and the irradiance of full resolution, which no up-sampling has written.
void Rival::Impl::writeOutput(const GBuffer& g, const PaddedPlanes& from, PlanarBuffer& irradiance,
                              PlanarBuffer& validity) {
    pool.run(std::size_t(g.height), [&](std::size_t row, int) {
        const int y = int(row);
        const float *nx = g.normal.row(0, y), *ny = g.normal.row(1, y), *nz = g.normal.row(2, y);
        float* valid = validity.row(0, y);
        for (int x = 0; x < g.width; ++x)
            valid[x] = nx[x] != 0.0f || ny[x] != 0.0f || nz[x] != 0.0f ? 1.0f : 0.0f;
        for (int c = 0; c < 3 && grid.factor == 1; ++c)
            std::copy_n(from.row(c, y), g.width, irradiance.row(c, y));
    });
}

Rival::Rival(const RivalOptions& options, int width, int height)
    : impl_(std::make_unique<Impl>(options, width, height)) {}
Rival::~Rival() = default;

RivalTimes Rival::render(const RayScene& rayScene, const GBuffer& g, PlanarBuffer& irradiance,
                         PlanarBuffer& validity) {
    Impl& s = *impl_;
    requireSize("position", s.pictureWidth, s.pictureHeight, g.position);
    requireSize("normal", s.pictureWidth, s.pictureHeight, g.normal);
    requireSize("irradiance", s.pictureWidth, s.pictureHeight, irradiance);
    requireSize("validity", s.pictureWidth, s.pictureHeight, validity);
    if (s.scene == nullptr || s.sceneId != rayScene.id()) {
        s.scene = std::make_unique<RivalScene>(rayScene);
        s.sceneId = rayScene.id();
        s.litPoints.reset();
        if (s.options.connect != 0 && !rayScene.lights().empty())
            s.litPoints = std::make_unique<LitPoints>(rayScene, receiversOf(g), true);
        if (s.litPoints != nullptr && s.litPoints->empty()) s.litPoints.reset();
    }
    RivalTimes times;
    Clock::time_point start = Clock::now();
    const Clock::time_point begin = start;
    const double processorBegin = processorMilliseconds();
    const auto finishPass = [&](const char* name) {
        times.passes.emplace_back(name, millisecondsSince(start));
        start = Clock::now();
    };
    for (Impl::Worker& worker : s.workers) worker.paths.rays = worker.paths.shadowRays = 0;

    const int across = (s.grid.width + s.tileSide - 1) / s.tileSide;
    const int down = (s.grid.height + s.tileSide - 1) / s.tileSide;
    s.pool.run(std::size_t(across * down), [&](std::size_t tile, int thread) {
        s.traceTile(g, int(tile), s.workers[std::size_t(thread)]);
    });
    finishPass("rival.trace");

    const PaddedPlanes& traced = s.filter();
    if (!s.windows.empty()) finishPass("rival.filter");
    if (s.grid.factor > 1) {
        const std::vector<PixelPlace> leftOver =
            upsampleImage(s.pool, s.grid.factor, s.surfaces, traced, g, irradiance);
        finishPass("rival.upsample");
        s.traceLeftOver(g, leftOver, irradiance);
        finishPass("rival.left_over");
        times.leftOver = leftOver.size();
    }
    s.writeOutput(g, traced, irradiance, validity);
    finishPass("rival.output");
    times.total = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
    times.processor = processorMilliseconds() - processorBegin;
    for (const Impl::Worker& worker : s.workers) {
        times.rays += worker.paths.rays;
        times.shadowRays += worker.paths.shadowRays;
    }
    return times;
}

std::uint64_t Rival::bytes() const {
    std::uint64_t sum = impl_->scene == nullptr ? 0 : impl_->scene->bytes();
    sum += impl_->surfaces.position.bytes() + impl_->surfaces.normal.bytes();
    for (const PaddedPlanes& image : impl_->images) sum += image.bytes();
    sum += impl_->shrink.bytes();
    return sum;
}

}  // namespace studio
