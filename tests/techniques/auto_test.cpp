// Technique auto: with candidates and predictions of the test's own, whose light is known from the techniques alone; and through the C API.
// Over 300 lines: one rig, whose programs are built once.
#include "techniques/auto.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "api/api_scene.h"
#include "compute/device.h"
#include "support/kernel_rig.h"
#include "support/test_device.h"
#include "techniques/auto_times.h"
#include "techniques/from_text.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr std::uint32_t kWidth = 24, kHeight = 10;

// Two that light the floor's ceiling differently, and one that this G-buffer has no inputs for.
const std::vector<Candidate> kCandidates = {{"rsm", "vpls=16 interleave=1 filter=off"}, {"rsm", "vpls=64 interleave=1 filter=off"}, {"horizon", ""}};

// What the test predicts, from frame to frame.
struct Plan {
    std::vector<Prediction> predictions;
    std::size_t ofGeometry = ~std::size_t(0);  // a candidate that takes triangles
    double mostTriangles = 0.0;                // of the frames that it was asked about
    bool hasAskedForViews = false;
    std::vector<Prediction> of(const FrameTraits& traits) {
        mostTriangles = std::max(mostTriangles, traits.triangles);
        hasAskedForViews = hasAskedForViews || traits.hasViews;
        std::vector<Prediction> possible;
        for (const Prediction& one : predictions)
            if (one.candidate != ofGeometry || traits.triangles > 0.0) possible.push_back(one);
        return possible;
    }
    void prefer(std::size_t candidate) {
        for (Prediction& one : predictions) one.error = one.candidate == candidate ? 0.1 : 1.0;
    }
};

LWAutoDesc describe(std::uint32_t fade, std::uint32_t patience = 0, float budget = 0.0f) {
    LWAutoDesc desc;
    lwDefaultAuto(&desc);
    desc.fade = fade;
    desc.patience = patience;
    desc.budgetMs = budget;
    return desc;
}

struct Scene : ApiScene {
    explicit Scene(std::uint32_t w = kWidth, std::uint32_t h = kHeight) : ApiScene(w, h) {
        gbuffer.camera = testCamera(kRightHanded, {0.0, 0.2, 3.0}).matrices();  // it never moves: any will do
    }
    std::vector<double> light() const {
        std::vector<double> all;
        for (std::uint32_t y = 0; y < irradiance.height(); ++y)
            for (std::uint32_t x = 0; x < irradiance.width(); ++x) {
                for (std::uint32_t c = 0; c < 3; ++c) all.push_back(irradiance.value(x, y, c));
                all.push_back(validity.value(x, y, 0));
            }
        return all;
    }
};

struct AutoRig {
    explicit AutoRig(const LWAutoDesc& desc, std::size_t count = 2, std::uint32_t width = 16)
        : AutoRig(desc, sharedDevice(width), kCandidates, count) {}
    AutoRig(const LWAutoDesc& desc, Device& on, const std::vector<Candidate>& candidates, std::size_t count) : device(on) {
        for (std::size_t i = 0; i < count; ++i) plan.predictions.push_back({i, 1.0 + double(i), 1.0, 0.7});
        plan.prefer(0);
        technique = makeAuto(device, desc, {candidates, [this](const FrameTraits& traits, const LWPlanProbes&) { return plan.of(traits); }, false});
    }
    static void setOrigin(Executor& executor, const Scene& scene) {
        const double(&o)[3] = scene.frame.worldOrigin;
        executor.setWorldOrigin({o[0], o[1], o[2]});
    }
    std::vector<double> frame(Scene& scene) {
        update(scene);
        return render(scene, view);
    }
    void update(Scene& scene) {
        record = std::make_unique<Profile>();
        Executor executor(device, *record);
        setOrigin(executor, scene);
        technique->update(executor, scene.frame);
    }
    std::vector<double> render(Scene& scene, const std::shared_ptr<View>& to) {
        Executor executor(device, *record);
        setOrigin(executor, scene);
        technique->render(executor, to, scene.gbuffer, scene.output);
        device.finish();
        return scene.light();
    }
    std::uint64_t count(const std::string& name) {
        Report report = technique->report();
        device.finish();
        report.resolve();
        for (const LWCount& one : report.counts)
            if (name == one.name) return one.value;
        return ~std::uint64_t(0);
    }
    std::string choice(const std::string& name) {
        Report report = technique->report();
        device.finish();
        report.resolve();
        for (const LWChoice& one : report.choices)
            if (name == one.name) return one.reason;
        return "none";
    }

    Device& device;
    Plan plan;
    std::unique_ptr<Technique> technique;
    std::unique_ptr<Profile> record;
    std::shared_ptr<View> view = std::make_shared<View>(kWidth, kHeight);
};

// A candidate's light by itself.
std::vector<double> alone(std::size_t candidate, Scene& scene, std::uint32_t width = 16) {
    Device& device = sharedDevice(width);
    const auto technique = makeTechnique(device, kCandidates[candidate].technique, kCandidates[candidate].settings);
    Profile profile;
    Executor executor(device, profile);
    const auto view = std::make_shared<View>(scene.position.width(), scene.position.height());
    technique->update(executor, scene.frame);
    technique->render(executor, view, scene.gbuffer, scene.output);
    device.finish();
    return scene.light();
}

double most(const std::vector<double>& a, const std::vector<double>& b) {
    double result = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) result = std::max(result, std::fabs(a[i] - b[i]));
    return result;
}

}  // namespace

TEST_CASE("as long as nothing switches it is its candidate, to the bit", "[auto]") {
    const auto width = GENERATE(1u, 16u);
    Scene scene;
    const std::vector<double> want = alone(0, scene, width);
    const auto patience = GENERATE(0u, 30u);  // 0: the picture is kept in every frame, for a change that may come
    AutoRig rig(describe(12, patience), 2, width);
    for (int f = 0; f < 4; ++f) CHECK(rig.frame(scene) == want);
    CHECK(rig.count("switches") == 0);
    CHECK(rig.count("fading_frames_left") == 0);
    CHECK(rig.choice("auto.technique") == "rsm");
    CHECK(rig.choice("auto.parameters") == kCandidates[0].settings);
    CHECK_THAT(rig.choice("auto"), Catch::StartsWith("rsm vpls=16"));
    CHECK(rig.count("chosen.vpls") != ~std::uint64_t(0));
}

TEST_CASE("a change is an even ramp over `fade` frames, and then the new one to the bit", "[auto]") {
    Scene scene;
    const std::uint32_t fade = 5;
    const std::vector<double> first = alone(0, scene), second = alone(1, scene);
    const double gap = most(first, second);
    REQUIRE(gap > 1e-3);
    AutoRig rig(describe(fade, 3));
    for (int f = 0; f < 3; ++f) REQUIRE(rig.frame(scene) == first);
    rig.plan.prefer(1);
    for (int f = 0; f < 3; ++f) REQUIRE(rig.frame(scene) == first);  // patience
    std::vector<double> shown = first;
    for (std::uint32_t k = 1; k <= fade; ++k) {
        const std::vector<double> before = shown;
        shown = rig.frame(scene);
        std::vector<double> want(first.size());
        for (std::size_t i = 0; i < want.size(); ++i) want[i] = first[i] + (second[i] - first[i]) * double(k) / fade;
        CHECK(most(shown, want) < 1e-6);
        CHECK(most(shown, before) <= gap / fade * 1.0001);
    }
    CHECK(shown == second);
    CHECK(rig.frame(scene) == second);
    CHECK(rig.count("switches") == 1);
    CHECK_THAT(rig.choice("auto"), Catch::Contains("less error"));
}

TEST_CASE("a change that is taken back half way goes back from what was shown", "[auto]") {
    Scene scene;
    const std::vector<double> first = alone(0, scene), second = alone(1, scene);
    AutoRig rig(describe(4));
    for (int f = 0; f < 2; ++f) rig.frame(scene);
    rig.plan.prefer(1);
    for (int f = 0; f < 2; ++f) rig.frame(scene);  // 1/4, 2/4
    rig.plan.prefer(0);
    std::vector<double> shown;
    const double gap = most(first, second);
    for (int k = 1; k <= 4; ++k) {
        shown = rig.frame(scene);
        CHECK(most(shown, first) == Approx(gap * (0.5 - 0.125 * k)).margin(1e-6));
    }
    CHECK(shown == first);
    CHECK(rig.count("switches") == 2);
}

TEST_CASE("without a fade, without a camera and at a cut a change comes at once", "[auto]") {
    Scene scene;
    const std::vector<double> second = alone(1, scene);
    const auto changed = [&](AutoRig& rig, std::uint32_t reset) {
        for (int f = 0; f < 2; ++f) rig.frame(scene);
        rig.plan.prefer(1);
        scene.frame.reset = reset;
        std::vector<double> shown = rig.frame(scene);
        if (rig.count("switches") == 0) shown = rig.frame(scene);
        scene.frame.reset = 0;
        return shown;
    };
    AutoRig hard(describe(0)), cut(describe(12)), blind(describe(12));
    CHECK(changed(hard, 0) == second);
    CHECK(changed(cut, 1) == second);
    scene.gbuffer.camera = LWCamera{};
    CHECK(changed(blind, 0) == second);
    CHECK_THAT(blind.choice("auto.fade"), Catch::Contains("gbuffer.camera"));
}

TEST_CASE("a candidate that refuses the view: the one before lights the same frame, and it is left out", "[auto]") {
    Scene scene;
    const std::vector<double> first = alone(0, scene);
    AutoRig rig(describe(0), 3);
    REQUIRE(rig.frame(scene) == first);
    rig.plan.prefer(2);  // horizon without directRadiance
    CHECK(rig.frame(scene) == first);
    CHECK(rig.frame(scene) == first);
    CHECK(rig.count("failed_candidates") == 1);
    CHECK(rig.count("barred_candidates") == 1);
    CHECK(rig.choice("auto.technique") == "rsm");
}

TEST_CASE("kernels that do not build: prewarming goes on, and however many settings need them another technique lights the frame", "[auto]") {
    Scene scene;
    scene.gbuffer.directRadiance = scene.gbuffer.normal;
    const auto broken = freshDevice();
    broken->programs().addSource("screen_gather/screen_gather", "__kernel void screen_gather_deal(__global int* p) { p[0] = ; }\n");
    std::vector<Candidate> some;
    // Ten settings without the program, each preferred to the one that works.
    for (const char* settings : {"samples=8", "samples=16", "samples=32", "samples=64", "samples=128", "levels=1", "levels=2", "levels=3", "levels=4", "levels=5"})
        some.push_back({"screen_space", settings});
    some.push_back(kCandidates[0]);
    AutoRig rig(describe(0), *broken, some, some.size());
    for (Prediction& one : rig.plan.predictions) one.error = 0.1 * double(one.candidate + 1);
    Profile profile;
    Executor executor(*broken, profile);
    rig.technique->prewarm(executor, rig.view);
    const std::vector<double> first = alone(0, scene);
    CHECK(rig.frame(scene) == first);
    CHECK(rig.frame(scene) == first);
    CHECK(rig.count("barred_candidates") == 10);
    rig.plan.predictions.pop_back();  // nothing else is possible
    CHECK_THROWS_WITH(rig.frame(scene), Catch::Contains("failed before"));
}

TEST_CASE("what prewarming left out is taken where there is nothing else", "[auto]") {
    Scene scene;
    const std::vector<double> first = alone(0, scene), second = alone(1, scene);
    AutoRig rig(describe(0));  // the second one is predicted to be slower and worse
    Profile profile;
    Executor executor(rig.device, profile);
    rig.technique->prewarm(executor, rig.view);
    rig.plan.prefer(1);
    for (int f = 0; f < 3; ++f) CHECK(rig.frame(scene) == first);
    const std::vector<Prediction> both = rig.plan.predictions;
    rig.plan.predictions = {both[1]};
    CHECK(rig.frame(scene) == second);
    rig.plan.predictions = both;
    for (int f = 0; f < 3; ++f) CHECK(rig.frame(scene) == second);  // its programs are there now
}

TEST_CASE("prewarming after frames goes by what they brought, and what it cannot judge stays left out", "[auto]") {
    Scene scene;
    const std::vector<double> first = alone(0, scene), second = alone(1, scene);
    AutoRig rig(describe(0));
    rig.plan.ofGeometry = 1;  // and slower and worse, at first
    Profile profile;
    Executor executor(rig.device, profile);
    rig.technique->prewarm(executor, rig.view);
    CHECK(rig.frame(scene) == first);
    rig.plan.mostTriangles = 0.0;
    rig.technique->prewarm(executor, rig.view);  // of frames without triangles
    CHECK(rig.plan.mostTriangles == 0.0);
    LWGeometry geometry{};
    geometry.structSize = sizeof geometry;
    geometry.triangleCount = 12;
    scene.frame.geometry = &geometry;
    rig.plan.prefer(1);
    for (int f = 0; f < 3; ++f) CHECK(rig.frame(scene) == first);
    rig.plan.mostTriangles = 0.0;
    rig.technique->prewarm(executor, rig.view);
    CHECK(rig.plan.mostTriangles == 12.0);
    CHECK(rig.frame(scene) == second);
}

TEST_CASE("after prewarming, changes, fades and moves of the origin build nothing", "[auto]") {
    Scene scene;
    const auto own = freshDevice();
    AutoRig rig(describe(3), *own, kCandidates, 2);
    rig.plan.prefer(1);  // dearer and better: neither is left out
    Profile profile;
    Executor executor(*own, profile);
    rig.technique->prewarm(executor, rig.view);
    const std::uint64_t built = own->programs().built(), loaded = own->programs().loaded();
    for (int f = 0; f < 40; ++f) {
        if (f % 7 == 6) rig.plan.prefer(f % 2);
        scene.frame.worldOrigin[0] = f / 10;
        rig.frame(scene);
    }
    CHECK(rig.count("switches") >= 3);
    CHECK(own->programs().built() == built);
    CHECK(own->programs().loaded() == loaded);
}

TEST_CASE("a fade is short where the budget has no room for its time", "[auto]") {
    Scene scene;
    const auto left = [&](std::uint32_t fade, float budget) {
        AutoRig rig(describe(fade, 0, budget));
        rig.frame(scene);
        rig.plan.predictions = {rig.plan.predictions[1]};
        rig.frame(scene);
        return rig.count("fading_frames_left");
    };
    CHECK(left(12, 0.0f) == 11);
    CHECK(left(12, 1e6f) == 11);
    CHECK(left(12, 1e-3f) == 2);
    CHECK(left(2, 1e-3f) == 1);
}

TEST_CASE("the host's mistakes are errors as any technique's, and nothing is barred for them", "[auto]") {
    Scene scene;
    const std::vector<double> first = alone(0, scene);
    AutoRig rig(describe(4));
    REQUIRE(rig.frame(scene) == first);
    const LWImage flux = scene.rsm.flux;
    scene.rsm.flux.width = 3;
    CHECK_THROWS_WITH(rig.frame(scene), Catch::Contains("flux"));
    scene.rsm.flux = flux;
    CHECK(rig.render(scene, rig.view) == first);  // the frame before is still there
    CHECK(rig.frame(scene) == first);
    const LWImage normal = scene.gbuffer.normal;
    scene.gbuffer.normal.width = 7;
    CHECK_THROWS_WITH(rig.frame(scene), Catch::Contains("gbuffer.normal"));
    scene.gbuffer.normal = normal;
    const LWOutput output = scene.output;
    scene.output.ambientOcclusion = output.validity;
    CHECK_THROWS_WITH(rig.frame(scene), Catch::Contains("auto"));
    scene.output = output;
    CHECK(rig.frame(scene) == first);
    CHECK(rig.count("failed_candidates") == 0);
}

TEST_CASE("two views fade alike, each from its own picture; a size may change within", "[auto]") {
    Scene scene, small(16, 8);
    const std::vector<double> first = alone(0, scene), second = alone(1, scene), smallFirst = alone(0, small), smallSecond = alone(1, small);
    AutoRig rig(describe(2));
    const auto other = std::make_shared<View>(kWidth, kHeight);
    other->width = 16;
    other->height = 8;
    for (int f = 0; f < 2; ++f) {
        rig.update(scene);
        CHECK(rig.render(scene, rig.view) == first);
        CHECK(rig.render(small, other) == smallFirst);
    }
    rig.plan.prefer(1);
    rig.update(scene);
    rig.render(scene, rig.view);
    rig.render(small, other);
    CHECK(most(scene.light(), first) == Approx(0.5 * most(first, second)).margin(1e-6));
    CHECK(most(small.light(), smallFirst) == Approx(0.5 * most(smallFirst, smallSecond)).margin(1e-6));
    other->width = kWidth;
    other->height = kHeight;
    rig.update(scene);
    CHECK(rig.render(scene, rig.view) == second);
    CHECK(rig.render(scene, other) == second);
}

TEST_CASE("VPLs for what source views show change with every step of the camera: no candidate for frame after frame", "[auto]") {
    Scene scene;
    const LWSourceView source{};  // rsm by flux reads none
    scene.frame.sourceViews = &source;
    scene.frame.sourceViewCount = 1;
    CHECK(traitsOf(scene.frame, scene.gbuffer, 1.0, 1).hasViews);
    AutoRig rig(describe(0));
    for (int i = 0; i < 3; ++i) CHECK(rig.frame(scene) == alone(0, scene));
    CHECK_FALSE(rig.plan.hasAskedForViews);
}

TEST_CASE("a budget that nothing holds: the quickest runs, and frames over it are counted", "[auto]") {
    Scene scene;
    AutoRig rig(describe(0, 0, 1e-6f));
    for (int f = 0; f < 8; ++f) rig.frame(scene);
    CHECK(rig.choice("auto.parameters") == kCandidates[0].settings);
    CHECK(rig.count("measured_frames") == 7);  // all but the one at hand
    CHECK(rig.count("over_budget_frames") == 7);
    CHECK_THAT(rig.choice("auto"), Catch::Contains("over the budget"));
}

TEST_CASE("what nothing can light is refused with what is missing", "[auto]") {
    Scene scene;
    AutoRig rig(describe(4));
    rig.plan.predictions.clear();
    CHECK_THROWS_WITH(rig.frame(scene), Catch::Contains("expected what a technique can make light of"));
}

TEST_CASE("through the C API: errors name parameters, and a frame is lit", "[auto]") {
    const LWDevice device = makeDevice(16);
    REQUIRE(device);
    LWTechnique technique = nullptr;
    const auto refused = [&](auto change) {
        LWAutoDesc desc;
        lwDefaultAuto(&desc);
        change(desc);
        CHECK(lwCreateAuto(device, &desc, &technique) == LW_ERROR_INVALID_ARGUMENT);
        return lastError(device);
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    CHECK_THAT(refused([&](LWAutoDesc& desc) { desc.budgetMs = nan; }), Catch::Contains("desc.budget_ms: expected 0 .. 1e+06, got nan"));
    CHECK_THAT(refused([&](LWAutoDesc& desc) { desc.budgetMs = -1.0f; }), Catch::Contains("desc.budget_ms"));
    CHECK_THAT(refused([&](LWAutoDesc& desc) { desc.errorTarget = -1.0f; }), Catch::Contains("desc.error_target"));
    CHECK_THAT(refused([&](LWAutoDesc& desc) { desc.gain = nan; }), Catch::Contains("desc.gain"));
    CHECK_THAT(refused([&](LWAutoDesc& desc) { desc.fade = 1000; }), Catch::Contains("desc.fade"));
    CHECK_THAT(refused([&](LWAutoDesc& desc) { desc.views = 65; }), Catch::Contains("desc.views"));

    Scene scene;
    const LWViewDesc viewDesc = scene.viewDesc();
    LWView view = nullptr;
    REQUIRE(lwCreateView(device, &viewDesc, &view) == LW_SUCCESS);
    LWAutoDesc desc;
    lwDefaultAuto(&desc);
    desc.errorTarget = 1e6f;  // the quickest: one technique's programs
    REQUIRE(lwCreateAuto(device, &desc, &technique) == LW_SUCCESS);
    for (int f = 0; f < 4; ++f) {
        REQUIRE(lwUpdate(technique, &scene.frame) == LW_SUCCESS);
        REQUIRE(lwRender(technique, view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
        REQUIRE(lwFinish(device) == LW_SUCCESS);
        CHECK(scene.lit());
    }
    LWStats stats{};
    stats.structSize = sizeof stats;
    REQUIRE(lwGetStats(technique, &stats) == LW_SUCCESS);
    std::string reason;
    for (std::uint32_t i = 0; i < stats.choiceCount; ++i)
        if (std::string(stats.choices[i].name) == "auto") reason = stats.choices[i].reason;
    CHECK_THAT(reason, Catch::Contains("relMSE"));
    lwReleaseTechnique(technique);
    lwReleaseView(view);
    lwReleaseDevice(device);
}
