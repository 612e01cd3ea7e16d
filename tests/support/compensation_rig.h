// The compensation of one image on a test's device, and its serial double-precision twin.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "passes/bounding_compensation.h"
#include "reference/surfaces.h"
#include "support/kernel_rig.h"
#include "support/vpl_slots.h"

namespace lightwell::test {

// Surfaces, what they send, and the camera that sees them: `pixelArea` is a pixel's at distance 1 along the axis.
struct SentImage {
    reference::Image position, normal, radiance;
    reference::Vec eye{0.5, 0.5, 3.0}, axis{0, 0, -1};
    double pixelArea = 1e-4;
    bool perspective = true;
    SentImage(std::uint32_t w, std::uint32_t h) : position(w, h), normal(w, h), radiance(w, h) {}
    lw_pixel_area camera() const {
        return {{{float(eye.x), float(eye.y), float(eye.z), float(pixelArea)}},
                {{float(axis.x), float(axis.y), float(axis.z), perspective ? 1.0f : 0.0f}}};
    }
};

struct Compensated {
    reference::Image light;
    int saturated, capped;
};

// `before` is added to; without it the light stands alone.
inline Compensated compensate(KernelRig& rig, const SentImage& image, const std::vector<lw_vpl>& vpls,
                              const CompensationOptions& options, const reference::Image* before = nullptr) {
    const std::uint32_t w = image.position.width, h = image.position.height;
    constexpr float kPadding = std::numeric_limits<float>::quiet_NaN();
    const Guarded p = rig.uploadPlanes(image.position.planes, w, h, 3, kPadding),
                  n = rig.uploadPlanes(image.normal.planes, w, h, 3, 1.0f),
                  l = rig.uploadPlanes(image.radiance.planes, w, h, 3, 1.0f),
                  out = before ? rig.uploadPlanes(before->planes, w, h, 3, 0.0f) : rig.makePlanes(w, h, 3),
                  list = rig.upload(vpls), counts = rig.upload(std::vector<cl_int>{0, 0, 0, 0});
    const Planes position = rig.planes(p, w, h, 3), normal = rig.planes(n, w, h, 3), radiance = rig.planes(l, w, h, 3),
                 light = rig.planes(out, w, h, 3);
    BoundingCompensation pass(rig.device(), options);
    CompensationSenders senders;
    senders.reserve(rig.device(), w, h, options.interleave);
    pass.recordScale(rig.executor(), list, orderOf(vpls.size(), 1), std::uint32_t(vpls.size()));
    pass.recordSenders(rig.executor(), position, normal, radiance, image.camera(), senders, counts);
    pass.recordGather(rig.executor(), position, normal, senders, !before, light, counts);
    rig.device().finish();
    const auto counted = rig.download<cl_int>(counts);
    Compensated result{reference::Image(w, h), counted[2], counted[3]};
    result.light.planes = rig.downloadPlanes(light);
    return result;
}

// Of VPLs of the mean flux `flux` or, if `uniformArea`, of the mean area `area`; in terms of cosines and distances.
inline reference::Image compensationTwin(const SentImage& image, double flux, double area, const CompensationOptions& options) {
    using reference::Vec;
    const double pi = 3.14159265358979323846;
    const int w = int(image.position.width), h = int(image.position.height), n = int(options.interleave);
    const float reach = BoundingCompensation::reachOf(image.position.width, image.position.height);
    const auto samples = BoundingCompensation::samples(options, reach);
    reference::Image out(image.position.width, image.position.height);
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            const auto s = reference::surfaceAt(image.position, image.normal, std::uint32_t(x), std::uint32_t(y));
            if (!s.valid) continue;
            Vec sum;
            for (std::size_t k = 0; k < options.samples; ++k) {
                const lw_near_sample& sample = samples[std::size_t((y % n) * n + x % n) * options.samples + k];
                const int sx = x + sample.x, sy = y + sample.y;
                if (sx < 0 || sy < 0 || sx >= w || sy >= h) continue;
                const auto q = reference::surfaceAt(image.position, image.normal, std::uint32_t(sx), std::uint32_t(sy));
                const Vec l = image.radiance.get(std::uint32_t(sx), std::uint32_t(sy));
                const double mean = (l.x + l.y + l.z) / 3.0;
                if (!q.valid || !(mean > 0.0)) continue;
                const Vec ray = q.position - image.eye, to = q.position - s.position;
                const double z = std::abs(dot(ray, image.axis)), r = std::sqrt(dot(ray, ray));
                const double beta = std::abs(dot(ray, q.normal)) / r;
                const double pixel = image.perspective
                                         ? z * z * image.pixelArea * (z / r) / std::max(beta, 0.05)
                                         : image.pixelArea / std::max(std::abs(dot(image.axis, q.normal)), 0.05);
                const double stands = pixel * double(sample.cell), vpl = options.uniformArea ? area : flux / (pi * mean);
                const double d2 = dot(to, to);
                if (d2 == 0.0 || stands >= vpl) continue;
                const double c = std::max(dot(to, s.normal), 0.0) / std::sqrt(d2);
                const double cp = std::max(-dot(to, q.normal), 0.0) / std::sqrt(d2);
                const double kappa = (1.0 + 3.0 * cp * cp) / 4.0;
                const double lost = 1.0 / (d2 + kappa * stands / pi) - 1.0 / (d2 + kappa * vpl / pi);
                sum = sum + l * (stands * c * cp * lost);
            }
            out.set(std::uint32_t(x), std::uint32_t(y), sum * double(n * n));
        }
    return out;
}

}  // namespace lightwell::test
