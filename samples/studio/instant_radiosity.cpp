// Photons, and the gather from their VPLs: rows of pixels, one VPL after the other.
#include "instant_radiosity.h"

#include <time.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "light_rays.h"
#include "parallel.h"
#include "photon_gather.h"
#include "sampler.h"
#include "worker_pool.h"

namespace studio {
namespace {

using Clock = std::chrono::steady_clock;

// The library's bound on the cosine between light and surface (LW_MIN_LIGHT_COSINE): without it a grazing
// photon would stand for any area, and be bounded away.
constexpr float kLeastCosine = 0.05f;
constexpr std::uint64_t kTurnStream = 0x7068u;  // of the seed's turn of the pattern; any
constexpr std::uint32_t kMostPhotons = 1u << 20;

double millisecondsSince(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double processorMilliseconds() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e3 * double(time.tv_sec) + 1e-6 * double(time.tv_nsec);
}

// Hammersley's set, turned so that a single point is the middle of the square.
glm::dvec2 hammersley(std::uint32_t k, std::uint32_t count, const glm::dvec2& turn) {
    const glm::dvec2 point((double(k) + 0.5) / double(count),
                           double(reverseBits(k)) / 4294967296.0 + 0.5);
    return glm::fract(point + turn);
}

bool trace(const RayScene& scene, const LightRays& rays, const glm::dvec2& square, double measure,
           VplRecord& vpl) {
    const LightRay ray = rays.at(square);
    const glm::vec3 incident = rays.strength(ray) * float(measure);
    Hit hit;
    if (incident == glm::vec3(0.0f) ||
        !scene.trace(ray.origin, ray.direction, 0.0f, std::numeric_limits<float>::infinity(), hit))
        return false;
    vpl.position = hit.position;
    // The lit side: an interpolated normal can lean away from a light that its face sees.
    vpl.normal = glm::dot(hit.normal, ray.direction) < 0.0f ? hit.normal : hit.geometricNormal;
    vpl.flux = hit.albedo * incident;
    const float cosine = std::max(-glm::dot(vpl.normal, ray.direction), kLeastCosine);
    vpl.area = float(measure / rays.measurePerArea(double(hit.distance)) / double(cosine));
    return vpl.flux != glm::vec3(0.0f);
}

void requireSize(const char* name, const GBuffer& g, const PlanarBuffer& buffer) {
    if (buffer.width() == g.width && buffer.height() == g.height) return;
    throw std::invalid_argument(fmt::format("instant_radiosity: {}: expected {} x {} pixels, got {} x {}",
                                            name, g.width, g.height, buffer.width(), buffer.height()));
}

}  // namespace

std::vector<VplRecord> tracePhotons(const RayScene& scene, std::uint32_t perLight, std::uint32_t seed) {
    glm::dvec2 turn(0.0);
    if (seed != 0) turn = Sampler(seed, kTurnStream, 0).nextFine();
    std::vector<VplRecord> vpls;
    for (const Light& light : scene.lights()) {
        const LightRays rays(scene, light);
        for (std::uint32_t k = 0; k < perLight; ++k) {
            VplRecord vpl{};
            if (trace(scene, rays, hammersley(k, perLight, turn), rays.measure() / perLight, vpl))
                vpls.push_back(vpl);
        }
    }
    return vpls;
}

struct InstantRadiosity::Impl {
    InstantRadiosityOptions options;
    WorkerPool pool;
    std::vector<PhotonGather> rows{std::size_t(pool.threads())};  // a worker's row of pixels
    std::vector<VplRecord> vpls;
};

InstantRadiosity::InstantRadiosity(const InstantRadiosityOptions& options)
    : impl_(std::make_unique<Impl>()) {
    if (options.vpls < 1 || options.vpls > kMostPhotons)
        throw std::invalid_argument(fmt::format("instant_radiosity: vpls: expected 1 .. {}, got {}",
                                                kMostPhotons, options.vpls));
    if (options.shadows > 1)
        throw std::invalid_argument(
            fmt::format("instant_radiosity: shadows: expected 0 or 1, got {}", options.shadows));
    impl_->options = options;
}

InstantRadiosity::~InstantRadiosity() = default;

InstantRadiosityTimes InstantRadiosity::render(const RayScene& scene, const GBuffer& gbuffer,
                                               PlanarBuffer& irradiance, PlanarBuffer& validity) {
    requireSize("irradiance", gbuffer, irradiance);
    requireSize("validity", gbuffer, validity);
    Impl& s = *impl_;
    const Clock::time_point start = Clock::now();
    const double processorStart = processorMilliseconds();
    s.vpls = tracePhotons(scene, s.options.vpls, s.options.seed);
    const double traced = millisecondsSince(start);

    std::atomic<std::uint64_t> shadowRays{0};
    s.pool.run(std::size_t(gbuffer.height), [&](std::size_t item, int thread) {
        const int y = int(item);
        PhotonGather& row = s.rows[std::size_t(thread)];
        row.begin(gbuffer, y);
        for (const VplRecord& vpl : s.vpls) {
            if (!row.weigh(vpl)) continue;
            if (s.options.shadows != 0) shadowRays += row.shadow(scene, vpl);
            row.add(vpl);
        }
        row.end(irradiance, validity, y);
    });

    InstantRadiosityTimes times;
    times.total = millisecondsSince(start);
    times.passes = {{"instant_radiosity.trace", traced}, {"instant_radiosity.gather", times.total - traced}};
    times.processor = processorMilliseconds() - processorStart;
    times.photons = std::uint64_t(s.options.vpls) * scene.lights().size();
    times.shadowRays = shadowRays;
    return times;
}

const std::vector<VplRecord>& InstantRadiosity::vpls() const {
    return impl_->vpls;
}

std::uint64_t InstantRadiosity::bytes() const {
    std::uint64_t sum = impl_->vpls.capacity() * sizeof(VplRecord);
    for (const PhotonGather& row : impl_->rows) sum += row.bytes();
    return sum;
}

}  // namespace studio
