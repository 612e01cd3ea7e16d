// A host's camera matrices in double precision: where its rays start and run, and how depth becomes
// position. Derivations stand in camera.cpp.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>

#include "lightwell/lightwell.h"
#include "shared/screen_types.h"
#include "shared/unproject_types.h"

namespace lightwell {

// A quantity linear in the image: perI * (i + 1/2) + perJ * (j + 1/2) + constant, pixel (i, j) from the
// top left.
template <class T>
struct ImageLinear {
    T perI{}, perJ{}, constant{};
    T at(double i, double j) const { return perI * (i + 0.5) + perJ * (j + 0.5) + constant; }
};

// As kernels take it.
inline lw_float4 float4(double x, double y, double z, double w) {
    lw_float4 result;
    result.s[0] = float(x);
    result.s[1] = float(y);
    result.s[2] = float(z);
    result.s[3] = float(w);
    return result;
}

class Camera {
public:
    Camera() = default;  // to be assigned
    // Throws INVALID_ARGUMENT naming `name`.view or `name`.projection when a matrix is not finite or not
    // invertible, or the view is not affine.
    Camera(const LWCamera& camera, std::uint32_t width, std::uint32_t height, const std::string& name);

    bool perspective() const { return perspective_; }
    // Perspective: the centre of projection. Orthographic: the origin of view space.
    const glm::dvec3& eye() const { return eye_; }
    // Unit vector along which depth grows; for an orthographic camera up to its sign, which the matrices
    // of a reversed or left-handed projection do not tell.
    const glm::dvec3& axis() const { return axis_; }
    // Perspective: world vector from the eye through a pixel's centre, 1 long along the axis.
    // Orthographic: world vector from the eye to the pixel's place in the plane across the axis.
    const ImageLinear<glm::dvec3>& rays() const { return rays_; }
    // Perspective: area of a pixel at distance 1 along the axis. Orthographic: its cross-section.
    double pixelArea() const;

    // Image coordinates of a world position (pixel centres at + 1/2); false behind the eye.
    bool project(const glm::dvec3& position, glm::dvec2& pixel) const;
    const glm::dmat4& worldToClip() const { return worldToClip_; }
    // Distance along the axis from the eye, and a pixel's width there.
    double axial(const glm::dvec3& position) const { return glm::dot(position - eye_, axis_); }
    double footprint(double axialDistance) const;
    // Where points lie among texels of `factor` x `factor` pixels.
    LwScreenCamera texelsOf(std::uint32_t factor) const;
    // From view space.
    glm::dvec3 positionFromView(const glm::dvec3& p) const { return origin_ + viewToWorld_ * p; }
    glm::dvec3 directionFromView(const glm::dvec3& d) const { return viewToWorld_ * d; }

    // Clip x and y of the points that pixels of the orthographic camera `other` stand for, along the
    // common axis. Both must be orthographic.
    void clipOf(const Camera& other, ImageLinear<double>& clipX, ImageLinear<double>& clipY) const;

    // What the kernel needs to turn depth of this kind into world positions.
    LwUnprojection unprojection(LWDepthKind kind) const;

private:
    glm::dmat4 clipToView_{1.0}, worldToClip_{1.0};
    glm::dmat3 viewToWorld_{1.0};  // directions
    glm::dvec3 origin_{0.0};       // of view space, in the world
    glm::dvec3 eye_{0.0}, axis_{0.0};
    ImageLinear<glm::dvec3> rays_;
    double width_ = 0.0, height_ = 0.0;
    bool perspective_ = false;
    std::string name_;
};

}  // namespace lightwell
