#include "check_plant_tools.h"

#include <algorithm>
#include <cmath>

#include "image.h"

namespace cli {

using Pixels = PlantedInputs::Pixels;

glm::mat4 matrixOf(const float (&rows)[16]) {
    glm::mat4 m;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) m[column][row] = rows[4 * row + column];
    return m;
}

void storeMatrix(const glm::mat4& m, float (&rows)[16]) {
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) rows[4 * row + column] = m[column][row];
}

void transpose(float (&rows)[16]) {
    storeMatrix(glm::transpose(matrixOf(rows)), rows);
}

void scaleFlux(PlantedInputs& in, float (*factor)(const PlantedInputs::Map&)) {
    eachMap(in, [&](PlantedInputs::Map& map, LWRsm&) {
        const float f = factor(map);
        for (float& value : map.flux.values) value *= f;
    });
}

void scaleMotion(PlantedInputs& in, float x, float y) {
    eachPixel(in.motion, [&](int i, int j) {
        in.motion.at(i, j)[0] *= x;
        in.motion.at(i, j)[1] *= y;
    });
}

void scaleView(LWCamera& camera, float factor) {
    for (int row = 0; row < 3; ++row) camera.view[4 * row + 3] *= factor;
}

glm::vec3 eyeOf(const LWCamera& camera) {
    return glm::vec3(glm::inverse(matrixOf(camera.view))[3]);
}

glm::mat3 rotationOf(const LWCamera& camera) {
    return glm::mat3(matrixOf(camera.view));
}

glm::vec3 toView(const LWCamera& camera, const glm::vec3& p) {
    return glm::vec3(matrixOf(camera.view) * glm::vec4(p, 1.0f));
}

float middleDistance(PlantedInputs& in) {
    std::vector<float> distances;
    eachPixel(in.position, [&](int x, int y) {
        if (in.normal.triple(x, y) != glm::vec3(0.0f))
            distances.push_back(-toView(in.gbuffer.camera, in.position.triple(x, y)).z);
    });
    if (distances.empty()) return 1.0f;
    std::nth_element(distances.begin(), distances.begin() + std::ptrdiff_t(distances.size() / 2),
                     distances.end());
    return distances[distances.size() / 2];
}

namespace {

void moveCamera(LWCamera& camera, const glm::vec3& by) {
    glm::mat4 view = matrixOf(camera.view);
    view[3] -= glm::vec4(glm::mat3(view) * by, 0.0f);
    storeMatrix(view, camera.view);
}

}  // namespace

void moveFar(PlantedInputs& in) {
    const float width = 2.0f * middleDistance(in) /
                        (in.gbuffer.camera.projection[5] * float(in.position.height));
    const glm::vec3 by(float(1 << 23) * width, 0.0f, 0.0f);
    const auto move = [&](const glm::vec3& p) { return p + by; };
    changePlaces(in.position, in.normal, move);
    moveCamera(in.gbuffer.camera, by);
    moveCamera(in.gbuffer.previousCamera, by);
    eachMap(in, [&](PlantedInputs::Map& map, LWRsm& rsm) {
        changePlaces(map.position, map.normal, move);
        moveCamera(rsm.camera, by);
    });
    for (LWLight& light : in.lights) light.position[0] += by.x;
}

void useDepth(PlantedInputs& in, bool openGl, bool reversedMatrix) {
    const float middle = middleDistance(in), nearPlane = 0.02f * middle, farPlane = 50.0f * middle;
    glm::mat4 projection = matrixOf(in.gbuffer.camera.projection);
    // Rows 2 and 3 of the studio's projection are the depth's; -z is forward.
    const double range = double(farPlane) - nearPlane;
    double a = -double(farPlane) / range, b = -double(farPlane) * nearPlane / range;
    if (openGl) {
        a = -(double(farPlane) + nearPlane) / range;
        b = -2.0 * farPlane * nearPlane / range;
    }
    if (reversedMatrix) {
        a = double(nearPlane) / range;
        b = double(farPlane) * nearPlane / range;
    }
    projection[2][2] = float(a);
    projection[3][2] = float(b);
    storeMatrix(projection, in.gbuffer.camera.projection);
    in.depth.width = in.position.width;
    in.depth.height = in.position.height;
    in.depth.channels = 1;
    in.depth.values.assign(std::size_t(in.depth.width * in.depth.height), reversedMatrix ? 0.0f : 1.0f);
    eachPixel(in.depth, [&](int x, int y) {
        if (in.normal.triple(x, y) == glm::vec3(0.0f)) return;
        const double z = double(toView(in.gbuffer.camera, in.position.triple(x, y)).z);
        const double depth = (a * z + b) / -z;
        *in.depth.at(x, y) = float(openGl ? (depth + 1.0) / 2.0 : depth);
    });
    in.gbuffer.depthKind = openGl ? LW_DEPTH_GL : LW_DEPTH_ZERO_TO_ONE;
}

void flipRows(Pixels& pixels) {
    for (int y = 0; y < pixels.height / 2; ++y)
        std::swap_ranges(pixels.at(0, y), pixels.at(0, y) + pixels.width * pixels.channels,
                         pixels.at(0, pixels.height - 1 - y));
}

void encodeFlux(Pixels& flux, const LWLight& light, const LWCamera& camera) {
    const bool sun = light.kind == LW_LIGHT_DIRECTIONAL;
    const float* sent = sun ? light.irradiance : light.radiantIntensity;
    const glm::mat4 p = matrixOf(camera.projection);
    const float window = 4.0f / (p[0][0] * p[1][1] * float(flux.width) * float(flux.height));
    eachPixel(flux, [&](int x, int y) {
        float whole = window;
        if (!sun) {
            const float u = (2.0f * (float(x) + 0.5f) / float(flux.width) - 1.0f) / p[0][0],
                        v = (1.0f - 2.0f * (float(y) + 0.5f) / float(flux.height)) / p[1][1];
            const float length = std::sqrt(1.0f + u * u + v * v);
            whole /= length * length * length;
            if (light.kind == LW_LIGHT_SPOT) {
                const float inner = std::cos(light.innerConeAngle),
                            outer = std::cos(light.outerConeAngle);
                const float ramp = std::clamp((1.0f / length - outer) / (inner - outer), 0.0f, 1.0f);
                whole *= ramp * ramp;
            }
        }
        for (int c = 0; c < 3; ++c) {
            const float white = whole * sent[c];
            float& value = flux.at(x, y)[c];
            if (white > 0.0f) value = white * studio::srgbEncode(std::min(1.0f, value / white));
        }
    });
}

}  // namespace cli
