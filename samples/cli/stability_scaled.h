// One frame of a sequence in another unit of length, as a host would hand it over that counts in
// millimetres or kilometres.
#pragma once

#include <memory>

#include "gbuffer.h"
#include "sequence.h"

namespace cli {

class ScaledFrame {
public:
    // `scene` and `frame` in their own unit; must live as long.
    ScaledFrame(const studio::RayScene& scene, const studio::SequenceFrame& frame, float scale);
    const studio::RayScene& scene() const { return scaled_ != nullptr ? *scaled_ : scene_; }
    studio::Camera camera(const studio::Camera& camera) const;

private:
    const studio::RayScene& scene_;
    std::unique_ptr<studio::RayScene> scaled_;  // null at scale 1
    float scale_;
};

// Rounding may let a ray along a silhouette hit another surface in the other unit: such pixels are taken
// from `surface` (one per pixel).
void dropUnlikePixels(const studio::GBuffer& scaledView, float scale, const studio::SeenFrame& seen,
                      const glm::vec3& eye, std::vector<std::uint8_t>& surface);

}  // namespace cli
