// See host_normals.h. A row of pixels shows a straight line of a plane (both lie in one plane through the eye), so that on one surface a pixel, its
// neighbour and the next are in line.
#include "host_normals.h"

#include <algorithm>
#include <cmath>

namespace cli {
namespace {

// Of a step's length: how far the line through neighbour and next may pass by the pixel. On planes it passes through it, half floats and a sphere
// of a dozen pixels leave less than this; a step over an edge is beside it.
constexpr double kStraight = 0.25;
// Sine between step and ray (6 degrees) below which a step that no line continues leads to another surface.
constexpr double kAcross = 0.1;

class Places {
public:
    Places(int width, int height, const std::vector<std::optional<glm::dvec3>>& places) : width_(width), height_(height), places_(places) {}

    const glm::dvec3* at(int x, int y) const {
        if (x < 0 || y < 0 || x >= width_ || y >= height_) return nullptr;
        const std::optional<glm::dvec3>& place = places_[std::size_t(y) * std::size_t(width_) + std::size_t(x)];
        return place ? &*place : nullptr;
    }

    // From pixel (x, y) to that neighbour along (dx, dy) or against it that is on its surface, in the sense of (dx, dy). `ray`: the pixel's.
    std::optional<glm::dvec3> step(int x, int y, int dx, int dy, const glm::dvec3& ray) const {
        const glm::dvec3 here = *at(x, y);
        std::optional<glm::dvec3> straight, near;
        double leastBend = kStraight;
        for (const int sign : {1, -1}) {
            const glm::dvec3* const first = at(x + sign * dx, y + sign * dy);
            if (first == nullptr) continue;
            const glm::dvec3 step = *first - here;
            const double length = glm::length(step);
            if (!(length > 0.0)) continue;
            const glm::dvec3* const second = at(x + 2 * sign * dx, y + 2 * sign * dy);
            const glm::dvec3 next = second != nullptr ? *second - *first : glm::dvec3(0.0);
            if (const double nextLength = glm::length(next); nextLength > 0.0) {
                const double bend = glm::length(glm::cross(step, next)) / (length * nextLength);
                if (bend < leastBend && glm::dot(step, next) > 0.0) {
                    leastBend = bend;
                    straight = step * double(sign);
                }
            }
            const bool isAcross = glm::length(glm::cross(step, ray)) > kAcross * length * glm::length(ray);
            if (isAcross && (!near || length < glm::length(*near))) near = step * double(sign);
        }
        return straight ? straight : near;
    }

private:
    int width_, height_;
    const std::vector<std::optional<glm::dvec3>>& places_;
};

}  // namespace

MadeNormals makeNormals(int width, int height, const std::vector<std::optional<glm::dvec3>>& places, const HostCamera& camera) {
    MadeNormals made;
    made.planes.assign(3, std::vector<float>(places.size(), 0.0f));
    const Places picture(width, height, places);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const glm::dvec3* const here = picture.at(x, y);
            if (here == nullptr) continue;
            const glm::dvec3 ray = camera.isOrthographic() ? camera.forward() : *here - camera.eye();
            const auto right = picture.step(x, y, 1, 0, ray), down = picture.step(x, y, 0, 1, ray);
            glm::dvec3 normal = right && down ? glm::cross(*right, *down) : glm::dvec3(0.0);
            const double length = glm::length(normal);
            if (!(length > 0.0)) {
                ++made.lonely;
                continue;
            }
            normal *= (glm::dot(normal, ray) > 0.0 ? -1.0 : 1.0) / length;
            const std::size_t i = std::size_t(y) * std::size_t(width) + std::size_t(x);
            for (int axis = 0; axis < 3; ++axis) made.planes[std::size_t(axis)][i] = float(normal[axis]);
        }
    return made;
}

}  // namespace cli
