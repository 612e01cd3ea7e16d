// The plants, one entry for each.
#include "check_plant.h"

#include <algorithm>
#include <limits>

#include "check_plant_tools.h"
#include "image.h"

namespace cli {
namespace {

using Pixels = PlantedInputs::Pixels;

float texelCount(const PlantedInputs::Map& map) {
    return float(map.flux.width) * float(map.flux.height);
}

constexpr float kPi = studio::kPi;
const float kNaN = std::numeric_limits<float>::quiet_NaN();

}  // namespace
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
        {"direct-pi", "direct-scale", "direct radiance without 1/pi", true, false, false,
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
        {"far-from-origin", "far-from-origin", "all of the world far from its origin, in floats", false, false, false, moveFar},
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
