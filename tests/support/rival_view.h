// The rival on a scene, as its tests call it.
#pragma once

#include <cmath>
#include <memory>
#include <utility>

#include "path_tracer.h"
#include "rival.h"

namespace rival_test {

struct View {
    std::shared_ptr<studio::Scene> scene;
    studio::RayScene rays;
    studio::GBuffer gbuffer;
    View(studio::Scene given, int width, int height)
        : scene(std::make_shared<studio::Scene>(std::move(given))),
          rays(scene, 0.0f),
          gbuffer(studio::renderGBuffer(rays, scene->cameraAt(0, 0.0f), width, height,
                                        scene->cameraAt(0, 0.0f), 0.0f)) {}
    View(const char* name, int width, int height) : View(studio::loadScene(name), width, height) {}
};

struct Result {
    studio::PlanarBuffer irradiance, validity;
    studio::RivalTimes times;
};

inline Result render(const studio::RayScene& rays, const studio::GBuffer& gbuffer,
                     const studio::RivalOptions& options) {
    Result result{studio::PlanarBuffer(gbuffer.width, gbuffer.height, 3),
                  studio::PlanarBuffer(gbuffer.width, gbuffer.height, 1),
                  {}};
    studio::Rival rival(options, gbuffer.width, gbuffer.height);
    result.times = rival.render(rays, gbuffer, result.irradiance, result.validity);
    return result;
}

inline Result render(const View& view, const studio::RivalOptions& options) {
    return render(view.rays, view.gbuffer, options);
}

inline studio::RivalOptions unfiltered(std::uint32_t bounces, std::uint32_t spp) {
    studio::RivalOptions options;
    options.bounces = bounces;
    options.spp = spp;
    options.filter = 0;
    return options;
}

inline double meanOf(const Result& result) {
    double sum = 0.0, count = 0.0;
    for (int c = 0; c < 3; ++c)
        for (int y = 0; y < result.validity.height(); ++y)
            for (int x = 0; x < result.validity.width(); ++x) {
                if (result.validity.row(0, y)[x] == 0.0f) continue;
                sum += double(result.irradiance.row(c, y)[x]);
                count += 1.0;
            }
    return sum / count;
}

// Sum of the first `bounces` layers at a pixel.
inline double truthAt(const studio::Image& truth, int bounces, int channel, int x, int y) {
    const std::string name(1, "RGB"[channel]);
    const auto at = std::size_t(y) * std::size_t(truth.width) + std::size_t(x);
    double sum = double(truth.plane("bounce1." + name)[at]);
    if (bounces == 2) sum += double(truth.plane("bounce2." + name)[at]);
    return sum;
}

struct Error {
    double nrmse = 0.0, bias = 0.0, relMse = 0.0;
};

inline Error errorOf(const Result& result, const studio::Image& truth, int bounces) {
    double squares = 0.0, difference = 0.0, sum = 0.0, count = 0.0, terms = 0.0;
    const auto forEach = [&](const auto& body) {
        for (int c = 0; c < 3; ++c)
            for (int y = 0; y < truth.height; ++y)
                for (int x = 0; x < truth.width; ++x)
                    if (result.validity.row(0, y)[x] != 0.0f)
                        body(double(result.irradiance.row(c, y)[x]), truthAt(truth, bounces, c, x, y));
    };
    forEach([&](double value, double t) {
        const double e = value - t;
        squares += e * e, difference += e, sum += t, count += 1.0;
    });
    const double mean = sum / count;
    forEach([&](double value, double t) {
        terms += (value - t) * (value - t) / (t * t + 0.01 * mean * mean);
    });
    return {std::sqrt(squares / count) / mean, difference / sum, terms / count};
}

inline studio::Image truthOf(const studio::RayScene& rays, const studio::GBuffer& gbuffer, int samples) {
    studio::PathTracerOptions options;
    options.samplesPerPixel = samples;
    options.maxBounces = 2;
    return studio::tracePaths(rays, gbuffer, options);
}

inline studio::Image truthOf(const View& view, int samples) {
    return truthOf(view.rays, view.gbuffer, samples);
}

}  // namespace rival_test
