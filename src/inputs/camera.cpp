// With P the projection, V the view matrix, and q = P^-1 (x, y, z, 1) for clip coordinates x, y, z:
//  - the view-space point is q.xyz / q.w, and q.w = 1 / (clip w) is positive exactly in front of the
//  eye;
//  - q is linear in x, y and z, hence in the pixel's coordinates and the depth;
//  - the eye of a perspective camera is the point that projects to x = y = w = 0: P^-1 (0, 0, 1, 0).
//    n = q.xyz - eye q.w does not depend on z, so it is the direction of the pixel's ray. Row 3 of P, r,
//    gives clip w: r.q = 1 and r.(eye, 1) = 0, so r.xyz.n = 1: n |r.xyz| has length 1 along the axis
//    r.xyz / |r.xyz|. Nothing here depends on handedness, a reversed depth range or an off-centre
//    frustum.
//  - an orthographic camera (r.xyz = 0) has parallel rays along P^-1 (0, 0, 1, 0).
#include "inputs/camera.h"

#include <cmath>
#include <glm/gtc/matrix_inverse.hpp>

#include "compute/error.h"
#include "compute/float_parts.h"

namespace lightwell {
namespace {

// Residual of the inverse above which a matrix counts as singular: double precision leaves 1e-10 for a
// depth range of a million to one.
constexpr double kWorstResidual = 1e-4;

glm::dmat4 fromRowMajor(const float* m, const std::string& name) {
    glm::dmat4 result;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) {
            const float value = m[4 * row + column];
            if (!std::isfinite(value))
                fail(LW_ERROR_INVALID_ARGUMENT, name, ": expected finite numbers, got ", value,
                     " in row ", row, ", column ", column);
            result[column][row] = double(value);
        }
    return result;
}

glm::dmat4 invert(const glm::dmat4& m, const std::string& name) {
    const glm::dmat4 inverse = glm::inverse(m);
    const glm::dmat4 product = m * inverse;
    double worst = 0.0;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) {
            const double error = std::abs(product[column][row] - (row == column ? 1.0 : 0.0));
            if (!(error <= worst)) worst = error;  // also when it is not a number
        }
    if (!(worst <= kWorstResidual))
        fail(LW_ERROR_INVALID_ARGUMENT, name, ": expected an invertible matrix, got a singular one");
    return inverse;
}

// Coefficients of (clip x, clip y, 1) turned into those of a pixel's position.
template <class T>
ImageLinear<T> overImage(const T& perX, const T& perY, const T& constant, double width, double height) {
    // x = 2 (i + 1/2) / width - 1,  y = 1 - 2 (j + 1/2) / height
    return {perX * (2.0 / width), perY * (-2.0 / height), constant - perX + perY};
}

}  // namespace

Camera::Camera(const LWCamera& camera, std::uint32_t width, std::uint32_t height,
               const std::string& name)
    : width_(width), height_(height), name_(name) {
    const glm::dmat4 view = fromRowMajor(camera.view, name + ".view");
    const glm::dmat4 projection = fromRowMajor(camera.projection, name + ".projection");
    if (view[0][3] != 0.0 || view[1][3] != 0.0 || view[2][3] != 0.0 || view[3][3] != 1.0)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".view: expected the last row 0 0 0 1, got ", view[0][3],
             " ", view[1][3], " ", view[2][3], " ", view[3][3]);
    const glm::dmat4 viewInverse = invert(view, name + ".view");
    clipToView_ = invert(projection, name + ".projection");
    worldToClip_ = projection * view;
    viewToWorld_ = glm::dmat3(viewInverse);
    origin_ = glm::dvec3(viewInverse[3]);

    const glm::dvec3 depthRow(projection[0][3], projection[1][3], projection[2][3]);
    perspective_ = depthRow != glm::dvec3(0.0);
    const glm::dvec4 alongZ = clipToView_[2];
    if (perspective_) {
        if (alongZ.w == 0.0)
            fail(LW_ERROR_INVALID_ARGUMENT, name,
                 ".projection: expected perspective or orthographic, got neither");
        const glm::dvec3 eyeView = glm::dvec3(alongZ) / alongZ.w;
        eye_ = origin_ + viewToWorld_ * eyeView;
        // Distances are the world's: the axis is a plane's normal, carried over by the transpose of V.
        const glm::dvec3 normal = glm::transpose(glm::dmat3(view)) * depthRow;
        axis_ = glm::normalize(normal);
        const auto ray = [&](int column) {
            const glm::dvec4 q = clipToView_[column];
            return viewToWorld_ * (glm::dvec3(q) - eyeView * q.w) * glm::length(normal);
        };
        rays_ = overImage(ray(0), ray(1), ray(3), width_, height_);
    } else {
        eye_ = origin_;
        const double w = clipToView_[3].w;
        if (!(w > 0.0))
            fail(LW_ERROR_INVALID_ARGUMENT, name, ".projection: expected a positive clip w, got ",
                 1.0 / w);
        const glm::dvec3 along = viewToWorld_ * glm::dvec3(alongZ);
        axis_ = glm::normalize(along);
        // The side on which the visible volume lies; clip z = 1/2 is inside it in every convention.
        const glm::dvec3 middle = viewToWorld_ * glm::dvec3(clipToView_[3] + 0.5 * alongZ);
        if (glm::dot(middle, axis_) < 0.0) axis_ = -axis_;
        const auto across = [&](int column) {
            const glm::dvec3 v = viewToWorld_ * glm::dvec3(clipToView_[column]) / w;
            return v - axis_ * glm::dot(v, axis_);
        };
        rays_ = overImage(across(0), across(1), across(3), width_, height_);
    }
}

double Camera::pixelArea() const {
    return std::abs(glm::dot(glm::cross(rays_.perI, rays_.perJ), axis_));
}

bool Camera::project(const glm::dvec3& position, glm::dvec2& pixel) const {
    const glm::dvec4 clip = worldToClip_ * glm::dvec4(position, 1.0);
    if (!(clip.w > 0.0)) return false;
    pixel = {(clip.x / clip.w + 1.0) * 0.5 * width_, (1.0 - clip.y / clip.w) * 0.5 * height_};
    return std::isfinite(pixel.x) && std::isfinite(pixel.y);
}

LwScreenCamera Camera::texelsOf(std::uint32_t factor) const {
    const glm::dmat4 rows = glm::transpose(worldToClip_);
    // With v = p - eye: row.(p, 1) = row.xyz.v + row.(eye, 1).
    const auto relative = [&](const glm::dvec4& row) {
        return glm::dvec4(glm::dvec3(row), glm::dot(row, glm::dvec4(eye_, 1.0)));
    };
    const glm::dvec4 x = relative(rows[0]), y = relative(rows[1]), w = relative(rows[3]);
    const glm::dvec4 column = (x + w) * (0.5 * width_ / factor), line = (w - y) * (0.5 * height_ / factor);
    LwScreenCamera camera{};
    camera.eye = float4(eye_.x, eye_.y, eye_.z, pixelArea() * factor * factor);
    camera.axis = float4(axis_.x, axis_.y, axis_.z, perspective_ ? 1.0 : 0.0);
    camera.rowX = float4(column.x, column.y, column.z, column.w);
    camera.rowY = float4(line.x, line.y, line.z, line.w);
    camera.rowW = float4(w.x, w.y, w.z, w.w);
    return camera;
}

double Camera::footprint(double axialDistance) const {
    return std::sqrt(pixelArea()) * (perspective_ ? std::abs(axialDistance) : 1.0);
}

void Camera::clipOf(const Camera& other, ImageLinear<double>& clipX, ImageLinear<double>& clipY) const {
    const double w = worldToClip_[3][3];
    const glm::dvec4 start = worldToClip_ * glm::dvec4(other.eye_, 1.0) / w;
    const auto direction = [&](const glm::dvec3& v) { return worldToClip_ * glm::dvec4(v, 0.0) / w; };
    const glm::dvec4 perI = direction(other.rays_.perI), perJ = direction(other.rays_.perJ);
    const glm::dvec4 constant = direction(other.rays_.constant) + start;
    clipX = {perI.x, perJ.x, constant.x};
    clipY = {perI.y, perJ.y, constant.y};
}

LwUnprojection Camera::unprojection(LWDepthKind kind) const {
    LwUnprojection result{};
    const bool distance = kind == LW_DEPTH_AXIAL || kind == LW_DEPTH_RADIAL;
    result.positiveOnly = distance ? 1 : 0;
    glm::dvec3 origin = eye_;
    glm::dvec3 perDepth(0.0);
    ImageLinear<glm::dvec3> xyz = rays_;
    ImageLinear<double> w{0.0, 0.0, 1.0};
    double wPerDepth = 0.0;
    if (distance && perspective_) {
        result.mode = kind == LW_DEPTH_AXIAL ? LW_UNPROJECT_AXIAL : LW_UNPROJECT_RADIAL;
    } else if (distance) {
        // Parallel rays: distance along the ray from the plane through the origin of view space, for
        // both kinds. Which way is forward must be plain from the visible volume.
        const glm::dvec3 middle = viewToWorld_ * glm::dvec3(clipToView_[3] + 0.5 * clipToView_[2]);
        const double extent = glm::length(viewToWorld_ * glm::dvec3(clipToView_[2]));
        if (!(glm::dot(middle, axis_) > 1e-6 * extent))
            fail(LW_ERROR_INVALID_ARGUMENT, name_,
                 ".projection: expected a visible volume in front of the camera for depth as a "
                 "distance, got an "
                 "orthographic volume around it");
        perDepth = axis_;
    } else {
        origin = origin_;
        const auto column = [&](int c) { return viewToWorld_ * glm::dvec3(clipToView_[c]); };
        // OpenGL's window depth d stands for clip z / w = 2 d - 1.
        const double scale = kind == LW_DEPTH_GL ? 2.0 : 1.0, shift = kind == LW_DEPTH_GL ? -1.0 : 0.0;
        perDepth = column(2) * scale;
        wPerDepth = clipToView_[2].w * scale;
        xyz = overImage(column(0), column(1), column(3) + column(2) * shift, width_, height_);
        w = overImage(clipToView_[0].w, clipToView_[1].w, clipToView_[3].w + clipToView_[2].w * shift,
                      width_, height_);
    }
    result.x = float4(xyz.perI.x, xyz.perJ.x, perDepth.x, xyz.constant.x);
    result.y = float4(xyz.perI.y, xyz.perJ.y, perDepth.y, xyz.constant.y);
    result.z = float4(xyz.perI.z, xyz.perJ.z, perDepth.z, xyz.constant.z);
    result.w = float4(w.perI, w.perJ, wPerDepth, w.constant);
    result.wRest = float4(restOf(w.perI), restOf(w.perJ), restOf(wPerDepth), restOf(w.constant));
    result.origin = float4(origin.x, origin.y, origin.z, 0.0);
    return result;
}

}  // namespace lightwell
