// `lightwell check`: what lwCheckInputs says of the inputs that the studio makes of a scene, or of the
// same inputs spoilt on purpose.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "check_findings.h"
#include "check_light.h"
#include "check_plant.h"
#include "cli.h"
#include "image.h"
#include "open_device.h"

namespace cli {
namespace {

struct CheckOptions {
    ViewOptions view;
    std::string plant, overlay, device, light;
    int rsmSize = 256, cascades = 1;
    bool asJson = false;
};

const Plant* findPlant(const std::string& name) {
    if (name.empty()) return nullptr;
    std::vector<std::string> names;
    for (const Plant& plant : plants()) {
        if (name == plant.name) return &plant;
        names.emplace_back(plant.name);
    }
    requireOneOf("fault to plant", name, names);
    return nullptr;
}

// What a plant spoils must be there.
void requireLights(const Plant& plant, const studio::Scene& scene) {
    using studio::LightKind;
    const auto has = [&](auto test) {
        return std::any_of(scene.lights.begin(), scene.lights.end(), test);
    };
    const bool sun = has([](const studio::Light& l) { return l.kind == LightKind::Sun; });
    const bool lamp = has([](const studio::Light& l) { return l.kind != LightKind::Sun; });
    if ((plant.needsRsm && scene.lights.empty()) || (plant.needsSun && !sun) ||
        (plant.needsLamp && !lamp))
        throw UsageError(fmt::format("--plant '{}': expected a scene with {}, {} has none", plant.name,
                                     plant.needsSun    ? "a sun"
                                     : plant.needsLamp ? "a spot or point light"
                                                       : "a light",
                                     scene.name));
}

nlohmann::ordered_json toJson(const std::string& technique, const LightChange& change) {
    if (!change.refusal.empty()) return {{"technique", technique}, {"refusal", change.refusal}};
    return {{"technique", technique}, {"mean", change.mean}, {"black", change.black}, {"off", change.off}};
}

void printLight(const std::string& technique, const LightChange& change) {
    if (!change.refusal.empty())
        fmt::print("{}: refused, {}\n", technique, change.refusal);
    else
        fmt::print("{}: mean light {:.4g} times that of sound inputs; of the lit pixels {:.1f} % are black and {:.1f} % off by more than a tenth\n",
                   technique, change.mean, 100.0 * change.black, 100.0 * change.off);
}

void print(const CheckOptions& options, const std::string& scene, const std::string& camera,
           const Size& size, const std::vector<LWInputFinding>& findings, const LightChange* change) {
    if (options.asJson) {
        nlohmann::ordered_json document{{"scene", scene},
                                        {"camera", camera},
                                        {"size", {size.width, size.height}},
                                        {"planted", options.plant}};
        document["findings"] = nlohmann::ordered_json::array();
        for (const LWInputFinding& f : findings) document["findings"].push_back(findingJson(f));
        if (change) document["light"] = toJson(options.light, *change);
        // A figure may be infinite in spoilt inputs; JSON has no word for that and gets null.
        fmt::print("{}\n", document.dump(2));
        return;
    }
    for (const LWInputFinding& f : findings) {
        fmt::print("{} {}: {}\n", severityName(f), faultName(f.fault), f.argument);
        fmt::print("  {}\n", f.message);
        fmt::print("  {} of {} affected, measured {:.4g}, expected {:.4g}, confidence {:.2f}{}\n",
                   f.affected, f.examined, f.measured, f.expected, f.confidence,
                   options.overlay.empty() ? "" : ", in the overlay " + colourText(f.colour));
    }
    if (change) printLight(options.light, *change);
    if (findings.empty()) fmt::print("nothing wrong found in {}, camera {}\n", scene, camera);
    if (!options.overlay.empty()) fmt::print("overlay: {}\n", options.overlay);
}

void writeOverlay(const std::string& path, const std::vector<float>& pixels, const Size& size) {
    studio::Image image(size.width, size.height);
    int channel = 0;
    for (const char* name : {"R", "G", "B"}) {
        std::vector<float>& plane = image.plane(name);
        for (std::size_t i = 0; i < plane.size(); ++i)
            plane[i] = std::clamp(pixels[3 * i + std::size_t(channel)], 0.0f, 1.0f);
        ++channel;
    }
    studio::writePng(path, image);
}

void checkScene(const CheckOptions& options) {
    const Plant* const plant = findPlant(options.plant);
    const Size size = parseSize(options.view.size);
    if (!options.overlay.empty()) requireOutputPath("--overlay", options.overlay, {".png"});
    if (options.cascades > 1 && options.rsmSize % 2 != 0)
        throw UsageError(
            fmt::format("--rsm-size '{}': expected an even number with --cascades", options.rsmSize));
    const auto scene = loadScene(options.view);
    if (plant != nullptr) requireLights(*plant, *scene);
    const studio::Camera camera = findCamera(*scene, options.view), before = cameraBefore(camera);

    InputOptions inputOptions;
    inputOptions.width = size.width;
    inputOptions.height = size.height;
    inputOptions.time = inputOptions.previousTime = float(options.view.time);
    inputOptions.rsm.size = options.rsmSize;
    inputOptions.rsm.cascades = options.cascades;
    inputOptions.previousCamera = &before;
    const auto rayScene =
        asUsage([&] { return std::make_unique<studio::RayScene>(scene, inputOptions.time); });
    const RenderInputs inputs(*rayScene, camera, inputOptions);
    PlantedInputs planted(inputs);
    if (plant != nullptr) {
        plant->apply(planted);
        planted.describe();
    }

    const lightwell::Device device = openDevice(options.device, 0);
    const lightwell::View view(device, std::uint32_t(size.width), std::uint32_t(size.height));
    std::vector<float> pixels;
    LWImage overlay{};
    if (!options.overlay.empty()) {
        pixels.resize(3 * std::size_t(size.width) * std::size_t(size.height));
        overlay.host = pixels.data();
        overlay.format = LW_FORMAT_FLOAT3;
        overlay.width = std::uint32_t(size.width);
        overlay.height = std::uint32_t(size.height);
    }
    const LWFrame frame = planted.frame();
    const std::vector<LWInputFinding> findings = lightwell::checkInputs(
        view, &frame, &planted.gbuffer, options.overlay.empty() ? nullptr : &overlay);
    if (!options.overlay.empty()) writeOverlay(options.overlay, pixels, size);
    LightChange change;
    if (!options.light.empty()) {
        const PlantedInputs sound(inputs);
        const LWFrame soundFrame = sound.frame();
        change = asUsage([&] { return changeOfLight(device, view, options.light, soundFrame, sound.gbuffer, frame, planted.gbuffer); });
    }
    print(options, scene->name, camera.name, size, findings, options.light.empty() ? nullptr : &change);
    const auto errors = std::count_if(findings.begin(), findings.end(), [](const LWInputFinding& f) {
        return f.severity == LW_SEVERITY_ERROR;
    });
    if (errors > 0)
        throw std::runtime_error(
            fmt::format("check: {} error{} in the inputs", errors, errors == 1 ? "" : "s"));
}

std::string describePlants() {
    std::string text = "Faults to plant:\n";
    for (const Plant& plant : plants())
        text += fmt::format("  {:<22} {}; found as {}\n", plant.name, plant.summary, plant.fault);
    return text;
}

}  // namespace

void addCheck(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "check", "Name what is wrong with a frame's inputs; with --plant, spoil them first");
    auto options = std::make_shared<CheckOptions>();
    options->view.size = "640x360";
    options->view.declare(*command);
    command->add_option("--plant", options->plant, "Spoil the inputs in one way (below)");
    command->add_option("--overlay", options->overlay,
                        "FILE.png: the view in grey, affected pixels in their finding's colour");
    command->add_option("--light", options->light,
                        "Technique and settings, as \"ssvp clusters=16\": what the fault does to its light");
    command->add_option("--rsm-size", options->rsmSize, "Texels along each side of an RSM")
        ->check(CLI::Range(1, kMaxSize))
        ->capture_default_str();
    command->add_option("--cascades", options->cascades, "Nested RSMs of a sun")
        ->check(CLI::Range(1, 8))
        ->capture_default_str();
    command->add_option(
        "--device", options->device,
        "gpu, cpu, PLATFORM:DEVICE indices or part of a name; default: LIGHTWELL_DEVICE, else the best");
    command->add_flag("--json", options->asJson,
                      "JSON on stdout: scene, camera, size, planted, findings");
    command->footer([] { return describePlants(); });
    command->callback([options] { checkScene(*options); });
}

}  // namespace cli
