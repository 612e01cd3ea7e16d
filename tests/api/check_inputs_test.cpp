// lwCheckInputs: every planted fault comes first under its own name, good inputs of every scene, light
// and format stay without a finding, and abuse is refused. The plants are the command line's (lightwell
// check --plant): they change the host's copies of pixels and matrices and share nothing with the
// checker.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "api/api_scene.h"
#include "check_plant.h"
#include "lightwell/lightwell.hpp"

using namespace lightwell::test;
using Catch::Matchers::Contains;

namespace {

constexpr int kWidth = 160, kHeight = 90, kRsmSize = 128;

std::string nameOf(LWInputFault fault) {
    auto info = lightwell::make<LWInputFaultInfo>();
    lightwell::check(lwDescribeInputFault(std::uint32_t(fault), &info));
    return info.name;
}

std::string describe(const std::vector<LWInputFinding>& findings) {
    std::string text;
    for (const LWInputFinding& f : findings)
        text += std::to_string(f.severity) + " " + nameOf(f.fault) + " " + f.argument + ": " +
                f.message + "\n";
    return text;
}

struct SceneView {
    std::shared_ptr<studio::Scene> scene;
    std::unique_ptr<studio::RayScene> rays;
    std::unique_ptr<cli::RenderInputs> inputs;
    SceneView(const std::string& name, std::size_t camera, int cascades = 1, int width = kWidth,
              int height = kHeight, float time = 0.0f)
        : scene(std::make_shared<studio::Scene>(studio::loadScene(name))) {
        look(camera, cascades, width, height, time);
    }
    void look(std::size_t camera, int cascades, int width, int height, float time = 0.0f) {
        const studio::Camera now = scene->cameraAt(int(camera), time), before = cli::cameraBefore(now);
        cli::InputOptions options;
        options.width = width;
        options.height = height;
        options.time = options.previousTime = time;
        options.rsm.size = kRsmSize;
        options.rsm.cascades = cascades;
        options.previousCamera = &before;
        rays = std::make_unique<studio::RayScene>(scene, time);
        inputs = std::make_unique<cli::RenderInputs>(*rays, now, options);
    }
};

std::vector<LWInputFinding> check(const lightwell::Device& device, const cli::PlantedInputs& inputs) {
    const lightwell::View view(device, std::uint32_t(inputs.normal.width),
                               std::uint32_t(inputs.normal.height));
    const LWFrame frame = inputs.frame();
    return lightwell::checkInputs(view, &frame, &inputs.gbuffer);
}

bool hasSun(const studio::Scene& scene) {
    return std::any_of(scene.lights.begin(), scene.lights.end(),
                       [](const auto& l) { return l.kind == studio::LightKind::Sun; });
}
bool hasLamp(const studio::Scene& scene) {
    return std::any_of(scene.lights.begin(), scene.lights.end(),
                       [](const auto& l) { return l.kind != studio::LightKind::Sun; });
}

// No finding but notes.
void expectClean(const std::vector<LWInputFinding>& findings) {
    INFO(describe(findings));
    CHECK(std::all_of(findings.begin(), findings.end(),
                      [](const auto& f) { return f.severity == LW_SEVERITY_NOTE; }));
}

}  // namespace

TEST_CASE("every planted fault comes first, under its own name", "[check]") {
    const std::string sceneName = GENERATE("basic", "cornell");
    const lightwell::Device device;
    const SceneView view(sceneName, 0);
    for (const cli::Plant& plant : cli::plants()) {
        if ((plant.needsSun && !hasSun(*view.scene)) || (plant.needsLamp && !hasLamp(*view.scene)))
            continue;
        cli::PlantedInputs inputs(*view.inputs);
        plant.apply(inputs);
        inputs.describe();
        const auto findings = check(device, inputs);
        INFO(sceneName << ", " << plant.name << ":\n" << describe(findings));
        CHECK_FALSE(findings.empty());
        if (findings.empty()) continue;
        CHECK(nameOf(findings[0].fault) == plant.fault);
        CHECK(findings[0].severity >= LW_SEVERITY_WARNING);
        CHECK(findings[0].affected <= findings[0].examined);
        CHECK(findings[0].confidence > 0.0);
        CHECK(findings[0].confidence <= 1.0);
        CHECK(std::string(findings[0].message).size() > 20);
    }
}

TEST_CASE("good inputs of every shipped scene stay without a finding", "[check]") {
    const lightwell::Device device;
    for (const studio::SceneEntry& entry : studio::listScenes()) {
        if (!entry.shipped) continue;
        SceneView view(entry.path, 0);
        for (std::size_t camera = 0; camera < view.scene->cameras.size(); ++camera)
            for (const int cascades : {1, 3}) {
                if (cascades > 1 && !hasSun(*view.scene)) continue;
                view.look(camera, cascades, kWidth, kHeight);
                INFO(entry.name << ", camera " << view.scene->cameras[camera].name << ", cascades "
                                << cascades);
                expectClean(check(device, cli::PlantedInputs(*view.inputs)));
            }
        view.look(0, 1, 48, 27);
        expectClean(check(device, cli::PlantedInputs(*view.inputs)));
    }
}

TEST_CASE("good inputs of the large scenes stay without a finding", "[check][large]") {
    const char* const folders = std::getenv("LIGHTWELL_SCENES");
    if (!folders || !*folders) {
        WARN("left out: LIGHTWELL_SCENES is not set");
        return;
    }
    const lightwell::Device device;
    for (const studio::SceneEntry& entry : studio::listScenes()) {
        if (entry.shipped) continue;
        SceneView view(entry.path, 0);
        for (std::size_t camera = 0; camera < view.scene->cameras.size(); ++camera) {
            if (camera > 0) view.look(camera, 1, kWidth, kHeight);
            INFO(entry.name << ", camera " << view.scene->cameras[camera].name);
            expectClean(check(device, cli::PlantedInputs(*view.inputs)));
        }
    }
}

TEST_CASE("formats do not matter", "[check]") {
    const lightwell::Device device;
    const SceneView view("basic", 0);
    cli::PlantedInputs inputs(*view.inputs);
    const auto convert = [](cli::PlantedInputs::Pixels& from, LWFormat format, bool normal,
                            bool bottomUp) {
        HostLayout layout;
        layout.bottomUp = bottomUp;
        layout.rowGap = 12;
        HostImage to(format, std::uint32_t(from.width), std::uint32_t(from.height), layout);
        for (int y = 0; y < from.height; ++y)
            for (int x = 0; x < from.width; ++x) {
                const float* v = from.at(x, y);
                to.set(std::uint32_t(x), std::uint32_t(y), double(v[0]), double(v[1]), double(v[2]),
                       normal);
            }
        return to;
    };
    HostImage position = convert(inputs.position, LW_FORMAT_HALF4, false, false);
    HostImage normal = convert(
        inputs.normal, GENERATE(LW_FORMAT_HALF4, LW_FORMAT_UNORM8X4, LW_FORMAT_OCT16X2), true, true);
    HostImage albedo = convert(inputs.albedo, LW_FORMAT_HALF4, false, true);
    inputs.gbuffer.position = position.image();
    inputs.gbuffer.normal = normal.image();
    inputs.gbuffer.albedo = albedo.image();
    expectClean(check(device, inputs));
    // The same pixels as sRGB bytes that are taken for linear ones.
    for (float& v : inputs.albedo.values) v = float(std::pow(double(v), 1 / 2.2));
    HostImage encoded = convert(inputs.albedo, LW_FORMAT_UNORM8X4, false, false);
    inputs.gbuffer.albedo = encoded.image();
    const auto findings = check(device, inputs);
    INFO(describe(findings));
    REQUIRE_FALSE(findings.empty());
    CHECK(nameOf(findings[0].fault) == "albedo-srgb");
}

TEST_CASE("half of the normals flipped is a finding, one in a hundred is none", "[check]") {
    const lightwell::Device device;
    const SceneView view("basic", 0);
    const int every = GENERATE(2, 100);
    cli::PlantedInputs inputs(*view.inputs);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            if ((x * 37 + y * 101) % every == 0) inputs.normal.set(x, y, -inputs.normal.triple(x, y));
    const auto findings = check(device, inputs);
    INFO(describe(findings));
    if (every == 100) return expectClean(findings);
    REQUIRE_FALSE(findings.empty());
    CHECK(nameOf(findings[0].fault) == "normal-flipped");
}

TEST_CASE("the overlay shows affected pixels in the finding's colour", "[check]") {
    const lightwell::Device device;
    const SceneView view("basic", 0);
    cli::PlantedInputs inputs(*view.inputs);
    for (int y = 70; y < 80; ++y)
        for (int x = 30; x < 50; ++x) inputs.albedo.set(x, y, glm::vec3(-1.0f));
    const lightwell::View lwView(device, kWidth, kHeight);
    HostImage overlay(GENERATE(LW_FORMAT_FLOAT3, LW_FORMAT_PLANAR_FLOAT3, LW_FORMAT_HALF4), kWidth,
                      kHeight);
    const LWImage image = overlay.image();
    const LWFrame frame = inputs.frame();
    const auto findings = lightwell::checkInputs(lwView, &frame, &inputs.gbuffer, &image);
    REQUIRE_FALSE(findings.empty());
    CHECK(nameOf(findings[0].fault) == "negative");
    std::uint32_t coloured = 0;
    for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = 0; x < kWidth; ++x) {
            const double r = overlay.value(x, y, 0), g = overlay.value(x, y, 1),
                         b = overlay.value(x, y, 2);
            CHECK((r >= 0.0 && r <= 1.0 && g >= 0.0 && g <= 1.0 && b >= 0.0 && b <= 1.0));
            coloured += std::abs(r - g) + std::abs(g - b) > 0.1;
        }
    CHECK(coloured == 200u);
    CHECK(overlay.damagedBytes() == 0);
}

TEST_CASE("scenes without camera matrices or intensity are checked for the rest", "[check]") {
    ApiScene scene;
    LWDevice device = makeDevice(16);
    LWView view = nullptr;
    const LWViewDesc desc = scene.viewDesc();
    REQUIRE(lwCreateView(device, &desc, &view) == LW_SUCCESS);
    LWInputFinding findings[8];
    std::uint32_t count = 99;
    REQUIRE(lwCheckInputs(view, &scene.frame, &scene.gbuffer, findings, 8, &count, nullptr) ==
            LW_SUCCESS);
    expectClean({findings, findings + std::min(count, 8u)});
    CHECK(lwCheckInputs(view, nullptr, &scene.gbuffer, findings, 8, &count, nullptr) == LW_SUCCESS);
    CHECK(lwCheckInputs(view, &scene.frame, nullptr, findings, 8, &count, nullptr) == LW_SUCCESS);
    // A shining sun: flux of 1 W over albedo 1/2 and E_perp 1 would be 2 W; here it is right with 2.
    scene.light.irradiance[0] = scene.light.irradiance[1] = 2.0f;
    REQUIRE(lwCheckInputs(view, &scene.frame, &scene.gbuffer, findings, 8, &count, nullptr) ==
            LW_SUCCESS);
    expectClean({findings, findings + std::min(count, 8u)});
    lwReleaseView(view);
    lwReleaseDevice(device);
}

TEST_CASE("abuse of lwCheckInputs is refused and named", "[check]") {
    ApiScene scene;
    LWDevice device = makeDevice(16);
    LWView view = nullptr;
    const LWViewDesc desc = scene.viewDesc();
    REQUIRE(lwCreateView(device, &desc, &view) == LW_SUCCESS);
    LWInputFinding findings[2];
    std::uint32_t count = 99;
    const auto call = [&](const LWFrame* frame, const LWGBuffer* gbuffer, LWInputFinding* to,
                          std::uint32_t capacity, std::uint32_t* n, const LWImage* overlay) {
        return lwCheckInputs(view, frame, gbuffer, to, capacity, n, overlay);
    };
    CHECK(lwCheckInputs(nullptr, &scene.frame, &scene.gbuffer, findings, 2, &count, nullptr) ==
          LW_ERROR_INVALID_HANDLE);
    CHECK(call(nullptr, nullptr, findings, 2, &count, nullptr) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("frame, gbuffer"));
    CHECK(call(&scene.frame, &scene.gbuffer, findings, 2, nullptr, nullptr) ==
          LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("count"));
    CHECK(call(&scene.frame, &scene.gbuffer, nullptr, 2, &count, nullptr) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("findings"));

    // A wrong size, a wrong struct, a wrong overlay.
    LWGBuffer gbuffer = scene.gbuffer;
    gbuffer.normal.width -= 1;
    CHECK(call(&scene.frame, &gbuffer, findings, 2, &count, nullptr) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("gbuffer.normal"));
    gbuffer = scene.gbuffer;
    gbuffer.structSize = 3;
    CHECK(call(&scene.frame, &gbuffer, findings, 2, &count, nullptr) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("gbuffer.structSize"));
    LWImage overlay = scene.validity.image();
    CHECK(call(&scene.frame, &scene.gbuffer, findings, 2, &count, &overlay) ==
          LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("overlay.format"));
    overlay = scene.irradiance.image();
    CHECK(call(&scene.frame, nullptr, findings, 2, &count, &overlay) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("overlay"));
    LWFrame frame = scene.frame;
    frame.lights = nullptr;
    CHECK(call(&frame, &scene.gbuffer, findings, 2, &count, nullptr) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("frame.lights"));

    // Room for none: the number comes all the same.
    for (std::uint32_t y = 0; y < scene.normal.height(); ++y)
        for (std::uint32_t x = 0; x < scene.normal.width(); ++x) scene.normal.set(x, y, 0, 0, 0);
    CHECK(call(&scene.frame, &scene.gbuffer, nullptr, 0, &count, nullptr) == LW_SUCCESS);
    CHECK(count == 1);
    findings[1].affected = 77;
    CHECK(call(&scene.frame, &scene.gbuffer, findings, 1, &count, nullptr) == LW_SUCCESS);
    CHECK(nameOf(findings[0].fault) == "no-surfaces");
    CHECK(findings[1].affected == 77);

    // The same view as a source is not told twice.
    LWSourceView source{view, &scene.gbuffer};
    frame = scene.frame;
    frame.sourceViews = &source;
    frame.sourceViewCount = 1;
    CHECK(call(&frame, &scene.gbuffer, nullptr, 0, &count, nullptr) == LW_SUCCESS);
    CHECK(count == 1);
    CHECK(call(&frame, nullptr, findings, 1, &count, nullptr) == LW_SUCCESS);
    CHECK(std::string(findings[0].argument) == "frame.sourceViews[0].gbuffer.normal");

    lwReleaseView(view);
    CHECK(call(&scene.frame, &scene.gbuffer, findings, 2, &count, nullptr) == LW_ERROR_INVALID_HANDLE);
    lwReleaseDevice(device);
}

TEST_CASE("every fault has a name, a summary and a colour of its own", "[check]") {
    const std::uint32_t count = lwCountInputFaults();
    CHECK(count == LW_FAULT_FAR_FROM_ORIGIN + 1u);
    std::vector<std::string> names, colours;
    for (std::uint32_t i = 0; i < count; ++i) {
        auto info = lightwell::make<LWInputFaultInfo>();
        REQUIRE(lwDescribeInputFault(i, &info) == LW_SUCCESS);
        CHECK(info.fault == LWInputFault(i));
        CHECK(std::string(info.summary).size() > 8);
        names.emplace_back(info.name);
        colours.push_back(std::to_string(info.colour[0]) + std::to_string(info.colour[1]) +
                          std::to_string(info.colour[2]));
    }
    for (std::vector<std::string>* list : {&names, &colours}) {
        std::sort(list->begin(), list->end());
        CHECK(std::adjacent_find(list->begin(), list->end()) == list->end());
    }
    auto info = lightwell::make<LWInputFaultInfo>();
    CHECK(lwDescribeInputFault(count, &info) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lwDescribeInputFault(0, nullptr) == LW_ERROR_INVALID_ARGUMENT);
}

// The figures of docs/checking-inputs.md: `check_inputs_test "[survey]"` with LIGHTWELL_SCENES set.
TEST_CASE("survey of false alarms and of plants found, over all scenes", "[.survey]") {
    const lightwell::Device device;
    int frames = 0, alarms = 0, planted = 0, first = 0, amongAll = 0, missed = 0;
    for (const studio::SceneEntry& entry : studio::listScenes()) {
        SceneView view(entry.path, 0);
        for (std::size_t camera = 0; camera < view.scene->cameras.size(); ++camera)
            for (const int height : {27, 90, 180})
                for (const int cascades : {1, 3}) {
                    if (cascades > 1 && !hasSun(*view.scene)) continue;
                    view.look(camera, cascades, height * 16 / 9, height);
                    const auto findings = check(device, cli::PlantedInputs(*view.inputs));
                    ++frames;
                    const bool clean = std::all_of(findings.begin(), findings.end(), [](const auto& f) {
                        return f.severity == LW_SEVERITY_NOTE;
                    });
                    alarms += !clean;
                    if (!clean)
                        std::printf("ALARM %s camera %zu height %d cascades %d: %s", entry.name.c_str(),
                                    camera, height, cascades, describe(findings).c_str());
                }
        view.look(0, 1, kWidth, kHeight);
        for (const cli::Plant& plant : cli::plants()) {
            if ((plant.needsRsm && view.scene->lights.empty()) ||
                (plant.needsSun && !hasSun(*view.scene)) || (plant.needsLamp && !hasLamp(*view.scene)))
                continue;
            cli::PlantedInputs inputs(*view.inputs);
            plant.apply(inputs);
            inputs.describe();
            const auto findings = check(device, inputs);
            ++planted;
            const bool isFirst = !findings.empty() && nameOf(findings[0].fault) == plant.fault;
            const bool isThere = std::any_of(findings.begin(), findings.end(), [&](const auto& f) {
                return nameOf(f.fault) == plant.fault;
            });
            first += isFirst;
            amongAll += isThere && !isFirst;
            missed += findings.empty();
            if (!isFirst)
                std::printf("%s %s in %s: %s\n",
                            findings.empty() ? "MISSED"
                            : isThere        ? "LATER"
                                             : "OTHER",
                            plant.name, entry.name.c_str(),
                            findings.empty() ? "" : describe(findings).c_str());
        }
    }
    std::printf(
        "%d good frames, %d with findings; %d planted, %d named first, %d named later, %d under another "
        "name, %d not found\n",
        frames, alarms, planted, first, amongAll, planted - first - amongAll - missed, missed);
}
