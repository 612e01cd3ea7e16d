#include "probe_grid.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace cli {
namespace {

constexpr float kY0 = 0.28209479f, kY1 = 0.48860251f, kPi = 3.14159265f;

LWImage listOf(std::vector<float>& values, std::uint32_t count, std::uint32_t rows, LWFormat format) {
    LWImage image{};
    image.host = values.data();
    image.format = format;
    image.width = count;
    image.height = rows;
    return image;
}

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
    return values[values.size() / 2];
}

template <class F>
double timed(const lightwell::Device& device, F&& call) {
    const auto start = std::chrono::steady_clock::now();
    call();
    lightwell::check(lwFinish(device.get()), device.get());
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

glm::vec3 irradianceOf(const Probe& probe, const glm::vec3& normal) {
    const auto& b = probe.bands;
    return glm::max(kPi * kY0 * b[0] +
                        2.0f * kPi / 3.0f * kY1 * (b[1] * normal.x + b[2] * normal.y + b[3] * normal.z),
                    0.0f);
}

float ProbeGrid::spacing() const {
    const glm::vec3 step = (high - low) / glm::vec3(counts);
    return 0.5f * std::min(step.x, std::min(step.y, step.z));
}

ProbeGrid makeProbes(const studio::Scene& scene, const glm::ivec3& counts) {
    ProbeGrid grid;
    scene.bounds(grid.low, grid.high);
    grid.counts = counts;
    for (int z = 0; z < counts.z; ++z)
        for (int y = 0; y < counts.y; ++y)
            for (int x = 0; x < counts.x; ++x) {
                Probe probe;
                probe.position =
                    grid.low + (grid.high - grid.low) * (glm::vec3(x, y, z) + 0.5f) / glm::vec3(counts);
                grid.probes.push_back(probe);
            }
    return grid;
}

ProbeTimes lightProbes(const lightwell::Device& device, const Parameters& parameters,
                       const RenderInputs& inputs, int frames, bool withNormals, ProbeGrid& grid,
                       studio::PlanarBuffer* irradiance) {
    const Descriptor descriptor(device, parameters);
    lightwell::Technique technique(device, parameters.technique().c_str(), descriptor.get());
    lightwell::View view(device, std::uint32_t(inputs.gbuffer().width),
                         std::uint32_t(inputs.gbuffer().height));
    technique.prewarm(view);
    const LWSourceView source{view.get(), &inputs.lwGBuffer()};
    LWFrame frame = lightwell::make<LWFrame>();
    frame.lights = (parameters.tellsRsmVersions() ? inputs.versionedLights() : inputs.lights()).data();
    frame.lightCount = std::uint32_t(inputs.lights().size());
    frame.sourceViews = &source;
    frame.sourceViewCount = 1;
    frame.geometry = &inputs.geometry();
    std::copy_n(inputs.environment(), 3, frame.environment);
    frame.focus = inputs.focus();

    const auto count = std::uint32_t(grid.probes.size());
    std::vector<float> positions, normals, harmonics(12 * count), validity(count), surfaces(3 * count);
    for (const Probe& probe : grid.probes)
        for (int a = 0; a < 3; ++a) {
            positions.push_back(probe.position[a]);
            normals.push_back(a == 1 ? 1.0f : 0.0f);
        }
    const LWImage position = listOf(positions, count, 1, LW_FORMAT_FLOAT3),
                  normal = listOf(normals, count, 1, LW_FORMAT_FLOAT3);
    LWPointOutput output = lightwell::make<LWPointOutput>();
    output.harmonics = listOf(harmonics, count, 4, LW_FORMAT_FLOAT3);
    output.validity = listOf(validity, count, 1, LW_FORMAT_FLOAT1);
    if (withNormals) {
        output.irradiance = listOf(surfaces, count, 1, LW_FORMAT_FLOAT3);
        output.harmonics = LWImage{};
    }
    ProbeTimes times;
    std::vector<double> updates, points;
    for (int i = 0; i < frames; ++i) {
        frame.frameIndex = std::uint64_t(i);
        frame.reset = i == 0 ? 1 : 0;
        updates.push_back(timed(device, [&] { technique.update(frame); }));
        points.push_back(timed(device, [&] {
            technique.renderPoints(position, withNormals ? &normal : nullptr, count, output);
        }));
    }
    times.updateMilliseconds = median(updates);
    times.pointsMilliseconds = median(points);
    const LWStats stats = technique.stats();
    times.deviceBytes = stats.deviceBytes;
    for (std::uint32_t i = 0; i < stats.countCount; ++i)
        times.counts.emplace_back(stats.counts[i].name, stats.counts[i].value);
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t b = 0; b < 4; ++b)
            for (int c = 0; c < 3; ++c)
                grid.probes[i].bands[b][c] = harmonics[3 * (b * count + i) + std::size_t(c)];
        grid.probes[i].validity = validity[i];
    }
    if (!irradiance) return times;
    *irradiance = studio::PlanarBuffer(inputs.gbuffer().width, inputs.gbuffer().height, 3);
    LWOutput picture = lightwell::make<LWOutput>();
    picture.irradiance = describePlanes(*irradiance);
    timed(device, [&] { technique.render(view, inputs.lwGBuffer(), picture); });
    return times;
}

}  // namespace cli
