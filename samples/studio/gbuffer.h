// Ray-cast G-buffers and reflective shadow maps: what a rasterising host would hand to Lightwell.
#pragma once

#include <cstddef>
#include <vector>

#include "ray_scene.h"

namespace studio {

// 64-byte aligned planar float32 with rows padded to 16 pixels: Lightwell uses it in place.
class PlanarBuffer {
public:
    PlanarBuffer() = default;
    PlanarBuffer(int width, int height, int planes);
    int width() const { return width_; }
    int height() const { return height_; }
    int planes() const { return planes_; }
    int rowFloats() const { return rowFloats_; }                          // row stride in floats
    std::size_t planeFloats() const { return std::size_t(rowFloats_) * std::size_t(height_); }
    float* row(int plane, int y);
    const float* row(int plane, int y) const;
    float* data();
    const float* data() const;
    glm::vec3 rgb(int x, int y) const;          // planes 0..2
    void setRgb(int x, int y, const glm::vec3& value);

private:
    int width_ = 0, height_ = 0, planes_ = 0, rowFloats_ = 0;
    struct Free { void operator()(float* p) const; };
    std::unique_ptr<float[], Free> data_;
};

struct GBuffer {
    Camera camera, previousCamera;
    int width = 0, height = 0;
    PlanarBuffer position, normal, albedo, direct;  // 3 planes each; direct = L_d, W/(sr m^2)
    PlanarBuffer motion;                            // 2 planes, pixels: previous less current position
    PlanarBuffer depth;                             // 1 plane, distance along the camera axis, m; 0 = none
};

// One ray through each pixel's centre. `previousTime`: for exact motion vectors of camera and objects.
GBuffer renderGBuffer(const RayScene& scene, const Camera& camera, int width, int height,
                      const Camera& previousCamera, float previousTime);

struct Rsm {
    int width = 0, height = 0;
    glm::mat4 view{1.0f}, projection{1.0f};  // projection: clip z in [0,1]
    PlanarBuffer position, normal, flux;     // flux: albedo * incident flux through the texel, W
};

// All RSMs of one light: one for a sun (or `cascades` nested ones, finest first; a coarser one's texels
// inside a finer footprint carry no flux) or a spot (five faces when its outer cone is over 75 degrees),
// six for a point light. A sun's is fitted to the surfaces that can light what `view` sees (nothing
// that matters is left out: at least 99.9 % of the estimated light), or to all surfaces without one.
struct RsmOptions {
    int size = 512;                   // texels along each side
    int cascades = 1;                 // suns only
    const GBuffer* view = nullptr;    // fit to this view's pixels
};
std::vector<Rsm> renderRsms(const RayScene& scene, const Light& light, const RsmOptions& options);

}  // namespace studio
