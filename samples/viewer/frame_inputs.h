// What the viewer hands to Lightwell for a frame: its images as they lie in pixel buffers after the read-back, described by
// lightwell.h's structs without a further copy. This file is the one to copy from for a host with OpenGL.
#pragma once

#include <vector>

#include "gbuffer_pass.h"
#include "host_images.h"
#include "light_maps.h"
#include "scene_triangles.h"

namespace viewer {

class FrameInputs {
public:
    void share(const std::shared_ptr<GlSharing>& sharing) { gbufferPixels_.share(sharing), rsmPixels_.share(sharing); }
    // Asks for the copies out of OpenGL's images.
    void read(const GBufferImages& images, const std::vector<LightMaps>& lights);
    // Waits for them, and describes everything. What is given must stay until unmap().
    void map(const Eye& now, const Eye& before, const std::vector<LightMaps>& lights, const studio::SceneTriangles& triangles,
             const glm::vec3& sky);
    void unmap() { gbufferPixels_.unmap(), rsmPixels_.unmap(); }

    const LWGBuffer& gbuffer() const { return gbuffer_; }
    // For lwUpdate, but for frameIndex, reset, sourceViews and static VPLs.
    LWFrame& frame() { return frame_; }
    std::uint64_t byteCount() const { return gbufferPixels_.byteCount() + rsmPixels_.byteCount(); }
    const std::vector<std::vector<LWRsm>>& rsms() const { return rsms_; }  // of each light, while mapped

private:
    void describeLight(const LightMaps& maps, std::size_t& plane);
    ReadBack gbufferPixels_, rsmPixels_;
    LWGBuffer gbuffer_{};
    std::vector<std::vector<LWRsm>> rsms_;
    std::vector<std::vector<float>> profiles_;  // of each light; mostly empty
    std::vector<LWLight> lights_;
    LWGeometry geometry_{};
    float focus_[3] = {};
    LWFrame frame_{};
};

}  // namespace viewer
