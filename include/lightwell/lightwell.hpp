// Lightwell's handles for C++17: owned, shared and released; errors thrown. Nothing else: structs, units
// and rules are lightwell.h's.
//
// Copyright 2026 The Lightwell authors. Licensed under the Apache License, Version 2.0.
//
//     lightwell::Device device;
//     lightwell::View view(device, 1280, 720);
//     lightwell::Technique technique(device, "rsm");
//     technique.update(frame);
//     technique.render(view, gbuffer, output);
//     device.finish();
#ifndef LIGHTWELL_LIGHTWELL_HPP
#define LIGHTWELL_LIGHTWELL_HPP

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "lightwell/lightwell.h"

namespace lightwell {
// The library has classes of the same names inside; this keeps the two apart in one program.
inline namespace host {

// A failed call: its status, and the message that names argument, expectation and what came.
class Error : public std::runtime_error {
public:
    Error(LWStatus status, const std::string& message) : std::runtime_error(message), status_(status) {}
    LWStatus status() const noexcept { return status_; }

private:
    LWStatus status_;
};

// A struct with everything zero and its structSize set: `auto frame = lightwell::make<LWFrame>();`
template <class Struct>
Struct make() {
    Struct result{};
    result.structSize = sizeof(Struct);
    return result;
}

// Throws on failure. `device` may be null: then the thread's own last error is meant.
inline void check(LWStatus status, LWDevice device = nullptr) {
    if (status == LW_SUCCESS) return;
    const char* message = nullptr;
    LWStatus kept = lwGetLastError(device, &message);
    // A call whose own handle was bad is kept by the thread.
    if (kept == LW_SUCCESS && device) kept = lwGetLastError(nullptr, &message);
    throw Error(status, kept != LW_SUCCESS && message && *message ? message : lwStatusName(status));
}

// One reference to a handle. Copies share it.
template <class Raw, LWStatus (*retain)(Raw), LWStatus (*release)(Raw)>
class Handle {
public:
    Handle() = default;
    // Takes over the caller's reference.
    explicit Handle(Raw raw) noexcept : raw_(raw) {}
    Handle(const Handle& other) : raw_(other.raw_) {
        if (raw_) check(retain(raw_));
    }
    Handle(Handle&& other) noexcept : raw_(std::exchange(other.raw_, nullptr)) {}
    Handle& operator=(Handle other) noexcept {
        std::swap(raw_, other.raw_);
        return *this;
    }
    ~Handle() {
        if (raw_) release(raw_);
    }
    Raw get() const noexcept { return raw_; }
    explicit operator bool() const noexcept { return raw_ != nullptr; }

private:
    Raw raw_ = nullptr;
};

class Device {
public:
    Device() : Device(defaults()) {}
    explicit Device(const LWDeviceDesc& desc) {
        LWDevice raw = nullptr;
        check(lwCreateDevice(&desc, &raw));
        handle_ = decltype(handle_)(raw);
    }
    static LWDeviceDesc defaults() {
        LWDeviceDesc desc;
        lwDefaultDevice(&desc);
        return desc;
    }
    LWDevice get() const noexcept { return handle_.get(); }

    void finish() { check(lwFinish(get()), get()); }
    LWDeviceInfo info() const {
        auto result = make<LWDeviceInfo>();
        check(lwGetDeviceInfo(get(), &result), get());
        return result;
    }
    LWRoofline probe() {
        auto result = make<LWRoofline>();
        check(lwProbeDevice(get(), &result), get());
        return result;
    }
    std::uint64_t estimateMemory(const char* technique, const void* desc, std::uint32_t maxWidth,
                                 std::uint32_t maxHeight, std::uint64_t rsmTexels) const {
        auto view = make<LWViewDesc>();
        view.maxWidth = maxWidth;
        view.maxHeight = maxHeight;
        std::uint64_t bytes = 0;
        check(lwEstimateMemory(get(), technique, desc, &view, rsmTexels, &bytes), get());
        return bytes;
    }
    // The same for this frame's maps, VPLs and geometry.
    std::uint64_t estimateMemory(const char* technique, const void* desc, std::uint32_t maxWidth,
                                 std::uint32_t maxHeight, const LWFrame& frame) const {
        auto view = make<LWViewDesc>();
        view.maxWidth = maxWidth;
        view.maxHeight = maxHeight;
        std::uint64_t bytes = 0;
        check(lwEstimateFrameMemory(get(), technique, desc, &view, &frame, &bytes), get());
        return bytes;
    }

private:
    Handle<LWDevice, lwRetainDevice, lwReleaseDevice> handle_;
};

class View {
public:
    View(const Device& device, std::uint32_t maxWidth, std::uint32_t maxHeight) : device_(device) {
        auto desc = make<LWViewDesc>();
        desc.maxWidth = maxWidth;
        desc.maxHeight = maxHeight;
        LWView raw = nullptr;
        check(lwCreateView(device_.get(), &desc, &raw), device_.get());
        handle_ = decltype(handle_)(raw);
    }
    LWView get() const noexcept { return handle_.get(); }
    LWDevice device() const noexcept { return device_.get(); }

    void setSize(std::uint32_t width, std::uint32_t height) {
        check(lwSetViewSize(get(), width, height), device_.get());
    }
    std::pair<std::uint32_t, std::uint32_t> size() const {
        std::pair<std::uint32_t, std::uint32_t> result;
        check(lwGetViewSize(get(), &result.first, &result.second), device_.get());
        return result;
    }

private:
    Device device_;
    Handle<LWView, lwRetainView, lwReleaseView> handle_;
};

// What is wrong with a frame's inputs, the most severe first; `frame`, `gbuffer` and `overlay` may be null
// as lwCheckInputs says.
inline std::vector<LWInputFinding> checkInputs(const View& view, const LWFrame* frame, const LWGBuffer* gbuffer,
                                               const LWImage* overlay = nullptr) {
    std::vector<LWInputFinding> findings(64);
    for (;;) {
        const auto room = static_cast<std::uint32_t>(findings.size());
        std::uint32_t count = 0;
        check(lwCheckInputs(view.get(), frame, gbuffer, findings.data(), room, &count, overlay), view.device());
        findings.resize(count);
        if (count <= room) return findings;
    }
}

// What to run for this frame, and what to expect of it.
inline LWPlan plan(const View& view, const LWFrame& frame, const LWGBuffer& gbuffer, const LWPlanDesc& desc) {
    auto result = make<LWPlan>();
    check(lwPlan(view.get(), &frame, &gbuffer, &desc, &result), view.device());
    return result;
}

// All that could be run, quickest first.
inline std::vector<LWPlan> listPlans(const View& view, const LWFrame& frame, const LWGBuffer& gbuffer, const LWPlanDesc& desc) {
    std::vector<LWPlan> plans(64, make<LWPlan>());
    for (;;) {
        const auto room = static_cast<std::uint32_t>(plans.size());
        std::uint32_t count = 0;
        check(lwListPlans(view.get(), &frame, &gbuffer, &desc, plans.data(), room, &count), view.device());
        plans.resize(count, make<LWPlan>());
        if (count <= room) return plans;
    }
}

class Technique {
public:
    // `desc`: the technique's own descriptor, or null for its defaults.
    Technique(const Device& device, const char* name, const void* desc = nullptr) : device_(device) {
        LWTechnique raw = nullptr;
        check(lwCreateTechnique(device_.get(), name, desc, &raw), device_.get());
        handle_ = decltype(handle_)(raw);
    }
    // From text, as lwCreateTechniqueFromText takes it: "vpls=256 interleave=4".
    static Technique fromText(const Device& device, const char* name, const char* settings) {
        LWTechnique raw = nullptr;
        check(lwCreateTechniqueFromText(device.get(), name, settings, &raw), device.get());
        return Technique(device, raw);
    }
    LWTechnique get() const noexcept { return handle_.get(); }

    void prewarm(const View& view) { check(lwPrewarm(get(), view.get()), device_.get()); }
    void update(const LWFrame& frame) { check(lwUpdate(get(), &frame), device_.get()); }
    void render(const View& view, const LWGBuffer& gbuffer, const LWOutput& output) {
        check(lwRender(get(), view.get(), &gbuffer, &output), device_.get());
    }
    void renderPoints(const LWImage& positions, const LWImage* normals, std::uint32_t count, const LWPointOutput& output) {
        check(lwRenderPoints(get(), &positions, normals, count, &output), device_.get());
    }
    // The light of the last update as lights, of techniques that have it so; no more than the technique's `lights`.
    std::vector<LWListedLight> readLightList() const {
        std::vector<LWListedLight> lights(64);  // the most that a technique can be asked for
        std::uint32_t count = 0;
        check(lwReadLightList(get(), lights.data(), static_cast<std::uint32_t>(lights.size()), &count), device_.get());
        lights.resize(count);
        return lights;
    }
    // The arrays it points to live until the next call.
    LWStats stats() const {
        auto result = make<LWStats>();
        check(lwGetStats(get(), &result), device_.get());
        return result;
    }
    std::vector<LWDebugView> debugViews(const View* view = nullptr) const {
        const LWView raw = view ? view->get() : nullptr;
        std::uint32_t count = 0;
        check(lwCountDebugViews(get(), raw, &count), device_.get());
        std::vector<LWDebugView> result(count, make<LWDebugView>());
        for (std::uint32_t i = 0; i < count; ++i)
            check(lwDescribeDebugView(get(), raw, i, &result[i]), device_.get());
        return result;
    }
    std::vector<float> readDebugView(const LWDebugView& info, const View* view = nullptr) const {
        std::vector<float> pixels(std::size_t(info.width) * info.height * info.channels);
        check(lwReadDebugView(get(), view ? view->get() : nullptr, info.name, pixels.data(),
                              pixels.size()),
              device_.get());
        return pixels;
    }

private:
    Technique(Device device, LWTechnique raw) : device_(std::move(device)), handle_(raw) {}

    Device device_;
    Handle<LWTechnique, lwRetainTechnique, lwReleaseTechnique> handle_;
};

}  // namespace host
}  // namespace lightwell

#endif
