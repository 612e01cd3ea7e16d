// A view's history in tests: a camera that moves, surfaces given pixel by pixel, light frame by frame.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "passes/temporal_history.h"
#include "reference/surfaces.h"
#include "support/camera_matrices.h"
#include "support/kernel_rig.h"

namespace lightwell::test {

// A window as wide and high as the picture in pixels at depth 1000: a pixel there is 1 unit wide.
inline TestCamera pixelCamera(double width, double height, bool orthographic = false) {
    TestCamera camera{};
    camera.name = "pixels";
    camera.right = {1, 0, 0};
    camera.up = {0, 1, 0};
    camera.forward = {0, 0, -1};
    const double scale = orthographic ? 1.0 : 1e-3;
    camera.left = -0.5 * width * scale;
    camera.rightEdge = 0.5 * width * scale;
    camera.bottom = -0.5 * height * scale;
    camera.top = 0.5 * height * scale;
    camera.near = 1;
    camera.far = 1e5;
    camera.orthographic = orthographic;
    return camera;
}

struct Frame {
    reference::Image position, normal, light;
    std::optional<reference::Image> motion;
    LWCamera camera{};
    Frame(std::uint32_t w, std::uint32_t h) : position(w, h), normal(w, h), light(w, h) {}
    std::uint32_t width() const { return position.width; }
    std::uint32_t height() const { return position.height; }
    // Surfaces by depth along the axis; light by pixel.
    void look(const TestCamera& from, const std::function<double(std::uint32_t, std::uint32_t)>& depth) {
        camera = from.matrices();
        for (std::uint32_t y = 0; y < height(); ++y)
            for (std::uint32_t x = 0; x < width(); ++x) {
                const glm::dvec3 p = from.point((x + 0.5) / width(), (y + 0.5) / height(), depth(x, y));
                position.set(x, y, {p.x, p.y, p.z});
                normal.set(x, y, {-from.forward.x, -from.forward.y, -from.forward.z});
            }
    }
    void shine(const std::function<reference::Vec(std::uint32_t, std::uint32_t)>& value) {
        for (std::uint32_t y = 0; y < height(); ++y)
            for (std::uint32_t x = 0; x < width(); ++x) light.set(x, y, value(x, y));
    }
    void move(const std::function<reference::Vec(std::uint32_t, std::uint32_t)>& by) {
        motion.emplace(width(), height(), 3);
        for (std::uint32_t y = 0; y < height(); ++y)
            for (std::uint32_t x = 0; x < width(); ++x) motion->set(x, y, by(x, y));
    }
};

class HistoryRig {
public:
    HistoryRig(KernelRig& rig, const TemporalHistoryOptions& options, std::uint32_t maxWidth, std::uint32_t maxHeight)
        : rig_(rig), history_(rig.device(), options), view_(rig.device(), options, maxWidth, maxHeight) {}

    // An update and its picture. `into`: where the mean goes, else memory of its own.
    reference::Image render(const Frame& frame, bool forget = false, const Planes* into = nullptr) {
        view_.startFrame(forget);
        return renderOnly(frame, into);
    }
    // A picture without an update.
    reference::Image renderOnly(const Frame& frame, const Planes* into = nullptr) {
        constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
        const std::uint32_t w = frame.width(), h = frame.height();
        const Guarded p = rig_.uploadPlanes(frame.position.planes, w, h, 3, kNaN), n = rig_.uploadPlanes(frame.normal.planes, w, h, 3, 1.0f);
        const Guarded e = rig_.uploadPlanes(frame.light.planes, w, h, 3, kNaN), out = rig_.makePlanes(w, h, 3);
        const Guarded m = rig_.uploadPlanes(frame.motion ? frame.motion->planes : frame.light.planes, w, h, 3, kNaN);
        HistoryFrame images;
        images.position = rig_.planes(p, w, h, 3);
        images.normal = rig_.planes(n, w, h, 3);
        if (frame.motion) images.motion = rig_.planes(m, w, h, 3);
        images.current = rig_.planes(e, w, h, 3);
        images.irradiance = into ? *into : rig_.planes(out, w, h, 3);
        history_.record(rig_.executor(), images, frame.camera, view_);
        rig_.device().finish();
        reference::Image result(w, h);
        result.planes = rig_.downloadPlanes(images.irradiance);
        return result;
    }
    int fresh() {
        Report report;
        view_.report(rig_.device(), report);
        rig_.device().finish();
        report.resolve();
        return int(report.counts.front().value);
    }
    std::vector<float> ages() {
        const Planes shape = history_.ageShape(view_);
        const Guarded out = rig_.makePlanes(shape.width, shape.height, 1);
        history_.recordAge(rig_.executor(), view_, rig_.planes(out, shape.width, shape.height, 1));
        rig_.device().finish();
        return rig_.downloadPlanes(rig_.planes(out, shape.width, shape.height, 1));
    }
    TemporalHistory& history() { return history_; }
    ViewHistory& view() { return view_; }

private:
    KernelRig& rig_;
    TemporalHistory history_;
    ViewHistory view_;
};

}  // namespace lightwell::test
