#include "inputs/static_vpl_input.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <glm/glm.hpp>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/camera.h"
#include "inputs/input_light.h"
#include "shared/input_limits.h"

namespace lightwell {
namespace {

constexpr std::uint32_t kAllReceivers = LW_RECEIVERS_UNBAKED | LW_RECEIVERS_BAKED;
static_assert(LW_RECEIVERS_UNBAKED == LW_RECEIVER_UNBAKED && LW_RECEIVERS_BAKED == LW_RECEIVER_BAKED,
              "kernels take LWReceivers");

std::uint32_t receiversOf(std::uint32_t given) {
    return given == LW_RECEIVERS_ALL ? kAllReceivers : given;
}
std::uint32_t maskOf(std::uint32_t given) {
    return given == 0 ? ~0u : given;
}

float asFloat(std::uint32_t bits) {
    float value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

// Float numbers of the parts, each on a border of 16.
std::uint32_t padded(std::uint64_t floats) {
    return paddedWidth(std::uint32_t(floats));
}

std::uint32_t strideOf(std::uint32_t places) {
    return paddedWidth(std::max(places, 1u));
}

lw_static_light lightOf(const LWLight& light) {
    lw_static_light l{};
    const glm::dvec3 sent = glm::min(emitted(light), glm::dvec3(double(LW_LARGEST_FLUX)));
    const glm::dvec3 axis(light.direction[0], light.direction[1], light.direction[2]);
    const double length = glm::length(axis);
    const glm::dvec3 unit = length > 0.0 ? axis / length : glm::dvec3(0.0);
    l.emitted = float4(sent.x, sent.y, sent.z, 0.0);
    double scale = 0.0, offset = 1.0;
    if (light.kind == LW_LIGHT_SPOT && length > 0.0) {
        // KHR_lights_punctual, as coneFalloff of input_light.cpp has it.
        const double inner = std::cos(double(light.innerConeAngle)),
                     outer = std::cos(double(light.outerConeAngle));
        scale = 1.0 / std::max(1e-3, inner - outer);
        offset = -outer * scale;
    }
    l.position = float4(light.position[0], light.position[1], light.position[2], scale);
    l.axis = float4(unit.x, unit.y, unit.z, offset);
    l.kind = light.kind == LW_LIGHT_DIRECTIONAL ? LW_STATIC_DIRECTIONAL : LW_STATIC_PUNCTUAL;
    l.mask = cl_int(maskOf(light.mask));
    l.receivers = cl_int(receiversOf(light.receivers));
    return l;
}

bool hasProfile(const LWLight& light) {
    return light.profileCount > 0 && light.kind != LW_LIGHT_DIRECTIONAL;
}

// As of all other positions; beyond, squares of distances leave float's range, and a second bounce were
// no number.
void checkReach(const float* p, std::uint32_t light, const char* field) {
    if (!(glm::length(glm::dvec3(p[0], p[1], p[2])) <= double(LW_LARGEST_DISTANCE)))
        fail(LW_ERROR_INVALID_ARGUMENT, "frame.lights[", light, "].", field, ": expected at most ",
             LW_LARGEST_DISTANCE, " from the origin for technique static_vpl, got ", p[0], " ", p[1],
             " ", p[2]);
}

}  // namespace

void StaticVplInput::check(const LWFrame& frame) {
    if (frame.blockerCount > kMostBlockers)
        fail(LW_ERROR_INVALID_ARGUMENT, "frame.blockerCount: expected at most ", kMostBlockers,
             " for technique static_vpl, got ", frame.blockerCount);
    for (std::uint32_t i = 0; i < frame.lightCount; ++i) {
        const LWLight& light = frame.lights[i];
        if (light.kind == LW_LIGHT_DIRECTIONAL) continue;
        checkReach(light.position, i, "position");
        if (light.kind == LW_LIGHT_SPOT && light.hit) checkReach(light.hit, i, "hit");
        const float* d = light.direction;
        if (hasProfile(light) && d[0] == 0.0f && d[1] == 0.0f && d[2] == 0.0f)
            fail(LW_ERROR_INVALID_ARGUMENT, "frame.lights[", i,
                 "].direction: expected one, as `profile` goes by the angle to it, got 0 0 0");
    }
}

void StaticVplInput::measure(const LWFrame& frame) {
    float low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
    for (std::uint32_t i = 0; i < frame.staticVplCount; ++i)
        for (int a = 0; a < 3; ++a) {
            const float x = frame.staticVpls[i].position[a];
            low[a] = i ? std::min(low[a], x) : x;
            high[a] = i ? std::max(high[a], x) : x;
        }
    const glm::dvec3 size(double(high[0]) - double(low[0]), double(high[1]) - double(low[1]),
                          double(high[2]) - double(low[2]));
    diagonal_ = glm::length(size);
    meanSide_ = (size.x + size.y + size.z) / 3.0;
}

void StaticVplInput::packPlaces(const LWFrame& frame, float unitArea) {
    float* places = packed_.data() + frame_.places;
    const auto stride = std::size_t(frame_.stride);
    // Padding has an area of its own, and no receivers.
    std::fill(places + LW_PLACE_AREA * stride + frame.staticVplCount,
              places + (LW_PLACE_AREA + 1) * stride, 1.0f);
    for (std::size_t i = 0; i < frame.staticVplCount; ++i) {
        const LWStaticVpl& vpl = frame.staticVpls[i];
        const glm::dvec3 normal =
            glm::normalize(glm::dvec3(vpl.normal[0], vpl.normal[1], vpl.normal[2]));
        for (std::size_t a = 0; a < 3; ++a) {
            places[(LW_PLACE_POSITION + a) * stride + i] = vpl.position[a];
            places[(LW_PLACE_NORMAL + a) * stride + i] = float(normal[glm::length_t(a)]);
            places[(LW_PLACE_REFLECTANCE + a) * stride + i] = vpl.reflectance[a];
        }
        // 0 is an area by distance; what floats cannot hold of a small one is not.
        const double least = vpl.weight > 0.0f ? double(std::numeric_limits<float>::min()) : 0.0;
        places[LW_PLACE_AREA * stride + i] =
            float(std::clamp(double(vpl.weight) * double(unitArea), least, 1e18));
        places[LW_PLACE_LIGHTS * stride + i] = asFloat(maskOf(vpl.lightMask));
        places[LW_PLACE_RECEIVERS * stride + i] = asFloat(receiversOf(vpl.receivers));
        anyAutomatic_ |= vpl.weight == 0.0f;
        bakedReceivers_ |= receiversOf(vpl.receivers) != kAllReceivers;
    }
}

void StaticVplInput::packLights(const LWFrame& frame, const std::vector<lw_phantom>& phantoms) {
    int profile = 0;
    for (std::uint32_t i = 0; i < frame.lightCount; ++i) {
        const LWLight& given = frame.lights[i];
        lw_static_light light = lightOf(given);
        bakedReceivers_ |= cl_uint(light.receivers) != kAllReceivers;
        if (hasProfile(given)) {
            light.profile = profile;
            light.profileCount = cl_int(given.profileCount);
            std::copy(given.profile, given.profile + given.profileCount,
                      packed_.data() + frame_.profiles + profile);
            profile += light.profileCount;
        }
        for (const lw_phantom& phantom : phantoms)
            if (std::uint32_t(phantom.light) == i) light.mask = 0;
        std::memcpy(packed_.data() + frame_.lights + std::size_t(i) * LW_STATIC_LIGHT_FLOATS, &light,
                    sizeof light);
    }
    if (!phantoms.empty())
        std::memcpy(packed_.data() + frame_.phantoms, phantoms.data(),
                    phantoms.size() * sizeof(lw_phantom));
}

void StaticVplInput::import(Executor& executor, const LWFrame& frame, float unitArea, bool automatic,
                            const std::vector<lw_phantom>& phantoms) {
    check(frame);
    std::uint64_t profileValues = 0;
    for (std::uint32_t i = 0; i < frame.lightCount; ++i) profileValues += frame.lights[i].profileCount;
    lw_static_frame next{};
    std::uint32_t at = LW_FRAME_WORDS;
    const auto take = [&at](std::uint64_t floats) {
        const std::uint32_t first = at;
        at += padded(floats);
        return cl_int(first);
    };
    next.count = cl_int(frame.staticVplCount);
    next.stride = cl_int(strideOf(frame.staticVplCount));
    next.lights = take(std::uint64_t(frame.lightCount) * LW_STATIC_LIGHT_FLOATS);
    next.lightCount = cl_int(frame.lightCount);
    next.phantoms = take(phantoms.size() * LW_PHANTOM_FLOATS);
    next.phantomCount = cl_int(phantoms.size());
    next.blockers = take(std::uint64_t(frame.blockerCount) * 4);
    next.profiles = take(profileValues);
    next.places = take(std::uint64_t(next.stride) * LW_PLACE_PLANES);
    next.automatic = automatic ? 1 : 0;
    memory_.reserve(executor.device(), std::size_t(at) * sizeof(float), "static VPLs");
    frame_ = next;
    packed_.assign(at, 0.0f);
    anyAutomatic_ = automatic;
    bakedReceivers_ = false;
    measure(frame);
    packPlaces(frame, unitArea);
    packLights(frame, phantoms);
    for (std::uint32_t i = 0; i < frame.blockerCount; ++i) {
        const LWBlocker& blocker = frame.blockers[i];
        const float inverse = float(1.0 / (double(blocker.radius) * double(blocker.radius)));
        if (!std::isfinite(inverse)) continue;  // of no size: it blocks nothing
        float* to = packed_.data() + frame_.blockers + 4 * std::size_t(frame_.blockerCount++);
        std::copy(blocker.center, blocker.center + 3, to);
        to[3] = inverse;
    }
    executor.writeCopy("static_vpl_input.upload", memory_, 0, packed_.size() * sizeof(float),
                       packed_.data());
}

std::uint64_t StaticVplInput::estimateBytes(const FrameShape& shape, bool phantoms) {
    const std::uint64_t floats =
        LW_FRAME_WORDS + padded(std::uint64_t(shape.lightCount) * LW_STATIC_LIGHT_FLOATS) +
        (phantoms ? padded(std::uint64_t(shape.aimedSpots) * LW_PHANTOM_FLOATS) : 0) +
        padded(std::uint64_t(shape.blockerCount) * 4) + padded(shape.profileValues) +
        padded(std::uint64_t(strideOf(shape.staticVplCount)) * LW_PLACE_PLANES);
    return floats * sizeof(float);
}

}  // namespace lightwell
