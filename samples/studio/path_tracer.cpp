// The reference run: fills a film pass by pass, saves it, and makes the image of it.
//
// What one sample is stands in integrator.cpp, light from given VPLs in vpl_visibility.cpp, passes,
// stopping and checkpoints in reference_run.cpp.
#include "path_tracer.h"

#include <cmath>

#include <fmt/format.h>

#include "ambient_reference.h"
#include "integrator.h"
#include "noise.h"
#include "reference_run.h"
#include "specular_reference.h"
#include "vpl_visibility.h"

namespace studio {
namespace {

constexpr const char* kLayerNames[kLayerCount] = {"direct", "bounce1", "bounce2", "all"};
constexpr char kChannels[3] = {'R', 'G', 'B'};

void checkOptions(const GBuffer& view, const PathTracerOptions& o) {
    const auto text = [](auto value) { return fmt::format("{}", value); };
    requireOption(view.width > 0 && view.height > 0, "view", "at least one pixel",
                  fmt::format("{} x {}", view.width, view.height));
    requireOption(view.position.width() == view.width && view.position.height() == view.height &&
                      view.normal.width() == view.width && view.normal.height() == view.height,
                  "view", "position and normal of the view's size", "other sizes");
    requireOption(o.samplesPerPixel >= 2 && o.samplesPerPixel % 2 == 0, "samplesPerPixel",
                  "an even number of at least 2", text(o.samplesPerPixel));
    requireOption(o.untilRelMse >= 0.0 && std::isfinite(o.untilRelMse), "untilRelMse",
                  "0 or a positive number", text(o.untilRelMse));
    requireOption(o.untilRelMse == 0.0 || o.maxSamplesPerPixel >= o.samplesPerPixel,
                  "maxSamplesPerPixel", "at least samplesPerPixel", text(o.maxSamplesPerPixel));
    requireOption(o.maxBounces >= 1, "maxBounces", "at least 1", text(o.maxBounces));
    requireOption(o.threads >= 0, "threads", "0 (all) or more", text(o.threads));
    requireOption(o.vpls == nullptr || o.untilRelMse == 0.0, "untilRelMse",
                  "0 with VPLs, which have no noise", text(o.untilRelMse));
    requireOption(o.sendersSeenBy.empty() || o.vpls == nullptr, "sendersSeenBy",
                  "no pictures with VPLs, which are the senders", text(o.sendersSeenBy.size()));
    if (o.specular != nullptr) {
        requireOption(o.specular->roughness >= 0.0 && o.specular->roughness <= 1.0, "specular.roughness",
                      "0 to 1", text(o.specular->roughness));
        requireOption(
            o.vpls == nullptr && o.sendersSeenBy.empty() && !o.unshadowed && o.ambient == nullptr,
            "specular", "no VPLs, sendersSeenBy, unshadowed or ambient beside it", "one of them");
    }
    if (o.ambient == nullptr) return;
    requireOption(o.ambient->radius > 0.0 && std::isfinite(o.ambient->radius), "ambient.radius",
                  "a positive number", text(o.ambient->radius));
    requireOption(o.vpls == nullptr && o.sendersSeenBy.empty() && !o.unshadowed, "ambient",
                  "no VPLs, sendersSeenBy or unshadowed beside it", "one of them");
}

Film integratePaths(const RayScene& scene, const GBuffer& view, const PixelSurfaces& pixels,
                    const PathTracerOptions& options) {
    std::vector<std::string> layers(kLayerNames, kLayerNames + kLayerCount);
    const bool onlyFirst = options.unshadowed || !options.sendersSeenBy.empty();
    if (onlyFirst) layers = {kLayerNames[kBounce1]};
    Film film(view.width, view.height, layers, 2);
    const int most = options.untilRelMse > 0.0 ? options.maxSamplesPerPixel : options.samplesPerPixel;
    Run run(scene, view, pixels, options, film, std::uint32_t(options.samplesPerPixel / 2),
            std::uint32_t(most / 2));
    const SeenSurfaces seen(scene, options.sendersSeenBy);
    const SeenSurfaces* senders = options.sendersSeenBy.empty() ? nullptr : &seen;
    const Integrator integrator(scene,
                                options.guide != nullptr && !onlyFirst
                                    ? LitPoints(scene, *options.guide)
                                    : LitPoints(scene, pixels.shown(), !options.unshadowed, senders),
                                onlyFirst ? 1 : options.maxBounces, senders);

    run.fill([&](const Tile& tile, std::uint32_t first, std::uint32_t last) {
        forEachPixel(tile, film, pixels, [&](std::size_t pixel) {
            const Surface& at = pixels.surface[pixel];
            const glm::vec3 punctual =
                options.unshadowed ? glm::vec3(0.0f)
                                   : scene.directIrradiance(at.position, at.geometricNormal, at.normal);
            for (int half = 0; half < 2; ++half)
                for (std::uint32_t s = first; s < last; ++s) {
                    const std::size_t stream = (options.commonPoints ? 0 : 2 * pixel) + std::size_t(half);
                    Sampler sampler(options.seed, stream, s);
                    glm::dvec3* sums = film.at(pixel, half);
                    if (options.unshadowed) {
                        sums[0] += glm::dvec3(integrator.traceUnshadowed(at, sampler));
                        continue;
                    }
                    const LayerSample sample = integrator.tracePath(at, punctual, sampler);
                    if (onlyFirst) {
                        sums[0] += glm::dvec3(sample[kBounce1]);
                        continue;
                    }
                    for (int layer = 0; layer < kLayerCount; ++layer)
                        sums[layer] += glm::dvec3(sample[std::size_t(layer)]);
                }
        });
    });
    return film;
}

// A VPL is a sample of this film; VPLs outside, pixels inside, so that a tile's shadow rays converge.
Film gatherVpls(const RayScene& scene, const GBuffer& view, const PixelSurfaces& pixels,
                const PathTracerOptions& options) {
    const std::vector<VplRecord>& vpls = *options.vpls;
    Film film(view.width, view.height, {kLayerNames[kBounce1]}, 1);
    Run run(scene, view, pixels, options, film, std::uint32_t(vpls.size()), std::uint32_t(vpls.size()));

    run.fill([&](const Tile& tile, std::uint32_t first, std::uint32_t last) {
        for (std::uint32_t v = first; v < last; ++v)
            forEachPixel(tile, film, pixels, [&](std::size_t pixel) {
                const Surface& at = pixels.surface[pixel];
                const glm::dvec3 irradiance = vplIrradiance(vpls[v], at);
                if (irradiance == glm::dvec3(0.0)) return;
                if (options.unshadowed || vplVisible(scene, vpls[v], at))
                    *film.at(pixel, 0) += irradiance;
            });
    });
    return film;
}

// The layer's planes: of the half, or of both together (`half` < 0).
void addLayer(Image& image, const Film& film, std::size_t layer, int half, double scale) {
    const std::string prefix = half < 0 ? "" : half == 0 ? "a." : "b.";
    for (int channel = 0; channel < 3; ++channel) {
        std::vector<float>& plane = image.plane(prefix + film.layers[layer] + "." + kChannels[channel]);
        for (std::size_t i = 0; i < plane.size(); ++i) {
            double sum = 0.0;
            for (int h = 0; h < film.halves; ++h)
                if (half < 0 || h == half) sum += film.at(i, h)[layer][channel];
            plane[i] = float(sum * scale);
        }
    }
}

}  // namespace

std::unique_ptr<LitPoints> makeGuide(const RayScene& scene, const GBuffer& view) {
    return std::make_unique<LitPoints>(scene, PixelSurfaces(scene, view).shown(), true);
}

Image tracePaths(const RayScene& scene, const GBuffer& view, const PathTracerOptions& options) {
    checkOptions(view, options);
    const PixelSurfaces pixels(scene, view);
    const Film film = options.ambient != nullptr    ? traceAmbient(scene, view, pixels, options)
                      : options.specular != nullptr ? traceSpecular(scene, view, pixels, options)
                      : options.vpls != nullptr     ? gatherVpls(scene, view, pixels, options)
                                                    : integratePaths(scene, view, pixels, options);

    Image image(view.width, view.height);
    std::vector<float>& validity = image.plane("validity");
    for (std::size_t i = 0; i < validity.size(); ++i) validity[i] = pixels.valid[i] ? 1.0f : 0.0f;
    const double perSample = options.vpls != nullptr ? 1.0 : 1.0 / film.samples;
    for (std::size_t layer = 0; layer < film.layers.size(); ++layer) {
        addLayer(image, film, layer, -1, perSample / film.halves);
        for (int half = 0; film.halves == 2 && half < 2; ++half)
            addLayer(image, film, layer, half, perSample);
        image.metadata["noise." + film.layers[layer]] =
            fmt::format("{:.6g}", filmNoise(film, pixels, {layer}));
    }
    if (options.vpls != nullptr) {
        image.metadata["vpls"] = fmt::format("{}", options.vpls->size());
    } else {
        image.metadata["spp"] = fmt::format("{}", 2 * film.samples);
        image.metadata["seed"] = fmt::format("{}", options.seed);
    }
    return image;
}

double estimateNoise(const Image& image, const std::vector<std::string>& layers) {
    const std::vector<float>& validity = image.plane("validity");
    std::vector<const std::vector<float>*> planes[2];  // of a half: R, G, B of each layer
    for (int half = 0; half < 2; ++half)
        for (const std::string& layer : layers)
            for (const char channel : kChannels)
                planes[half].push_back(&image.plane((half == 0 ? "a." : "b.") + layer + "." + channel));
    const auto sumOf = [&](std::size_t pixel, int half) {
        glm::dvec3 sum(0.0);
        for (std::size_t i = 0; i < planes[half].size(); ++i)
            sum[int(i % 3)] += double((*planes[half][i])[pixel]);
        return sum;
    };
    return halvesRelMse(image.pixelCount(), [&](std::size_t pixel, glm::dvec3& a, glm::dvec3& b) {
        if (validity[pixel] <= 0.0f) return false;
        a = sumOf(pixel, 0);
        b = sumOf(pixel, 1);
        return true;
    });
}

}  // namespace studio
