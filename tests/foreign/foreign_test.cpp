// One frame in another engine's conventions (left-handed, centimetres, depth only, reversed z, bottom-up
// rows, octahedral normals), drawn and gathered by make_frame.py, which shares no code with Lightwell:
// technique rsm with every texel must reach the script's double-precision irradiance.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "lightwell/lightwell.h"

namespace {

// Of the mean irradiance over all expected pixels. Positions come from 32-bit depth and normals from two
// 16-bit integers; beside a lit surface one texel dominates, and its distance is a difference of large
// numbers. Measured: 8.8e-7 in the mean, 2.8e-5 at worst; these are three times as much.
constexpr double kToleranceMean = 3e-6;
constexpr double kTolerancePixel = 1e-4;

constexpr float kCanary = -1000.0f;

struct Expected {
    int column, rowFromBottom;
    double irradiance[3];
};

// The script's frame.txt and raw images.
struct Frame {
    int viewSize[2], rsmSize[2];
    LWCamera view, rsm;
    float spotPosition[3], spotDirection[3], spotIntensity[3], spotHalfAngles[2];
    std::vector<Expected> expected;
    std::vector<char> viewDepth, viewNormal, rsmDepth, rsmNormal, rsmFlux;
};

template <class T>
void readNumbers(std::istream& text, const char* key, T* values, int count) {
    std::string word;
    text >> word;
    INFO("frame.txt, key " << key << ", found " << word);
    REQUIRE(word == key);
    for (int i = 0; i < count; ++i) text >> values[i];
    REQUIRE(text);
}

std::vector<char> readBytes(const std::string& name, std::size_t bytes) {
    std::ifstream file(std::string(LIGHTWELL_FOREIGN_FRAME) + "/" + name, std::ios::binary);
    std::vector<char> data{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    INFO(name);
    REQUIRE(data.size() == bytes);
    return data;
}

Frame readFrame() {
    Frame frame;
    std::ifstream text(LIGHTWELL_FOREIGN_FRAME "/frame.txt");
    readNumbers(text, "view_size", frame.viewSize, 2);
    readNumbers(text, "view_view", frame.view.view, 16);
    readNumbers(text, "view_projection", frame.view.projection, 16);
    readNumbers(text, "rsm_size", frame.rsmSize, 2);
    readNumbers(text, "rsm_view", frame.rsm.view, 16);
    readNumbers(text, "rsm_projection", frame.rsm.projection, 16);
    readNumbers(text, "spot_position", frame.spotPosition, 3);
    readNumbers(text, "spot_direction", frame.spotDirection, 3);
    readNumbers(text, "spot_intensity", frame.spotIntensity, 3);
    readNumbers(text, "spot_half_angles", frame.spotHalfAngles, 2);
    int count = 0;
    readNumbers(text, "expected_count", &count, 1);
    for (int i = 0; i < count; ++i) {
        Expected pixel;
        text >> pixel.column >> pixel.rowFromBottom;
        for (double& channel : pixel.irradiance) text >> channel;
        REQUIRE(text);
        frame.expected.push_back(pixel);
    }
    const std::size_t pixels = std::size_t(frame.viewSize[0] * frame.viewSize[1]);
    const std::size_t texels = std::size_t(frame.rsmSize[0] * frame.rsmSize[1]);
    frame.viewDepth = readBytes("view_depth.f32", pixels * 4);
    frame.viewNormal = readBytes("view_normal.oct16x2", pixels * 4);
    frame.rsmDepth = readBytes("rsm_depth.f32", texels * 4);
    frame.rsmNormal = readBytes("rsm_normal.f32x4", texels * 16);
    frame.rsmFlux = readBytes("rsm_flux.f32x3", texels * 12);
    return frame;
}

// Memory whose first row is the picture's bottom row.
LWImage bottomUp(const void* memory, LWFormat format, const int (&size)[2], int bytesPerPixel) {
    const std::int64_t rowBytes = std::int64_t(size[0]) * bytesPerPixel;
    LWImage image = {};
    image.host = memory;
    image.format = format;
    image.width = std::uint32_t(size[0]);
    image.height = std::uint32_t(size[1]);
    image.byteOffset = std::uint64_t(rowBytes * (size[1] - 1));
    image.byteRowStride = -rowBytes;
    return image;
}

struct Handles {
    LWDevice device = nullptr;
    LWView view = nullptr;
    LWTechnique technique = nullptr;
    ~Handles() {
        if (technique) lwReleaseTechnique(technique);
        if (view) lwReleaseView(view);
        if (device) lwReleaseDevice(device);
    }
    void check(LWStatus status) const {
        const char* message = "";
        if (status != LW_SUCCESS) lwGetLastError(device, &message);
        INFO(lwStatusName(status) << ": " << message);
        REQUIRE(status == LW_SUCCESS);
    }
};

LWLight spotLight(const Frame& frame, const LWRsm& rsm) {
    LWLight light;
    LW_INIT(light);
    light.kind = LW_LIGHT_SPOT;
    std::copy_n(frame.spotPosition, 3, light.position);
    std::copy_n(frame.spotDirection, 3, light.direction);
    std::copy_n(frame.spotIntensity, 3, light.radiantIntensity);
    light.innerConeAngle = frame.spotHalfAngles[0];
    light.outerConeAngle = frame.spotHalfAngles[1];
    light.rsmCount = 1;
    light.rsms = &rsm;
    return light;
}

LWRsm rsmOf(const Frame& frame) {
    LWRsm rsm;
    LW_INIT(rsm);
    rsm.depthKind = LW_DEPTH_ZERO_TO_ONE;
    rsm.depth = bottomUp(frame.rsmDepth.data(), LW_FORMAT_FLOAT1, frame.rsmSize, 4);
    rsm.normal = bottomUp(frame.rsmNormal.data(), LW_FORMAT_FLOAT4, frame.rsmSize, 16);
    rsm.flux = bottomUp(frame.rsmFlux.data(), LW_FORMAT_FLOAT3, frame.rsmSize, 12);
    rsm.camera = frame.rsm;
    return rsm;
}

LWGBuffer gbufferOf(const Frame& frame) {
    LWGBuffer gbuffer;
    LW_INIT(gbuffer);
    gbuffer.depthKind = LW_DEPTH_ZERO_TO_ONE;
    gbuffer.depth = bottomUp(frame.viewDepth.data(), LW_FORMAT_FLOAT1, frame.viewSize, 4);
    gbuffer.normal = bottomUp(frame.viewNormal.data(), LW_FORMAT_OCT16X2, frame.viewSize, 4);
    gbuffer.camera = gbuffer.previousCamera = frame.view;
    return gbuffer;
}

// Irradiance, float4, bottom row first.
std::vector<float> render(const Frame& frame, std::uint32_t width) {
    Handles lw;
    LWDeviceDesc deviceDesc;
    lwDefaultDevice(&deviceDesc);
    deviceDesc.width = width;
    lw.check(lwCreateDevice(&deviceDesc, &lw.device));
    LWViewDesc viewDesc;
    LW_INIT(viewDesc);
    viewDesc.maxWidth = std::uint32_t(frame.viewSize[0]);
    viewDesc.maxHeight = std::uint32_t(frame.viewSize[1]);
    lw.check(lwCreateView(lw.device, &viewDesc, &lw.view));
    LWRsmDesc desc;
    lwDefaultRsm(&desc);
    desc.vpls = 0;
    desc.interleave = 1;
    desc.resolution = LW_RESOLUTION_FULL;
    lw.check(lwCreateRsm(lw.device, &desc, &lw.technique));

    const LWRsm rsm = rsmOf(frame);
    const LWLight light = spotLight(frame, rsm);
    LWFrame world;
    LW_INIT(world);
    world.lightCount = 1;
    world.lights = &light;
    lw.check(lwUpdate(lw.technique, &world));

    const LWGBuffer gbuffer = gbufferOf(frame);
    std::vector<float> irradiance(std::size_t(4 * frame.viewSize[0] * frame.viewSize[1]), kCanary);
    LWOutput output;
    LW_INIT(output);
    output.irradiance = bottomUp(irradiance.data(), LW_FORMAT_FLOAT4, frame.viewSize, 16);
    lw.check(lwRender(lw.technique, lw.view, &gbuffer, &output));
    lw.check(lwFinish(lw.device));
    return irradiance;
}

void compare(const Frame& frame, const std::vector<float>& irradiance) {
    double mean = 0.0, meanError = 0.0, worst = 0.0;
    for (const Expected& pixel : frame.expected)
        for (double channel : pixel.irradiance) mean += channel;
    const double values = 3.0 * double(frame.expected.size());
    mean /= values;
    REQUIRE(mean > 0.0);
    for (const Expected& pixel : frame.expected) {
        const std::size_t at = 4 * std::size_t(pixel.rowFromBottom * frame.viewSize[0] + pixel.column);
        for (std::size_t c = 0; c < 3; ++c) {
            const double error = std::abs(double(irradiance[at + c]) - pixel.irradiance[c]) / mean;
            CAPTURE(pixel.column, pixel.rowFromBottom, c, irradiance[at + c], pixel.irradiance[c], mean);
            CHECK(error <= kTolerancePixel);
            if (pixel.irradiance[c] == 0.0) CHECK(irradiance[at + c] == 0.0f);
            meanError += error / values;
            worst = std::max(worst, error);
        }
    }
    INFO("mean error " << meanError << ", worst " << worst << " of the mean irradiance " << mean);
    CHECK(meanError <= kToleranceMean);
}

}  // namespace

TEST_CASE("a frame in foreign conventions reaches the independent sum over all texels", "[foreign]") {
    const Frame frame = readFrame();
    const std::uint32_t width = GENERATE(1u, 16u);
    CAPTURE(width);
    compare(frame, render(frame, width));
}

// Left-handed, centimetres, reversed depth, bottom-up rows, octahedral normals: all of it is allowed. What is not
// said rightly is found.
TEST_CASE("the input checker finds nothing wrong with foreign conventions, and what is said wrongly", "[foreign]") {
    const Frame frame = readFrame();
    Handles lw;
    lw.check(lwCreateDevice(nullptr, &lw.device));
    LWViewDesc viewDesc;
    LW_INIT(viewDesc);
    viewDesc.maxWidth = std::uint32_t(frame.viewSize[0]);
    viewDesc.maxHeight = std::uint32_t(frame.viewSize[1]);
    lw.check(lwCreateView(lw.device, &viewDesc, &lw.view));
    LWRsm rsm = rsmOf(frame);
    LWGBuffer gbuffer = gbufferOf(frame);
    const auto first = [&] {
        const LWLight light = spotLight(frame, rsm);
        LWFrame world;
        LW_INIT(world);
        world.lightCount = 1;
        world.lights = &light;
        LWInputFinding finding = {};
        std::uint32_t count = 0;
        lw.check(lwCheckInputs(lw.view, &world, &gbuffer, &finding, 1, &count, nullptr));
        INFO(finding.message);
        return count ? int(finding.fault) : -1;
    };
    CHECK(first() == -1);

    std::vector<float> depth(frame.viewDepth.size() / sizeof(float));
    std::copy(frame.viewDepth.begin(), frame.viewDepth.end(), reinterpret_cast<char*>(depth.data()));
    for (float& d : depth) d = 1.0f - d;
    gbuffer.depth = bottomUp(depth.data(), LW_FORMAT_FLOAT1, frame.viewSize, 4);
    CHECK(first() == LW_FAULT_DEPTH_REVERSED);

    gbuffer = gbufferOf(frame);
    gbuffer.depthKind = LW_DEPTH_AXIAL;
    CHECK(first() == LW_FAULT_DEPTH_KIND);

    // Normals top row first beside depth bottom row first.
    gbuffer = gbufferOf(frame);
    gbuffer.normal.byteOffset = 0;
    gbuffer.normal.byteRowStride = -gbuffer.normal.byteRowStride;
    CHECK(first() == LW_FAULT_IMAGE_FLIPPED);
}
