// Handles of the C API that tests hold: created with REQUIRE, released at the end of the scope.
#pragma once

#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "lightwell/lightwell.h"
#include "support/lit_room.h"

namespace lightwell::test {

inline std::string lastError(LWDevice device) {
    const char* message = "";
    lwGetLastError(device, &message);
    return message;
}

class TestDevice {
public:
    explicit TestDevice(std::uint32_t width) {
        LWDeviceDesc desc;
        lwDefaultDevice(&desc);
        desc.width = width;
        REQUIRE(lwCreateDevice(&desc, &device_) == LW_SUCCESS);
    }
    ~TestDevice() { lwReleaseDevice(device_); }
    TestDevice(const TestDevice&) = delete;
    operator LWDevice() const { return device_; }
    LWDeviceInfo info() const {
        LWDeviceInfo info{};
        info.structSize = sizeof info;
        REQUIRE(lwGetDeviceInfo(device_, &info) == LW_SUCCESS);
        return info;
    }

private:
    LWDevice device_ = nullptr;
};

class TestView {
public:
    TestView(LWDevice device, std::uint32_t width, std::uint32_t height) : width_(width), height_(height) {
        LWViewDesc desc{};
        desc.structSize = sizeof desc;
        desc.maxWidth = width;
        desc.maxHeight = height;
        REQUIRE(lwCreateView(device, &desc, &view_) == LW_SUCCESS);
    }
    ~TestView() { lwReleaseView(view_); }
    TestView(const TestView&) = delete;
    operator LWView() const { return view_; }
    void resize(std::uint32_t width, std::uint32_t height) {
        REQUIRE(lwSetViewSize(view_, width, height) == LW_SUCCESS);
        width_ = width;
        height_ = height;
    }
    std::uint32_t width() const { return width_; }
    std::uint32_t height() const { return height_; }

private:
    LWView view_ = nullptr;
    std::uint32_t width_, height_;
};

class TestTechnique {
public:
    TestTechnique(LWDevice device, const LWRsmDesc& desc) : TestTechnique(device, "rsm", &desc) {}
    TestTechnique(LWDevice device, const LWSsvpDesc& desc) : TestTechnique(device, "ssvp", &desc) {}
    TestTechnique(LWDevice device, const LWScreenSpaceDesc& desc) : TestTechnique(device, "screen_space", &desc) {}
    TestTechnique(LWDevice device, const char* name, const void* desc) : device_(device) {
        const LWStatus status = lwCreateTechnique(device, name, desc, &technique_);
        INFO(lastError(device));
        REQUIRE(status == LW_SUCCESS);
    }
    ~TestTechnique() { lwReleaseTechnique(technique_); }
    TestTechnique(const TestTechnique&) = delete;
    operator LWTechnique() const { return technique_; }

    void update(const std::vector<LWLight>& lights) {
        LWFrame frame{};
        frame.structSize = sizeof frame;
        frame.lightCount = std::uint32_t(lights.size());
        frame.lights = lights.data();
        update(frame);
    }
    void update(const LWFrame& frame) {
        const LWStatus status = lwUpdate(technique_, &frame);
        INFO(lastError(device_));
        REQUIRE(status == LW_SUCCESS);
    }
    // Waits; irradiance as packed planes.
    std::vector<float> render(const TestView& view, const LWGBuffer& gbuffer) {
        PlanarPixels irradiance(view.width(), view.height(), 3);
        LWOutput output{};
        output.structSize = sizeof output;
        output.irradiance = irradiance.image();
        const LWStatus status = lwRender(technique_, view, &gbuffer, &output);
        INFO(lastError(device_));
        REQUIRE(status == LW_SUCCESS);
        REQUIRE(lwFinish(device_) == LW_SUCCESS);
        return irradiance.packed();
    }
    LWStats stats() {
        LWStats stats{};
        stats.structSize = sizeof stats;
        REQUIRE(lwGetStats(technique_, &stats) == LW_SUCCESS);
        return stats;
    }
    std::uint64_t count(const std::string& name) {
        const LWStats all = stats();
        for (std::uint32_t i = 0; i < all.countCount; ++i)
            if (name == all.counts[i].name) return all.counts[i].value;
        FAIL("no count of this name: " << name);
        return 0;
    }

private:
    LWDevice device_;
    LWTechnique technique_ = nullptr;
};

}  // namespace lightwell::test
