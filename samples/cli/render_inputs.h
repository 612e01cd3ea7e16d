// What a host would hand to Lightwell for one view of a scene: G-buffer, lights and their RSMs, drawn by
// the studio and described by lightwell.h's structs without a copy.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "frame_focus.h"
#include "gbuffer.h"
#include "lightwell/lightwell.h"
#include "scene_triangles.h"

namespace cli {

struct InputOptions {
    int width = 0, height = 0;
    float time = 0.0f;
    studio::RsmOptions rsm;  // cascades: of suns; other lights have none
    // The frame before, for motion vectors and the previous camera; null: nothing has moved.
    const studio::Camera* previousCamera = nullptr;
    float previousTime = 0.0f;
    // Further source views of the frame: a camera, and the same one the frame before.
    std::vector<std::pair<studio::Camera, studio::Camera>> sources;
    FrameFocus focus;
    float scale = 1.0f;  // of the scene against its files (scaleScene), for what stands in other files
};

// The structs point into the buffers beside them: made once, never moved. `scene` must live as long.
class RenderInputs {
public:
    RenderInputs(const studio::RayScene& scene, const studio::Camera& camera,
                 const InputOptions& options);
    RenderInputs(const RenderInputs&) = delete;
    RenderInputs& operator=(const RenderInputs&) = delete;

    const studio::RayScene& scene() const { return scene_; }
    float time() const { return time_; }
    float scale() const { return scale_; }
    const studio::GBuffer& gbuffer() const { return gbuffer_; }
    const LWGBuffer& lwGBuffer() const { return lwGBuffer_; }
    // Of the further source views, in their order.
    const std::vector<LWGBuffer>& lwSources() const { return lwSources_; }
    const std::vector<LWLight>& lights() const { return lights_; }
    // The same, whose RSMs tell their version: one that no other inputs have, as these never change.
    const std::vector<LWLight>& versionedLights() const { return versionedLights_; }
    const LWGeometry& geometry() const { return lwGeometry_; }
    const float* environment() const { return environment_; }
    const float* focus() const { return hasFocus_ ? focus_ : nullptr; }
    std::uint64_t rsmTexelCount() const;

private:
    const studio::RayScene& scene_;
    float time_, scale_;
    studio::GBuffer gbuffer_;
    std::vector<std::vector<studio::Rsm>> rsms_;  // of each light
    std::vector<std::vector<LWRsm>> lwRsms_, versionedRsms_;
    std::vector<LWLight> lights_, versionedLights_;
    LWGBuffer lwGBuffer_{};
    std::vector<studio::GBuffer> sources_;
    std::vector<LWGBuffer> lwSources_;
    studio::SceneTriangles triangles_;
    LWGeometry lwGeometry_{};
    float environment_[3] = {};
    bool hasFocus_;
    float focus_[3] = {};
};

// A planar buffer as an image that Lightwell uses in place.
LWImage describePlanes(const studio::PlanarBuffer& buffer);

// The same scene in another unit of length: lengths * factor, intensities (point, spot) * factor^2,
// E_perp and radiances unchanged. Irradiance must not change.
void scaleScene(studio::Scene& scene, float factor);

}  // namespace cli
