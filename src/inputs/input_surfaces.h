// Host copies of the images that the input checker looks at: a G-buffer or an RSM as one set of surfaces
// seen by a camera.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "compute/executor.h"
#include "inputs/camera.h"
#include "inputs/image_check.h"
#include "lightwell/lightwell.h"

namespace lightwell {

// Planar float32 as kernels unpack it: rows padded to 16 pixels.
class HostPlanes {
public:
    HostPlanes() = default;
    HostPlanes(std::uint32_t width, std::uint32_t height, std::uint32_t channels);
    explicit operator bool() const { return !values_.empty(); }
    float& at(std::uint32_t x, std::uint32_t y, std::uint32_t channel) {
        return values_[(std::size_t(channel) * height_ + y) * stride_ + x];
    }
    float at(std::uint32_t x, std::uint32_t y, std::uint32_t channel = 0) const {
        return values_[(std::size_t(channel) * height_ + y) * stride_ + x];
    }
    glm::dvec3 triple(std::uint32_t x, std::uint32_t y) const {
        return {double(at(x, y, 0)), double(at(x, y, 1)), double(at(x, y, 2))};
    }
    std::uint32_t channels() const { return channels_; }
    std::vector<float>& values() { return values_; }
    std::size_t bytes() const { return values_.size() * sizeof(float); }

private:
    std::uint32_t height_ = 0, channels_ = 0;
    std::size_t stride_ = 0;
    std::vector<float> values_;
};

bool finite(const glm::dvec3& v);
bool withinReach(const glm::dvec3& p);  // as the kernels judge; false for NaN

struct Surfaces {
    std::string name;  // "gbuffer", "frame.lights[0].rsms[1]"
    std::uint32_t width = 0, height = 0;
    std::uint32_t step = 1;                              // every how many pixels in x and y are examined
    HostPlanes position;                                 // as the host gave it, or from the depth
    HostPlanes depth;                                    // empty with positions
    HostPlanes normal;                                   // as stored: not brought to unit length
    HostPlanes albedo, direct, motion, roughness, flux;  // empty where absent
    LWDepthKind depthKind = LW_DEPTH_ZERO_TO_ONE;
    bool halfPositions = false;
    const LWCamera* matrices = nullptr;
    const LWCamera* previousMatrices = nullptr;  // null: absent
    std::optional<Camera> camera, previous;      // absent or no camera's
    std::string cameraError;                     // of matrices that no camera can have
    // Orthographic: the way the light travels, where that is known (an orthographic camera's axis is not
    // sure of its sign).
    glm::dvec3 lightDirection{0.0};
    bool isRsm = false;
    bool shown = false;  // in the overlay: findings then keep their pixels
    // Positions fit the camera and normals the positions: what rests on them can be judged.
    bool trusted = true;
    bool albedoTrusted = true;

    // A finite nonzero normal.
    bool drawn(std::uint32_t x, std::uint32_t y) const {
        const glm::dvec3 n = normal.triple(x, y);
        return finite(n) && glm::dot(n, n) > 0.0;
    }
    // The same with a position within reach.
    bool surface(std::uint32_t x, std::uint32_t y) const {
        return drawn(x, y) && withinReach(position.triple(x, y));
    }
    // By how much a position may be off its true place because of its format.
    double rounding(const glm::dvec3& p) const;
    glm::dvec3 unitNormal(std::uint32_t x, std::uint32_t y) const {
        return glm::normalize(normal.triple(x, y));
    }
    // Unit vector from p to where the surfaces are seen from; zero when that is not known.
    glm::dvec3 towardsEye(const glm::dvec3& p) const;
    // Whether that is known at all.
    bool sided() const { return camera && (camera->perspective() || lightDirection != glm::dvec3(0.0)); }
    // Calls body(x, y) for every examined pixel.
    template <class Body>
    void sample(const Body& body) const {
        for (std::uint32_t y = step / 2; y < height; y += step)
            for (std::uint32_t x = step / 2; x < width; x += step) body(x, y);
    }
    std::string argument(const char* image) const { return name + "." + image; }
    const char* placeName() const { return depth ? "depth" : "position"; }
};

bool cameraAbsent(const LWCamera& camera);

// A place from depth, by the derivation of camera.cpp; false where the depth is no surface's.
bool unprojectDepth(const LwUnprojection& u, double i, double j, double depth, glm::dvec3& position);

// Reads back the images that are given. `view` must fit the G-buffer, which has been checked.
Surfaces readGBuffer(Executor& executor, const LWGBuffer& gbuffer, std::uint32_t width,
                     std::uint32_t height, const std::string& name);
Surfaces readRsm(Executor& executor, const LWLight& light, const LWRsm& rsm, const std::string& name);

}  // namespace lightwell
