// The plants: helpers, then one entry for each. Longer than other files because the list is, and reads
// best in one piece.
#include "check_plant.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "image.h"
#include "lightwell/lightwell.hpp"

namespace cli {
namespace {

using Pixels = PlantedInputs::Pixels;

Pixels copyOf(const LWImage& image) {
    Pixels copy;
    copy.width = int(image.width);
    copy.height = int(image.height);
    copy.channels = image.format == LW_FORMAT_FLOAT1          ? 1
                    : image.format == LW_FORMAT_PLANAR_FLOAT2 ? 2
                                                              : 3;
    copy.values.resize(std::size_t(copy.width) * std::size_t(copy.height) * std::size_t(copy.channels));
    for (int c = 0; c < copy.channels; ++c)
        for (int y = 0; y < copy.height; ++y) {
            const float* row =
                reinterpret_cast<const float*>(static_cast<const char*>(image.host) +
                                               c * image.bytePlaneStride + y * image.byteRowStride);
            for (int x = 0; x < copy.width; ++x) copy.at(x, y)[c] = row[x];
        }
    return copy;
}

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

template <class Change>
void eachPixel(Pixels& pixels, const Change& change) {
    for (int y = 0; y < pixels.height; ++y)
        for (int x = 0; x < pixels.width; ++x) change(x, y);
}
// Surfaces only: background keeps its zeros.
template <class Change>
void changeNormals(Pixels& normal, const Change& change) {
    eachPixel(normal, [&](int x, int y) {
        const glm::vec3 n = normal.triple(x, y);
        if (n != glm::vec3(0.0f)) normal.set(x, y, change(n));
    });
}
template <class Change>
void changePlaces(Pixels& position, Pixels& normal, const Change& change) {
    eachPixel(position, [&](int x, int y) {
        if (normal.triple(x, y) != glm::vec3(0.0f)) position.set(x, y, change(position.triple(x, y)));
    });
}
template <class Change>
void eachMap(PlantedInputs& in, const Change& change) {
    for (std::size_t l = 0; l < in.maps.size(); ++l)
        for (std::size_t r = 0; r < in.maps[l].size(); ++r) change(in.maps[l][r], in.rsms[l][r]);
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

// The G-buffer with depth instead of positions, drawn with clip planes that suit the picture.
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

// Flux over that of a white surface is the albedo: encoded in its place.
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

float texelCount(const PlantedInputs::Map& map) {
    return float(map.flux.width) * float(map.flux.height);
}

constexpr float kPi = studio::kPi;
const float kNaN = std::numeric_limits<float>::quiet_NaN();

}  // namespace

LWImage PlantedInputs::Pixels::image() const {
    constexpr LWFormat kFormats[] = {LW_FORMAT_FLOAT1, LW_FORMAT_FLOAT2, LW_FORMAT_FLOAT3};
    LWImage image{};
    if (values.empty()) return image;
    image.host = values.data();
    image.format = kFormats[channels - 1];
    image.width = std::uint32_t(width);
    image.height = std::uint32_t(height);
    return image;
}

PlantedInputs::PlantedInputs(const RenderInputs& inputs)
    : position(copyOf(inputs.lwGBuffer().position)),
      normal(copyOf(inputs.lwGBuffer().normal)),
      albedo(copyOf(inputs.lwGBuffer().albedo)),
      direct(copyOf(inputs.lwGBuffer().directRadiance)),
      motion(copyOf(inputs.lwGBuffer().motion)),
      gbuffer(inputs.lwGBuffer()),
      lights(inputs.lights()) {
    for (const LWLight& light : lights) {
        rsms.emplace_back(light.rsms, light.rsms + light.rsmCount);
        maps.emplace_back();
        for (const LWRsm& rsm : rsms.back())
            maps.back().push_back({copyOf(rsm.position), copyOf(rsm.normal), copyOf(rsm.flux)});
    }
    std::copy_n(inputs.environment(), 3, environment);
    describe();
}

void PlantedInputs::describe() {
    gbuffer.position = depth.values.empty() ? position.image() : LWImage{};
    gbuffer.depth = depth.image();
    gbuffer.normal = normal.image();
    gbuffer.albedo = albedo.image();
    gbuffer.directRadiance = direct.image();
    gbuffer.motion = motion.image();
    for (std::size_t l = 0; l < lights.size(); ++l) {
        for (std::size_t r = 0; r < maps[l].size(); ++r) {
            rsms[l][r].position = maps[l][r].position.image();
            rsms[l][r].normal = maps[l][r].normal.image();
            rsms[l][r].flux = maps[l][r].flux.image();
        }
        lights[l].rsms = rsms[l].data();
    }
}

LWFrame PlantedInputs::frame() const {
    LWFrame result = lightwell::make<LWFrame>();
    result.lights = lights.data();
    result.lightCount = std::uint32_t(lights.size());
    std::copy_n(environment, 3, result.environment);
    return result;
}

const std::vector<Plant>& plants() {
    using In = PlantedInputs;
    using Map = PlantedInputs::Map;
    static const std::vector<Plant> list = {
        {"nan", "not-finite", "NaN in some pixels' direct radiance", false, false, false,
         [](In& in) {
             eachPixel(in.direct, [&](int x, int y) {
                 if (x % 8 == 3 && y % 4 == 1) in.direct.at(x, y)[1] = kNaN;
             });
         }},
        {"rsm-nan", "not-finite", "infinite flux in some texels", true, false, false,
         [](In& in) {
             eachMap(in, [](Map& m, LWRsm&) {
                 eachPixel(m.flux, [&](int x, int y) {
                     if (x % 8 == 3) m.flux.at(x, y)[1] = std::numeric_limits<float>::infinity();
                 });
             });
         }},
        {"negative", "negative", "negative albedo in a corner", false, false, false,
         [](In& in) {
             eachPixel(in.albedo, [&](int x, int y) {
                 if (x < in.albedo.width / 2 && y > in.albedo.height / 2) in.albedo.at(x, y)[2] = -0.1f;
             });
         }},
        {"normal-zero", "no-surfaces", "every normal is zero", false, false, false,
         [](In& in) { std::fill(in.normal.values.begin(), in.normal.values.end(), 0.0f); }},
        {"normal-missing", "normal-missing", "zero normals in the lower third", false, false, false,
         [](In& in) {
             eachPixel(in.normal, [&](int x, int y) {
                 if (3 * y > 2 * in.normal.height) in.normal.set(x, y, glm::vec3(0.0f));
             });
         }},
        {"normal-length", "normal-length", "normals 0.8 long", false, false, false,
         [](In& in) { changeNormals(in.normal, [](const glm::vec3& n) { return 0.8f * n; }); }},
        {"normal-encoded", "normal-encoded", "normals stored as n/2 + 1/2", false, false, false,
         [](In& in) {
             eachPixel(in.normal,
                       [&](int x, int y) { in.normal.set(x, y, 0.5f * in.normal.triple(x, y) + 0.5f); });
         }},
        {"normal-view-space", "normal-space", "normals in view space", false, false, false,
         [](In& in) {
             const glm::mat3 r = rotationOf(in.gbuffer.camera);
             changeNormals(in.normal, [&](const glm::vec3& n) { return r * n; });
         }},
        {"normal-axes", "normal-space", "normals with y and z exchanged", false, false, false,
         [](In& in) {
             changeNormals(in.normal, [](const glm::vec3& n) { return glm::vec3(n.x, n.z, n.y); });
         }},
        {"normal-flipped", "normal-flipped", "normals away from the camera", false, false, false,
         [](In& in) { changeNormals(in.normal, [](const glm::vec3& n) { return -n; }); }},
        {"rsm-normal-flipped", "normal-flipped", "RSM normals away from the light", true, false, false,
         [](In& in) {
             eachMap(in, [](Map& m, LWRsm&) {
                 changeNormals(m.normal, [](const glm::vec3& n) { return -n; });
             });
         }},
        {"rsm-normal-view-space", "normal-space", "RSM normals in the space of the light's camera", true,
         false, false,
         [](In& in) {
             eachMap(in, [](Map& m, LWRsm& rsm) {
                 const glm::mat3 r = rotationOf(rsm.camera);
                 changeNormals(m.normal, [&](const glm::vec3& n) { return r * n; });
             });
         }},
        {"camera-transposed", "camera-transposed", "column-major matrices", false, false, false,
         [](In& in) {
             for (LWCamera* c : {&in.gbuffer.camera, &in.gbuffer.previousCamera}) {
                 transpose(c->view);
                 transpose(c->projection);
             }
         }},
        {"camera-previous", "camera-previous", "camera and previousCamera exchanged", false, false,
         false, [](In& in) { std::swap(in.gbuffer.camera, in.gbuffer.previousCamera); }},
        {"rows-flipped", "image-flipped", "all images bottom-up", false, false, false,
         [](In& in) {
             for (Pixels* p : {&in.position, &in.normal, &in.albedo, &in.direct, &in.motion})
                 flipRows(*p);
         }},
        {"view-space", "position-space", "positions and normals in view space", false, false, false,
         [](In& in) {
             const LWCamera c = in.gbuffer.camera;
             changePlaces(in.position, in.normal, [&](const glm::vec3& p) { return toView(c, p); });
             changeNormals(in.normal, [&](const glm::vec3& n) { return rotationOf(c) * n; });
         }},
        {"camera-relative", "position-space", "positions relative to the eye", false, false, false,
         [](In& in) {
             const glm::vec3 eye = eyeOf(in.gbuffer.camera);
             changePlaces(in.position, in.normal, [&](const glm::vec3& p) { return p - eye; });
         }},
        {"handedness", "position-space", "positions and normals with -z", false, false, false,
         [](In& in) {
             const auto turn = [](const glm::vec3& p) { return glm::vec3(p.x, p.y, -p.z); };
             changePlaces(in.position, in.normal, turn);
             changeNormals(in.normal, turn);
         }},
        {"position-units", "position-units", "positions in centimetres, camera in metres", false, false,
         false,
         [](In& in) {
             changePlaces(in.position, in.normal, [](const glm::vec3& p) { return 100.0f * p; });
         }},
        {"depth-reversed", "depth-reversed", "reversed depth with a matrix that is not", false, false,
         false,
         [](In& in) {
             useDepth(in, false, false);
             for (float& d : in.depth.values) d = 1.0f - d;
         }},
        {"depth-near-far", "depth-reversed", "a reversed matrix with depth that is not", false, false,
         false,
         [](In& in) {
             useDepth(in, false, true);
             for (float& d : in.depth.values) d = 1.0f - d;
         }},
        {"depth-kind", "depth-kind", "OpenGL's depth called LW_DEPTH_ZERO_TO_ONE", true, false, false,
         [](In& in) {
             useDepth(in, true, false);
             in.gbuffer.depthKind = LW_DEPTH_ZERO_TO_ONE;
         }},
        {"motion-sign", "motion-sign", "motion of the wrong sign", false, false, false,
         [](In& in) { scaleMotion(in, -1, -1); }},
        {"motion-flipped-y", "motion-flipped-y", "motion with +y up", false, false, false,
         [](In& in) { scaleMotion(in, 1, -1); }},
        {"motion-uv", "motion-units", "motion in [0,1] over the image", false, false, false,
         [](In& in) { scaleMotion(in, 1.0f / float(in.motion.width), 1.0f / float(in.motion.height)); }},
        {"motion-clip", "motion-units", "motion in clip coordinates", false, false, false,
         [](In& in) {
             scaleMotion(in, 2.0f / float(in.motion.width), -2.0f / float(in.motion.height));
         }},
        {"motion-zero", "motion-zero", "no motion while the camera moves", false, false, false,
         [](In& in) { scaleMotion(in, 0, 0); }},
        {"motion-static", "motion-static", "motion while previousCamera is camera", false, false, false,
         [](In& in) { in.gbuffer.previousCamera = in.gbuffer.camera; }},
        {"albedo-bytes", "albedo-range", "albedo in 0 .. 255", false, false, false,
         [](In& in) {
             for (float& v : in.albedo.values) v *= 255.0f;
         }},
        {"albedo-srgb", "albedo-srgb", "the G-buffer's albedo left sRGB-encoded", true, false, false,
         [](In& in) {
             for (float& v : in.albedo.values) v = studio::srgbEncode(v);
         }},
        {"rsm-albedo-srgb", "albedo-srgb", "flux made from sRGB-encoded albedo", true, false, false,
         [](In& in) {
             for (std::size_t l = 0; l < in.maps.size(); ++l)
                 for (std::size_t r = 0; r < in.maps[l].size(); ++r)
                     encodeFlux(in.maps[l][r].flux, in.lights[l], in.rsms[l][r].camera);
         }},
        {"direct-pi", "direct-scale", "direct radiance without 1/pi", false, false, false,
         [](In& in) {
             for (float& v : in.direct.values) v *= kPi;
         }},
        {"flux-pi", "flux-pi", "flux divided by pi", true, false, false,
         [](In& in) { scaleFlux(in, [](const Map&) { return 1.0f / kPi; }); }},
        {"flux-times-pi", "flux-pi", "flux multiplied by pi", true, false, false,
         [](In& in) { scaleFlux(in, [](const Map&) { return kPi; }); }},
        {"flux-texels", "flux-texels", "flux divided by the number of texels twice", true, false, false,
         [](In& in) { scaleFlux(in, [](const Map& m) { return 1.0f / texelCount(m); }); }},
        {"flux-not-divided", "flux-texels", "each texel has the whole map's flux", true, false, false,
         [](In& in) { scaleFlux(in, texelCount); }},
        {"flux-lumens", "flux-scale", "flux in lumens, intensity in W/sr", true, false, false,
         [](In& in) { scaleFlux(in, [](const Map&) { return 683.0f; }); }},
        {"rsm-empty", "rsm-empty", "no flux at all", true, false, false,
         [](In& in) { scaleFlux(in, [](const Map&) { return 0.0f; }); }},
        {"rsm-elsewhere", "rsm-elsewhere", "RSMs of another place", true, true, false,
         [](In& in) {
             const float far = 1000.0f * middleDistance(in);
             eachMap(in, [&](Map& m, LWRsm& rsm) {
                 changePlaces(m.position, m.normal,
                              [&](const glm::vec3& p) { return p + glm::vec3(far, 0.0f, 0.0f); });
                 const glm::vec3 moved = rotationOf(rsm.camera) * glm::vec3(far, 0.0f, 0.0f);
                 for (int row = 0; row < 3; ++row) rsm.camera.view[4 * row + 3] -= moved[row];
             });
         }},
        {"rsm-light-space", "position-space", "RSM positions in the space of the light's camera", true,
         false, false,
         [](In& in) {
             eachMap(in, [](Map& m, LWRsm& rsm) {
                 changePlaces(m.position, m.normal,
                              [&](const glm::vec3& p) { return toView(rsm.camera, p); });
             });
         }},
        {"rsm-eye-space", "position-space", "RSM positions in the view space of the G-buffer's camera",
         true, false, false,
         [](In& in) {
             const LWCamera c = in.gbuffer.camera;
             eachMap(in, [&](Map& m, LWRsm&) {
                 changePlaces(m.position, m.normal, [&](const glm::vec3& p) { return toView(c, p); });
             });
         }},
        {"rsm-units", "units-differ", "RSM and its camera in centimetres, the rest in metres", true,
         false, false,
         [](In& in) {
             eachMap(in, [](Map& m, LWRsm& rsm) {
                 changePlaces(m.position, m.normal, [](const glm::vec3& p) { return 100.0f * p; });
                 scaleView(rsm.camera, 100.0f);
             });
             for (LWLight& light : in.lights)
                 for (float& v : light.position) v *= 100.0f;
             // An orthographic window is a length too.
             for (std::size_t l = 0; l < in.lights.size(); ++l)
                 if (in.lights[l].kind == LW_LIGHT_DIRECTIONAL)
                     for (LWRsm& rsm : in.rsms[l])
                         for (int k : {0, 5, 10}) rsm.camera.projection[k] /= 100.0f;
             for (std::size_t l = 0; l < in.lights.size(); ++l)
                 for (Map& m : in.maps[l])
                     for (float& v : m.flux.values)
                         v *= in.lights[l].kind == LW_LIGHT_DIRECTIONAL ? 1e4f : 1.0f;
         }},
        {"light-position", "light-camera", "a lamp's position in centimetres", true, false, true,
         [](In& in) {
             for (LWLight& light : in.lights)
                 for (float& v : light.position) v *= 100.0f;
         }},
    };
    return list;
}

studio::Camera cameraBefore(const studio::Camera& camera) {
    studio::Camera before = camera;
    const glm::vec3 way = camera.target - camera.position;
    const float distance = glm::length(way);
    const glm::vec3 right = glm::normalize(glm::cross(way, camera.up)),
                    up = glm::normalize(glm::cross(right, way));
    before.position += 0.01f * distance * (right + up);
    before.target += 0.06f * distance * (right - 0.7f * up);
    return before;
}

}  // namespace cli
