// See host_camera.h.
#include "host_camera.h"

#include <fmt/format.h>

#include <cmath>

namespace cli {
namespace {

using studio::JsonObject;
using studio::JsonValue;

constexpr double kRadians = 3.14159265358979323846 / 180.0;
// Cosine between two columns of a matrix that a float's rounding, and a program's own, explains.
constexpr double kSquare = 1e-4;
// Clip planes: where results don't depend on them, but matrices must have some.
constexpr double kNearShare = 1e-4, kFarShare = 2.0;

glm::dvec3 unitOf(const JsonValue& value, const glm::dvec3& v, const char* what) {
    const double length = glm::length(v);
    if (!(length > 0.0)) value.fail(what);
    return v / length;
}

}  // namespace

HostCamera::HostCamera(JsonObject& object) {
    readPose(object);
    readLens(object);
    readDepth(object);
}

void HostCamera::readPose(JsonObject& o) {
    const auto matrix = o.find("to_world"), axes = o.find("axes");
    const auto position = o.find("position"), target = o.find("target"), direction = o.find("direction"), up = o.find("up");
    if (matrix) {
        for (const auto& other : {position, target, direction, up})
            if (other) other->fail("nothing beside to_world");
        readMatrix(*matrix, o.need("axes", "\"blender\", \"mitsuba\" or \"left_handed\"").text());
        return;
    }
    if (axes) axes->fail("to_world with it");
    const JsonValue eye = o.need("position", "three numbers, or to_world");
    eye_ = eye.vector();
    if (target && direction) direction->fail("nothing beside target");
    const JsonValue way = target ? *target : o.need("direction", "three numbers, or target");
    forward_ = unitOf(way, target ? glm::dvec3(way.vector()) - eye_ : glm::dvec3(way.vector()), "a place other than the eye, or a direction");
    const JsonValue upward = o.need("up", "three numbers");
    right_ = unitOf(upward, glm::cross(forward_, glm::dvec3(upward.vector())), "a direction across the camera's axis");
    up_ = glm::cross(right_, forward_);
}

// Columns: where the camera's x, y, z axes and its origin lie in the world; a scale of Mitsuba's orthographic cameras is in them.
void HostCamera::readMatrix(const JsonValue& value, const std::string& axes) {
    const auto items = value.list();
    if (items.size() != 16) value.fail("16 numbers, row by row");
    glm::dvec3 columns[4];
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column) columns[column][row] = items[std::size_t(4 * row + column)].number();
    for (int column = 0; column < 4; ++column)
        if (items[std::size_t(12 + column)].number() != (column == 3 ? 1.0f : 0.0f)) value.fail("0, 0, 0, 1 as the last row");
    const glm::dvec3 x = unitOf(value, columns[0], "axes that are not zero"), y = unitOf(value, columns[1], "axes that are not zero"),
                     z = unitOf(value, columns[2], "axes that are not zero");
    if (std::abs(glm::dot(x, y)) > kSquare || std::abs(glm::dot(y, z)) > kSquare || std::abs(glm::dot(z, x)) > kSquare)
        value.fail("axes at right angles to each other");
    eye_ = columns[3];
    up_ = y;
    half_ = glm::length(columns[1]);  // of an orthographic picture; readLens divides it out of others
    if (axes == "blender") {
        right_ = x;
        forward_ = -z;
    } else if (axes == "mitsuba") {
        right_ = -x;
        forward_ = z;
    } else if (axes == "left_handed") {
        right_ = x;
        forward_ = z;
    } else {
        value.fail("axes \"blender\", \"mitsuba\" or \"left_handed\" with it");
    }
}

void HostCamera::readLens(JsonObject& o) {
    const double scale = half_;
    int given = 0;
    for (const char* key : {"vertical_fov_degrees", "horizontal_fov_degrees", "orthographic_height", "orthographic_width"}) {
        const auto value = o.find(key);
        if (!value) continue;
        if (++given > 1) value->fail("one of vertical_fov_degrees, horizontal_fov_degrees, orthographic_height and orthographic_width");
        const std::string name(key);
        isOrthographic_ = name.compare(0, 12, "orthographic") == 0;
        halfIsOfWidth_ = name == "horizontal_fov_degrees" || name == "orthographic_width";
        if (isOrthographic_) {
            half_ = 0.5 * scale * double(value->number(0.0f, 1e9f));
        } else {
            half_ = std::tan(0.5 * kRadians * double(value->number(0.0f, 179.0f)));
        }
    }
    if (given == 0) o.need("vertical_fov_degrees", "the whole angle, or horizontal_fov_degrees, orthographic_height or orthographic_width");
}

void HostCamera::readDepth(JsonObject& o) {
    if (const auto depth = o.find("depth")) {
        const std::string kind = depth->text();
        if (kind != "axial" && kind != "radial") depth->fail("\"axial\" or \"radial\"");
        isRadial_ = kind == "radial";
    }
    if (const auto from = o.find("depth_from_near")) {
        near_ = from->number();
        if (near_ < 0.0 || near_ > 1e9) from->fail("a number from 0 to 1e9");
    }
}

glm::dvec2 HostCamera::halfExtent(int width, int height) const {
    const double aspect = double(width) / double(height);  // pixels are square
    return halfIsOfWidth_ ? glm::dvec2(half_, half_ / aspect) : glm::dvec2(half_ * aspect, half_);
}

HostCamera::Ray HostCamera::rayThrough(int x, int y, int width, int height) const {
    const glm::dvec2 half = halfExtent(width, height);
    const glm::dvec3 across = right_ * (half.x * (2.0 * (x + 0.5) / width - 1.0)) + up_ * (half.y * (1.0 - 2.0 * (y + 0.5) / height));
    if (isOrthographic_) return {eye_ + across, forward_};
    return {eye_, forward_ + across};
}

glm::dvec3 HostCamera::placeAt(const Ray& ray, double depth) const {
    const double along = isRadial_ ? depth / glm::length(ray.direction) : depth;
    return ray.origin + ray.direction * (along + near_);
}

double HostCamera::pixelArea(int width, int height) const {
    const glm::dvec2 half = halfExtent(width, height);
    return 4.0 * half.x * half.y / (double(width) * double(height));
}

LWCamera HostCamera::describe(int width, int height, double farthest) const {
    const glm::dvec2 half = halfExtent(width, height);
    const double far = kFarShare * farthest, near = kNearShare * far;
    LWCamera camera{};
    const glm::dvec3 axes[3] = {right_, up_, -forward_};
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) camera.view[4 * row + column] = float(axes[row][column]);
        camera.view[4 * row + 3] = float(-glm::dot(axes[row], eye_));
    }
    camera.view[15] = 1.0f;
    camera.projection[0] = float(1.0 / half.x);
    camera.projection[5] = float(1.0 / half.y);
    if (isOrthographic_) {
        camera.projection[10] = float(-1.0 / far);
        camera.projection[15] = 1.0f;
    } else {
        camera.projection[10] = float(-far / (far - near));
        camera.projection[11] = float(-far * near / (far - near));
        camera.projection[14] = -1.0f;
    }
    return camera;
}

HostCamera readCameraFile(const std::string& path) {
    return readHostFile(path, "lightwell-camera", [](JsonObject& file) {
        JsonObject object = file.need("camera", "an object").object();
        HostCamera camera(object);
        object.finish();
        return camera;
    });
}

}  // namespace cli
