#include "stability_scaled.h"

#include "render_inputs.h"

namespace cli {

ScaledFrame::ScaledFrame(const studio::RayScene& scene, const studio::SequenceFrame& frame, float scale)
    : scene_(scene), scale_(scale) {
    if (scale == 1.0f) return;
    const auto copy = std::make_shared<studio::Scene>(*frame.scene);
    scaleScene(*copy, scale);
    scaled_ = std::make_unique<studio::RayScene>(copy, frame.time);
}

studio::Camera ScaledFrame::camera(const studio::Camera& camera) const {
    studio::Camera scaled = camera;
    scaled.position *= scale_;
    scaled.target *= scale_;
    scaled.nearPlane *= scale_;
    scaled.farPlane *= scale_;
    return scaled;
}

void dropUnlikePixels(const studio::GBuffer& scaledView, float scale, const studio::SeenFrame& seen,
                      const glm::vec3& eye, std::vector<std::uint8_t>& surface) {
    constexpr float kAlike = 1e-4f;  // of the distance
    for (int y = 0; y < seen.height; ++y)
        for (int x = 0; x < seen.width; ++x) {
            const std::size_t i = std::size_t(y) * std::size_t(seen.width) + std::size_t(x);
            const glm::vec3 normal = scaledView.normal.rgb(x, y);
            const bool isSurface = glm::dot(normal, normal) > 0.0f;
            const glm::vec3 position = scaledView.position.rgb(x, y) / scale;
            const float apart = glm::length(position - seen.position[i]);
            if (!isSurface || apart > kAlike * glm::length(seen.position[i] - eye)) surface[i] = 0;
        }
}

}  // namespace cli
