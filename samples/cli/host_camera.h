// The camera of another program's picture, as a camera file has it (docs/hosts/camera.schema.json; docs/hosts.md says what its keys mean).
#pragma once

#include <optional>
#include <string>

#include <glm/glm.hpp>

#include "json_reader.h"
#include "lightwell/lightwell.h"

namespace cli {

class HostCamera {
public:
    // Takes the camera's keys of an object; the caller finishes it. Throws std::runtime_error naming file, key, expectation and what came.
    explicit HostCamera(studio::JsonObject& object);

    bool isOrthographic() const { return isOrthographic_; }
    const glm::dvec3& eye() const { return eye_; }
    const glm::dvec3& forward() const { return forward_; }  // unit

    // From the eye through the middle of a pixel, as long as 1 along the axis; an orthographic camera's rays are parallel.
    struct Ray {
        glm::dvec3 origin, direction;
    };
    Ray rayThrough(int x, int y, int width, int height) const;
    // The place that a depth leads to, by the file's `depth` and `depth_from_near`.
    glm::dvec3 placeAt(const Ray& ray, double depth) const;
    // Of what a pixel shows at distance 1 along the axis (orthographic: at any), units^2.
    double pixelArea(int width, int height) const;
    // `farthest`: of the surfaces that are seen, along the axis; clip planes are set by it, which no result depends on.
    LWCamera describe(int width, int height, double farthest) const;

private:
    void readPose(studio::JsonObject& o);
    void readMatrix(const studio::JsonValue& value, const std::string& axes);
    void readLens(studio::JsonObject& o);
    void readDepth(studio::JsonObject& o);
    glm::dvec2 halfExtent(int width, int height) const;  // half of what the picture shows at distance 1, to the right and up

    glm::dvec3 eye_{0.0}, right_{1.0, 0.0, 0.0}, up_{0.0, 1.0, 0.0}, forward_{0.0, 0.0, -1.0};
    bool isOrthographic_ = false, isRadial_ = false;
    double half_ = 1.0;          // half of the picture's height, or width, at distance 1
    bool halfIsOfWidth_ = false;
    double near_ = 0.0;          // where depths begin
};

// Reads `path`, a JSON object with "format": `format` and "version": 1, which it hands on as `object` and finishes.
template <class F>
auto readHostFile(const std::string& path, const char* format, F&& read) {
    const nlohmann::json document = studio::readJsonFile(path);
    studio::JsonObject object = studio::JsonValue(document, path, "").object();
    const studio::JsonValue name = object.need("format", std::string("\"") + format + "\"");
    if (name.text() != format) name.fail(std::string("\"") + format + "\"");
    object.need("version", "1").integer(1, 1);
    auto result = read(object);
    object.finish();
    return result;
}

// A camera file. Throws as HostCamera, and where it cannot be read or is of another format.
HostCamera readCameraFile(const std::string& path);

}  // namespace cli
