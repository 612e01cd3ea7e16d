// Technique ssvp's stages from frame to frame: what a dark frame leaves of those that no VPL reaches, what is shown and
// counted of them, and their memory. Some lines over 300: one rig serves all.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <random>

#include "support/host_image.h"
#include "support/lit_room.h"
#include "support/scoped.h"
#include "support/scoped_api.h"
#include "support/walls.h"

using namespace lightwell::test;

namespace {

constexpr std::uint32_t kWidth = 32, kHeight = 16;

double plain(double, double) { return 0.5; }
double slanted(double x, double z) { return x > 0.1 ? 0.05 : 0.1 + z; }

LWSsvpDesc descOf(std::uint32_t clusters, std::uint32_t bounces, std::uint32_t shadowed) {
    LWSsvpDesc desc;
    lwDefaultSsvp(&desc);
    desc.vpls = 32;
    desc.clusters = clusters;
    desc.bounces = bounces;
    desc.shadowedBounces = shadowed;
    desc.mapSize = 64;
    return desc;
}

struct Frame {
    std::vector<LWLight> lights;
    LWFrame frame{};
    Frame(const std::vector<LWLight>& lit, const LWGeometry* geometry, bool reset = false) : lights(lit) {
        frame.structSize = sizeof frame;
        frame.lights = lights.data();
        frame.lightCount = std::uint32_t(lights.size());
        frame.geometry = geometry;
        frame.reset = reset;
    }
};

// Output that outlives the reading of debug views, which show it in place.
struct Canvas {
    WallAndCeiling scene{kWidth, kHeight};
    PlanarPixels irradiance{kWidth, kHeight, 3};
    std::vector<float> render(LWDevice device, LWTechnique technique, LWView view) {
        LWOutput output{};
        output.structSize = sizeof output;
        output.irradiance = irradiance.image();
        REQUIRE(lwRender(technique, view, &scene.gbuffer, &output) == LW_SUCCESS);
        REQUIRE(lwFinish(device) == LW_SUCCESS);
        return irradiance.packed();
    }
};

// All debug views by name; their pixels.
std::map<std::string, std::vector<float>> viewsOf(LWDevice device, LWTechnique technique, LWView view) {
    std::map<std::string, std::vector<float>> views;
    std::uint32_t count = 0;
    REQUIRE(lwCountDebugViews(technique, view, &count) == LW_SUCCESS);
    for (std::uint32_t i = 0; i < count; ++i) {
        LWDebugView info{};
        info.structSize = sizeof info;
        REQUIRE(lwDescribeDebugView(technique, view, i, &info) == LW_SUCCESS);
        const std::size_t size = std::size_t(info.width) * info.height * info.channels;
        std::vector<float> pixels(size + 1, -7.0f);
        const LWStatus status = lwReadDebugView(technique, view, info.name, pixels.data(), size);
        CAPTURE(info.name, info.width, info.height, lastError(device));
        REQUIRE(status == LW_SUCCESS);
        CHECK(pixels.back() == -7.0f);
        pixels.pop_back();
        views[info.name] = pixels;
    }
    return views;
}

bool areZero(const std::vector<float>& values) {
    return std::all_of(values.begin(), values.end(), [](float v) { return v == 0.0f; });
}

}  // namespace

TEST_CASE("a dark frame leaves nothing of a lit one, in any stage", "[ssvp][stages]") {
    TestDevice device(16);
    LitFloor floor(64, plain), other(64, slanted);
    Canvas canvas;
    Walls room = Walls::room();
    // Every VPL a cluster: without any there are no clusters of the first bounce, and no VPLs of the next.
    const LWSsvpDesc desc = descOf(GENERATE(0u, 8u), 4, GENERATE(2u, 4u));
    TestTechnique technique(device, desc), fresh(device, desc);
    TestView view(device, kWidth, kHeight);
    technique.update(Frame({floor.light}, room.describe()).frame);
    canvas.render(device, technique, view);
    viewsOf(device, technique, view);
    CHECK(technique.count("fourth_vpls") > 0);
    for (int i = 0; i < 2; ++i) {
        technique.update(Frame({}, room.describe(), i == 1).frame);
        CHECK(areZero(canvas.render(device, technique, view)));
    }
    fresh.update(Frame({}, room.describe()).frame);
    CHECK(areZero(canvas.render(device, fresh, view)));
    CHECK(technique.count("maps_redrawn") == 0);
    const auto views = viewsOf(device, technique, view);
    for (const auto& [name, pixels] : viewsOf(device, fresh, view)) {
        CAPTURE(name);
        CHECK(pixels == views.at(name));
    }
    for (const char* name : {"second_clusters", "third_clusters"}) {
        const std::vector<float>& planes = views.at(name);
        const std::size_t clusters = planes.size() / 16;
        CHECK(areZero({planes.begin() + std::ptrdiff_t(6 * clusters), planes.begin() + std::ptrdiff_t(10 * clusters)}));
    }
    for (const char* name : {"maps", "second_maps", "third_maps"}) CHECK(areZero(views.at(name)));
    REQUIRE(views.count("fourth_maps") == (desc.shadowedBounces == 4));
    if (desc.shadowedBounces == 4) CHECK(areZero(views.at("fourth_maps")));
    // The cut came in the dark: clusters begin anew in every stage.
    technique.update(Frame({other.light}, room.describe()).frame);
    fresh.update(Frame({other.light}, room.describe()).frame);
    CHECK(canvas.render(device, technique, view) == canvas.render(device, fresh, view));
}

TEST_CASE("light of shadowed bounces does not leave a closed room", "[ssvp][stages]") {
    TestDevice device(GENERATE(1u, 16u));
    LitFloor floor(64, plain);
    Walls room = Walls::room();
    // Behind the wall at z = 1, which all that faces +z inside lies before.
    PlanarPixels position(kWidth, kHeight, 3), normal(kWidth, kHeight, 3);
    for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = 0; x < kWidth; ++x) {
            position.set(x, y, {(x + 0.5) / kWidth - 0.5, (y + 0.5) / kHeight, 1.5});
            normal.set(x, y, {0, 0, -1});
        }
    LWGBuffer outside{};
    outside.structSize = sizeof outside;
    outside.position = position.image();
    outside.normal = normal.image();
    double leak[5] = {}, leakOfCareful[5] = {};
    for (std::uint32_t shadowed = 1; shadowed <= 4; ++shadowed)
        for (const LWVisibility visibility : {LW_VISIBILITY_HARD, LW_VISIBILITY_CAREFUL}) {
            LWSsvpDesc desc = descOf(8, 4, shadowed);
            desc.visibility = visibility;
            TestTechnique technique(device, desc);
            TestView view(device, kWidth, kHeight);
            technique.update(Frame({floor.light}, room.describe()).frame);
            double& sum = (visibility == LW_VISIBILITY_CAREFUL ? leakOfCareful : leak)[shadowed];
            for (const float e : technique.render(view, outside)) sum += double(e);
        }
    CAPTURE(leak[1], leak[2], leak[3], leak[4], leakOfCareful[1], leakOfCareful[2]);
    // The first bounce goes up from the floor and would pass the wall too; each bounce that is shadowed keeps its share in.
    CHECK(leak[2] < 0.9 * leak[1]);
    CHECK(leak[3] < 0.9 * leak[2]);
    CHECK(leak[3] > 0.0);
    CHECK(leak[4] < 1e-3 * leak[1]);
    // Where no shadowed light gets, careful look-ups let a quarter of the other bounces' count. A single bounce's shadows tell too little.
    for (std::uint32_t shadowed = 2; shadowed <= 3; ++shadowed) CHECK(leakOfCareful[shadowed] == Approx(0.25 * leak[shadowed]).epsilon(0.02));
    CHECK(leakOfCareful[4] < 1e-3 * leak[1]);
    CHECK(leakOfCareful[1] > 0.3 * leak[1]);
}

TEST_CASE("inside a room careful look-ups let bounces without shadows count", "[ssvp][stages]") {
    TestDevice device(16);
    LitFloor floor(64, plain);
    Walls room = Walls::room();
    const std::uint32_t interleave = GENERATE(1u, 4u);
    const auto lightOf = [&](LWVisibility visibility, std::uint32_t bounces) {
        Canvas canvas;
        LWSsvpDesc desc = descOf(8, bounces, 2);
        desc.visibility = visibility;
        desc.interleave = interleave;
        TestTechnique technique(device, desc);
        TestView view(device, kWidth, kHeight);
        technique.update(Frame({floor.light}, room.describe()).frame);
        return canvas.render(device, technique, view);
    };
    const std::vector<float> hard2 = lightOf(LW_VISIBILITY_HARD, 2), hard4 = lightOf(LW_VISIBILITY_HARD, 4), careful2 = lightOf(LW_VISIBILITY_CAREFUL, 2),
                             careful4 = lightOf(LW_VISIBILITY_CAREFUL, 4);
    double all = 0.0, counted = 0.0, shadowed = 0.0;
    int wrong = 0;
    for (std::size_t i = 0; i < hard2.size(); ++i) {
        all += double(hard4[i] - hard2[i]);
        counted += double(careful4[i] - careful2[i]);
        shadowed += double(hard2[i]);
        // Never less than a quarter of what these bounces bring, and no more than all of it or eight times the shadowed light and that quarter.
        const float slack = 1e-4f * hard4[i], quarter = 0.25f * (hard4[i] - hard2[i]);
        wrong += careful4[i] < careful2[i] + quarter - slack || careful4[i] > hard4[i] + slack || careful4[i] > 9.0f * hard2[i] + quarter + slack;
    }
    CAPTURE(interleave, all, counted, shadowed);
    CHECK(wrong == 0);
    CHECK(all > 0.1 * shadowed);
    CHECK(counted > 0.9 * all);
}

TEST_CASE("without maps their debug view is empty, and prewarming goes through", "[ssvp][stages]") {
    TestDevice device(16);
    LitFloor floor(64, plain);
    Canvas canvas;
    LWSsvpDesc desc = descOf(GENERATE(0u, 8u), 1, 1);
    desc.visibility = LW_VISIBILITY_NONE;
    TestTechnique technique(device, desc);
    TestView view(device, kWidth, kHeight);
    const LWStatus status = lwPrewarm(technique, view);
    CAPTURE(lastError(device));
    REQUIRE(status == LW_SUCCESS);
    technique.update(Frame({floor.light}, nullptr).frame);
    canvas.render(device, technique, view);
    CHECK(viewsOf(device, technique, view).at("maps").empty());
}

TEST_CASE("two million surfels compile nothing that prewarming has not", "[ssvp][stages][long]") {
    TestDevice device(16);
    LitFloor floor(64, plain);
    Canvas canvas;
    Walls room = Walls::room();
    const LWGeometry* geometry = room.describeSurfels(0.00168);
    REQUIRE(geometry->surfelCount > 65535u * 32u);
    TestTechnique technique(device, descOf(1, 1, 1));
    TestView view(device, kWidth, kHeight);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    technique.update(Frame({floor.light}, geometry).frame);
    const auto many = canvas.render(device, technique, view);
    CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
    // As a few of them: the room is convex, and nothing blocks.
    Walls coarse = Walls::room();
    technique.update(Frame({floor.light}, coarse.describeSurfels(0.05, 2)).frame);
    const auto few = canvas.render(device, technique, view);
    double sum = 0.0, off = 0.0;
    for (std::size_t i = 0; i < many.size(); ++i) {
        sum += double(few[i]);
        off += std::abs(double(many[i]) - double(few[i]));
    }
    CHECK(off < 0.05 * sum);
}

TEST_CASE("the estimate follows stages, clusters and occluders", "[ssvp][stages]") {
    const ScopedVariable unified("LIGHTWELL_UNIFIED_MEMORY", GENERATE(as<const char*>{}, "1", "0"));
    const LWVisibility visibility = GENERATE(LW_VISIBILITY_HARD, LW_VISIBILITY_CAREFUL);  // which keeps a fourth plane for the filter
    TestDevice device(16);
    LitFloor floor(64, plain);
    Canvas canvas;
    Walls triangles = Walls::room(), surfels = Walls::room();
    TestView view(device, kWidth, kHeight);
    LWViewDesc viewDesc{};
    viewDesc.structSize = sizeof viewDesc;
    viewDesc.maxWidth = kWidth;
    viewDesc.maxHeight = kHeight;
    for (const LWOccluders occluders : {LW_OCCLUDERS_TRIANGLES, LW_OCCLUDERS_SURFELS, LW_OCCLUDERS_SCREEN}) {
        const LWGeometry* geometry = occluders == LW_OCCLUDERS_SURFELS ? surfels.describeSurfels(0.05) : triangles.describe();
        const Frame frame({floor.light}, geometry);
        // What is read in place is in the estimate and not held: as much whatever is done with it.
        std::int64_t inPlace = -1;
        for (const std::uint32_t bounces : {1u, 2u, 3u, 4u})
            for (const std::uint32_t shadowed : {1u, 4u})
                for (const std::uint32_t clusters : {0u, 8u}) {
                    LWSsvpDesc desc = descOf(clusters, bounces, shadowed);
                    desc.visibility = visibility;
                    desc.occluders = occluders;
                    TestTechnique technique(device, desc);
                    technique.update(frame.frame);
                    canvas.render(device, technique, view);
                    std::uint64_t estimate = 0;
                    REQUIRE(lwEstimateFrameMemory(device, "ssvp", &desc, &viewDesc, &frame.frame, &estimate) == LW_SUCCESS);
                    const auto over = std::int64_t(estimate) - std::int64_t(technique.stats().deviceBytes);
                    if (inPlace < 0) inPlace = over;
                    CAPTURE(int(visibility), occluders, bounces, shadowed, clusters);
                    CHECK(over >= 0);
                    CHECK(over == inPlace);
                }
    }
}

namespace {

// Frames at random: lights and VPLs come and go, occluders of all kinds and none, surfels that are none.
struct AnyFrame {
    LitFloor floor{64, plain}, other{64, slanted};
    Walls triangles = Walls::room(), surfels = Walls::room(), lid = Walls::room();
    std::vector<LWVpl> vpls;
    std::vector<LWLight> lights;
    LWGeometry both{};
    std::uint64_t version = 0;
    LWFrame frame{};

    AnyFrame() {
        lid.add({-0.6, 0.05, -0.1}, {1.2, 0, 0}, {0, 0, 1.2});
        surfels.describeSurfels(0.05);
        both = surfels.geometry;
    }
    void choose(std::mt19937& random, const LWSourceView& source) {
        const auto upTo = [&](unsigned n) { return unsigned(random() % n); };
        lights.clear();
        if (upTo(3)) lights.push_back(upTo(2) ? floor.light : other.light);
        vpls.assign(std::array{0u, 0u, 1u, 40u}[upTo(4)], LWVpl{});
        for (LWVpl& v : vpls) {
            v.position[0] = float(upTo(100)) * 0.01f - 0.5f;
            v.position[2] = float(upTo(100)) * 0.01f;
            v.normal[1] = 1.0f;
            v.area = upTo(4) ? 0.01f : 0.0f;
            v.flux[upTo(3)] = upTo(4) ? 1.0f : 0.0f;
        }
        frame = Frame(lights, nullptr, upTo(4) == 0).frame;
        frame.lights = lights.data();
        frame.vpls = vpls.data();
        frame.vplCount = std::uint32_t(vpls.size());
        frame.sourceViews = &source;
        frame.sourceViewCount = upTo(2);
        ++version;
        switch (upTo(5)) {
            case 0: frame.geometry = triangles.describe(); break;
            case 1: frame.geometry = lid.describe(version); break;
            case 2: frame.geometry = &both; break;
            case 3:
                both.version = version;
                both.surfelCount = 1 + upTo(surfels.geometry.surfelCount);
                for (LWImage* image : {&both.surfelPosition, &both.surfelNormal, &both.surfelArea}) image->width = both.surfelCount;
                frame.geometry = &both;
                break;
            default: break;
        }
    }
};

}  // namespace

TEST_CASE("without a warm start no frame shows what came before it", "[ssvp][stages]") {
    TestDevice device(16);
    Canvas canvas;
    TestView view(device, kWidth, kHeight);
    const LWSourceView source{view, &canvas.scene.gbuffer};
    const unsigned seed = GENERATE(range(1u, 7u));
    std::mt19937 random(seed);
    const unsigned clusters = random() % 4, bounces = 1 + random() % 4, shadowed = 1 + random() % 4;
    LWSsvpDesc desc = descOf(std::array{0u, 1u, 8u, 16u}[clusters], bounces, shadowed);
    desc.warmStart = 0;
    desc.secondVpls = 8;
    setEnum(desc.visibility, (seed + 3) % 6);  // each once; careful where two of four bounces are shadowed
    if (desc.visibility == LW_VISIBILITY_CAREFUL) REQUIRE((desc.bounces == 4 && desc.shadowedBounces == 2));
    TestTechnique technique(device, desc);
    AnyFrame any;
    for (int i = 0; i < 8; ++i) {
        any.choose(random, source);
        CAPTURE(seed, i, desc.clusters, desc.bounces, desc.shadowedBounces, int(desc.visibility));
        technique.update(any.frame);
        const auto e = canvas.render(device, technique, view);
        CHECK(std::all_of(e.begin(), e.end(), [](float v) { return std::isfinite(v) && v >= 0.0f; }));
        const auto views = viewsOf(device, technique, view);
        TestTechnique fresh(device, desc);
        fresh.update(any.frame);
        CHECK(canvas.render(device, fresh, view) == e);
        for (const auto& [name, pixels] : viewsOf(device, fresh, view)) {
            CAPTURE(name);
            CHECK(std::equal(pixels.begin(), pixels.end(), views.at(name).begin(), views.at(name).end()));
        }
    }
}
