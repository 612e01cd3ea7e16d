#include "passes/reprojection.h"

#include <glm/glm.hpp>

#include "compute/float_parts.h"
#include "passes/world_shift.h"

namespace lightwell {
namespace {

// `row` of a matrix over X, as one over X - origin.
glm::dvec4 relativeTo(const glm::dvec3& origin, const glm::dvec4& row) {
    return {glm::dvec3(row), glm::dot(glm::dvec3(row), origin) + row.w};
}

lw_float4 rounded(const glm::dvec4& v) { return float4(v.x, v.y, v.z, v.w); }
lw_float4 rounded(const glm::dvec3& v) { return float4(v.x, v.y, v.z, 0.0); }

}  // namespace

LwReprojection reprojection(const Camera& camera, std::uint32_t width, std::uint32_t height, const Planes& now,
                            const WorldOrigin& before, const WorldOrigin& after) {
    const glm::dmat4 m = glm::transpose(camera.worldToClip());  // its columns are the rows
    const glm::dvec4 x = (m[0] + m[3]) * (0.5 * width), y = (m[3] - m[1]) * (0.5 * height);
    // As the kernel takes it off: far from the world's origin the eye would be off by parts of a pixel, all of one picture alike.
    const glm::dvec3 moved(after[0] - before[0], after[1] - before[1], after[2] - before[2]);
    const glm::dvec3 eye = camera.eye() - moved;
    const glm::dvec3 origin(roundedToFloat(eye.x), roundedToFloat(eye.y), roundedToFloat(eye.z)), there = origin + moved;
    LwReprojection result{};
    result.x = rounded(relativeTo(there, x));
    result.y = rounded(relativeTo(there, y));
    result.w = rounded(relativeTo(there, m[3]));
    result.depth = camera.perspective() ? rounded(camera.axis()) : float4(0.0, 0.0, 0.0, 1.0);
    result.acrossX = rounded(camera.rays().perI);
    result.acrossY = rounded(camera.rays().perJ);
    result.origin = rounded(glm::dvec4(origin, camera.footprint(1.0)));
    const WorldStep step = worldStep(before, after);
    result.shiftHigh = step.high;
    result.shiftLow = step.low;
    result.scaleX = float(double(width) / now.width);
    result.scaleY = float(double(height) / now.height);
    result.width = cl_int(width);
    result.height = cl_int(height);
    return result;
}

Planes historyPlanes(const Buffer& image, std::uint32_t width, std::uint32_t height, std::uint32_t count) {
    Planes planes;
    planes.memory = image.get();
    planes.planeStride = std::int64_t(historyPlaneStride(width));
    planes.rowStride = planes.planeStride * count;
    planes.width = width;
    planes.height = height;
    planes.count = count;
    return planes;
}

}  // namespace lightwell
