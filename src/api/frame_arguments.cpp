#include "api/frame_arguments.h"

#include <cmath>
#include <string>

#include "api/call.h"
#include "api/structs.h"
#include "inputs/image_check.h"
#include "inputs/points_input.h"
#include "inputs/rsm_input.h"
#include "shared/input_limits.h"

namespace lightwell {
namespace {

// Counts beyond these are garbage that would be read past the end of some array.
constexpr std::uint32_t kMaxLights = 4096;
constexpr std::uint32_t kMaxVpls = 1u << 24;
constexpr std::uint32_t kMaxStaticVpls = 4096;
constexpr float kMaxArea = 1e18f;  // of a sphere as large as positions reach
constexpr std::uint32_t kMaxProfile = 1024;
constexpr std::uint32_t kMaxBlockers = 1u << 20;
constexpr std::uint32_t kMaxSourceViews = 64;
constexpr std::uint32_t kMaxWaitEvents = 1024;
constexpr double kMostOrigin = 1e12;  // there a double's step is 1e-4

void checkCount(std::uint32_t count, const void* array, std::uint32_t most, const std::string& name,
                const char* countField, const char* arrayField) {
    if (count > most)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".", countField, ": expected at most ", most, ", got ",
             count);
    if (count > 0 && !array)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".", arrayField, ": expected an array of ", count,
             ", got null");
}

void checkFinite(const float* values, int count, const std::string& name, bool notNegative = false) {
    for (int i = 0; i < count; ++i)
        if (!std::isfinite(values[i]) || (notNegative && values[i] < 0.0f))
            fail(LW_ERROR_INVALID_ARGUMENT, name, ": expected finite numbers",
                 notNegative ? " of 0 or more" : "", ", got ", values[i]);
}

// Names of elements are made only where one is refused: thousands of strings take longer than a frame's light.
template <class Name>
void checkReceivers(std::uint32_t receivers, Name name) {
    constexpr std::uint32_t kAll = LW_RECEIVERS_UNBAKED | LW_RECEIVERS_BAKED;
    if (receivers > kAll)
        fail(LW_ERROR_INVALID_ARGUMENT, name(), ".receivers: expected bits of LWReceivers (0 .. ", kAll, "), got ", receivers);
}

void checkLight(const LWLight& light, const std::string& name) {
    checkFinite(light.position, 3, name + ".position");
    checkFinite(light.direction, 3, name + ".direction");
    checkFinite(light.irradiance, 3, name + ".irradiance", true);
    checkFinite(light.radiantIntensity, 3, name + ".radiantIntensity", true);
    checkFinite(&light.innerConeAngle, 1, name + ".innerConeAngle", true);
    constexpr float kRightAngle = 1.5707964f;
    if (!(light.outerConeAngle >= light.innerConeAngle && light.outerConeAngle <= kRightAngle))
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".outerConeAngle: expected innerConeAngle (",
             light.innerConeAngle, ") .. pi/2, got ", light.outerConeAngle);
    checkCount(light.profileCount, light.profile, kMaxProfile, name, "profileCount", "profile");
    if (light.profileCount == 1)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".profileCount: expected 0, or 2 .. ", kMaxProfile, ", got 1");
    for (std::uint32_t i = 0; i < light.profileCount; ++i)
        if (!(light.profile[i] >= 0.0f && light.profile[i] <= 1e6f))
            fail(LW_ERROR_INVALID_ARGUMENT, name, ".profile[", i, "]: expected 0 .. 1e6, got ", light.profile[i]);
    if (light.hit) checkFinite(light.hit, 3, name + ".hit");
    checkReceivers(light.receivers, [&] { return name; });
}

template <class Name>
void checkPosition(const float* p, Name name) {
    if (!(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] <= LW_LARGEST_DISTANCE * LW_LARGEST_DISTANCE))
        fail(LW_ERROR_INVALID_ARGUMENT, name(), ".position: expected at most ", LW_LARGEST_DISTANCE, " from the origin, got ", p[0], " ", p[1],
             " ", p[2]);
}

template <class Name>
void checkUnit(const float* n, Name name) {
    const float squared = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    // Two per cent: normals that a host stored in 8 bits per component.
    if (!(squared > 0.98f * 0.98f && squared < 1.02f * 1.02f))
        fail(LW_ERROR_INVALID_ARGUMENT, name(), ".normal: expected unit length, got ", std::sqrt(squared));
}

void checkStaticVpl(const LWStaticVpl& vpl, std::uint32_t index) {
    const auto name = [index] { return "frame.staticVpls[" + std::to_string(index) + "]"; };
    checkPosition(vpl.position, name);
    checkUnit(vpl.normal, name);
    if (!(vpl.weight >= 0.0f && vpl.weight <= kMaxArea))
        fail(LW_ERROR_INVALID_ARGUMENT, name(), ".weight: expected 0 .. ", kMaxArea, ", got ", vpl.weight);
    for (const float part : vpl.reflectance)
        if (!(part >= 0.0f && part <= 1.0f))
            fail(LW_ERROR_INVALID_ARGUMENT, name(), ".reflectance: expected 0 .. 1, got ", part);
    checkReceivers(vpl.receivers, name);
}

}  // namespace

SyncArgument::SyncArgument(const LWSync* from, void* clContext, const char* name) {
    if (!from) return;
    sync_ = readStruct(from, name);
    given_ = true;
    checkCount(sync_.waitEventCount, sync_.waitEvents, kMaxWaitEvents, name, "waitEventCount",
               "waitEvents");
    for (std::uint32_t i = 0; i < sync_.waitEventCount; ++i) {
        cl_context context = nullptr;
        if (!sync_.waitEvents[i] ||
            clGetEventInfo(static_cast<cl_event>(sync_.waitEvents[i]), CL_EVENT_CONTEXT, sizeof context,
                           &context, nullptr) != CL_SUCCESS ||
            context != clContext)
            fail(LW_ERROR_INVALID_ARGUMENT, name, ".waitEvents[", i,
                 "]: expected a cl_event of the device's context, got ",
                 sync_.waitEvents[i] ? "another" : "null");
    }
}

FrameArgument::FrameArgument(Call& call, const LWFrame* from) : frame_(readStruct(from, "frame")) {
    checkCount(frame_.lightCount, frame_.lights, kMaxLights, "frame", "lightCount", "lights");
    checkCount(frame_.vplCount, frame_.vpls, kMaxVpls, "frame", "vplCount", "vpls");
    checkCount(frame_.blockerCount, frame_.blockers, kMaxBlockers, "frame", "blockerCount", "blockers");
    checkCount(frame_.staticVplCount, frame_.staticVpls, kMaxStaticVpls, "frame", "staticVplCount", "staticVpls");
    checkCount(frame_.sourceViewCount, frame_.sourceViews, kMaxSourceViews, "frame", "sourceViewCount",
               "sourceViews");
    copyLights();
    copySourceViews(call);
    if (frame_.geometry) {
        geometry_ = readStruct(frame_.geometry, "frame.geometry");
        frame_.geometry = &geometry_;
    }
    checkNumbers();
}

void FrameArgument::copyLights() {
    lights_ = readStructs(frame_.lights, frame_.lightCount, "frame.lights");
    rsms_.reserve(lights_.size());
    for (std::size_t i = 0; i < lights_.size(); ++i) {
        LWLight& light = lights_[i];
        const std::string name = "frame.lights[" + std::to_string(i) + "]";
        checkLight(light, name);
        checkLightKind(light, name);
        checkCount(light.rsmCount, light.rsms, light.rsmCount, name, "rsmCount", "rsms");
        rsms_.push_back(readStructs(light.rsms, light.rsmCount, name + ".rsms"));
        light.rsms = rsms_.back().data();
    }
    frame_.lights = lights_.data();
}

void FrameArgument::copySourceViews(Call& call) {
    sourceGBuffers_.reserve(frame_.sourceViewCount);
    for (std::uint32_t i = 0; i < frame_.sourceViewCount; ++i) {
        const std::string name = "frame.sourceViews[" + std::to_string(i) + "]";
        const LWSourceView& source = frame_.sourceViews[i];
        call.viewOfDevice(source.view, (name + ".view").c_str());
        sourceGBuffers_.push_back(readStruct(source.gbuffer, name + ".gbuffer"));
        sourceViews_.push_back({source.view, &sourceGBuffers_.back()});
    }
    frame_.sourceViews = sourceViews_.data();
}

void FrameArgument::checkNumbers() const {
    checkFinite(frame_.environment, 3, "frame.environment", true);
    if (frame_.focus) checkFinite(frame_.focus, 3, "frame.focus");
    for (const double at : frame_.worldOrigin)
        if (!(std::abs(at) <= kMostOrigin))
            fail(LW_ERROR_INVALID_ARGUMENT, "frame.worldOrigin: expected finite numbers of at most ", kMostOrigin, ", got ", at);
    for (std::uint32_t i = 0; i < frame_.vplCount; ++i) {
        const LWVpl& vpl = frame_.vpls[i];
        const auto name = [i] { return "frame.vpls[" + std::to_string(i) + "]"; };
        checkPosition(vpl.position, name);
        if (!(vpl.area >= 0.0f && std::isfinite(vpl.area)))
            fail(LW_ERROR_INVALID_ARGUMENT, name(), ".area: expected a finite number of 0 or more, got ", vpl.area);
        for (const float flux : vpl.flux)
            if (!(flux >= 0.0f && flux <= LW_LARGEST_FLUX))
                fail(LW_ERROR_INVALID_ARGUMENT, name(), ".flux: expected 0 .. ", LW_LARGEST_FLUX, ", got ", flux);
        checkUnit(vpl.normal, name);
    }
    for (std::uint32_t i = 0; i < frame_.staticVplCount; ++i)
        checkStaticVpl(frame_.staticVpls[i], i);
    for (std::uint32_t i = 0; i < frame_.blockerCount; ++i) {
        const LWBlocker& blocker = frame_.blockers[i];
        if (std::isfinite(blocker.center[0]) && std::isfinite(blocker.center[1]) && std::isfinite(blocker.center[2]) &&
            blocker.radius >= 0.0f && std::isfinite(blocker.radius))
            continue;
        checkFinite(blocker.center, 3, "frame.blockers[" + std::to_string(i) + "].center");
        checkFinite(&blocker.radius, 1, "frame.blockers[" + std::to_string(i) + "].radius", true);
    }
}

PointsArgument::PointsArgument(const LWImage* positions, const LWImage* normals, std::uint32_t count, const LWPointOutput* output) {
    if (!positions) fail(LW_ERROR_INVALID_ARGUMENT, "positions: expected an image, got null");
    if (count == 0 || count > PointsInput::kMost)
        fail(LW_ERROR_INVALID_ARGUMENT, "count: expected 1 .. ", PointsInput::kMost, ", got ", count);
    points_.output = readStruct(output, "output");
    points_.positions = *positions;
    if (normals) points_.normals = *normals;
    points_.count = count;
    const auto given = [](const LWImage& image) { return !imageAbsent(image); };
    if (!given(points_.output.irradiance) && !given(points_.output.harmonics) && !given(points_.output.validity))
        fail(LW_ERROR_INVALID_ARGUMENT, "output: expected irradiance, harmonics or validity, got none");
    if (given(points_.output.irradiance) && !given(points_.normals))
        fail(LW_ERROR_INVALID_ARGUMENT, "normals: expected an image, as irradiance is asked for, got none");
}

}  // namespace lightwell
