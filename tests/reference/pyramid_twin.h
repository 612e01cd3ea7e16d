// Plain serial double-precision twin of the mip pyramid of a G-buffer, and a camera that looks at test scenes.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "lightwell/lightwell.h"
#include "reference/surfaces.h"

namespace lightwell::reference {

// A perspective camera at `eye` that looks along -z, `tangent` = half the image's height at distance 1.
struct PinholeCamera {
    Vec eye;
    double tangent;
    std::uint32_t width, height;

    LWCamera matrices() const {
        LWCamera camera{};
        const double near = 0.01, far = 1000.0;
        for (int i = 0; i < 4; ++i) camera.view[5 * i] = 1.0f;
        camera.view[3] = float(-eye.x);
        camera.view[7] = float(-eye.y);
        camera.view[11] = float(-eye.z);
        camera.projection[0] = float(double(height) / (width * tangent));
        camera.projection[5] = float(1.0 / tangent);
        camera.projection[10] = float(far / (near - far));
        camera.projection[11] = float(near * far / (near - far));
        camera.projection[14] = -1.0f;
        return camera;
    }
    double pixelArea() const { return 4.0 * tangent * tangent / (double(height) * height); }
    // Through image coordinates in pixels, 1 long along the axis.
    Vec ray(double x, double y) const {
        const double step = 2.0 * tangent / height;
        return {(x - 0.5 * width) * step, (0.5 * height - y) * step, -1.0};
    }
    Vec onPlane(double x, double y, Vec point, Vec normal) const {
        const Vec d = ray(x, y);
        return eye + d * (dot(point - eye, normal) / dot(d, normal));
    }
};

struct PyramidTexel {
    Surface s;
    Vec radiance;
    double area = 0, depth = 0;
};
struct PyramidLevel {
    std::uint32_t width = 0, height = 0;
    std::vector<PyramidTexel> texels;
    const PyramidTexel& at(std::uint32_t x, std::uint32_t y) const { return texels[std::size_t(y) * width + x]; }
};

// Level 0 of a G-buffer; only(x, y): receives and does not send.
inline PyramidLevel pyramidBase(const Image& position, const Image& normal, const Image& radiance, const PinholeCamera& camera,
                                const std::function<bool(std::uint32_t, std::uint32_t)>& only) {
    PyramidLevel base{position.width, position.height, std::vector<PyramidTexel>(std::size_t(position.width) * position.height)};
    for (std::uint32_t y = 0; y < base.height; ++y)
        for (std::uint32_t x = 0; x < base.width; ++x) {
            PyramidTexel& t = base.texels[std::size_t(y) * base.width + x];
            t.s = surfaceAt(position, normal, x, y);
            if (!t.s.valid) {
                t.s = Surface{};
                continue;
            }
            const Vec v = t.s.position - camera.eye, l = radiance.get(x, y);
            t.depth = -v.z;
            const auto sane = [](double c) { return c >= 0.0 && c <= 1e30; };
            if (only(x, y) || !sane(l.x) || !sane(l.y) || !sane(l.z)) continue;
            t.radiance = l;
            const double length = std::sqrt(dot(v, v)), cosAlpha = t.depth / length;
            const double cosBeta = std::max(0.02, -dot(t.s.normal, v) / length);
            t.area = camera.pixelArea() * t.depth * t.depth * cosAlpha / cosBeta;
        }
    return base;
}

// The next level: nearest child that sends, else nearest; radiance, place and depth by area over the kept surface.
inline PyramidLevel pyramidReduce(const PyramidLevel& fine, bool lastFirst) {
    PyramidLevel level{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
    const std::uint32_t order[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (std::uint32_t y = 0; y < level.height; ++y)
        for (std::uint32_t x = 0; x < level.width; ++x) {
            std::vector<PyramidTexel> children;
            for (int i = 0; i < 4; ++i) {
                const auto& [dx, dy] = order[(i + (lastFirst ? 2 : 0)) % 4];
                if (2 * x + dx < fine.width && 2 * y + dy < fine.height) {
                    const PyramidTexel& child = fine.at(2 * x + dx, 2 * y + dy);
                    if (child.s.valid) children.push_back(child);
                }
            }
            PyramidTexel kept;
            for (const PyramidTexel& child : children) {
                const bool sends = child.area > 0, rival = kept.area > 0;
                if (!kept.s.valid || (sends && !rival) || (sends == rival && child.depth < kept.depth)) kept = child;
            }
            PyramidTexel mean = kept;
            mean.area = mean.depth = 0;
            mean.radiance = mean.s.position = {};
            for (const PyramidTexel& child : children)
                if (edgeWeight(kept.s, child.s) > 0) {
                    mean.area += child.area;
                    mean.depth += child.depth * child.area;
                    mean.radiance = mean.radiance + child.radiance * child.area;
                    mean.s.position = mean.s.position + child.s.position * child.area;
                }
            if (mean.area > 0) {
                mean.depth /= mean.area;
                mean.radiance = mean.radiance * (1.0 / mean.area);
                mean.s.position = mean.s.position * (1.0 / mean.area);
            } else {
                mean.depth = kept.depth;
                mean.s.position = kept.s.position;
            }
            level.texels.push_back(mean);
        }
    return level;
}

}  // namespace lightwell::reference
