#include "indirect.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "vpl_placement.h"

namespace viewer {
namespace {

// Opened twice where it shares: the second time on a context of the viewer's own, made with OpenGL's.
lightwell::Device openDevice(const std::string& selector, bool wantsCopies, std::shared_ptr<GlSharing>& sharing, std::string& text) {
    LWDeviceDesc desc = lightwell::Device::defaults();
    if (!selector.empty()) desc.selector = selector.c_str();
    lightwell::Device device(desc);
    const LWDeviceInfo info = device.info();
    std::string reason;
    sharing = GlSharing::open(info, wantsCopies, reason);
    text = fmt::format("mapped copies: {}; {}", reason,
                       info.hostUnifiedMemory != 0 ? "the device works in the pixel buffers' memory" : "Lightwell uploads from the pixel buffers");
    if (!sharing) return device;
    text = fmt::format("shared by {}: pixel buffers stay in the device's memory", reason);
    desc.clContext = sharing->context();
    desc.clQueue = sharing->queue();
    return lightwell::Device(desc);
}

bool isTechniqueParameter(const LWTechniqueInfo& info, const std::string& name) {
    return std::any_of(info.parameters, info.parameters + info.parameterCount, [&](const LWParameter& parameter) {
        return parameter.kind == LW_PARAMETER_TECHNIQUE && name == parameter.name;
    });
}

}  // namespace

LWTechniqueInfo describeTechnique(const std::string& name) {
    std::string names;
    for (std::uint32_t i = 0; i < lwCountTechniques(); ++i) {
        auto info = lightwell::make<LWTechniqueInfo>();
        lightwell::check(lwDescribeTechnique(i, &info));
        if (name == info.name) return info;
        names += (i == 0 ? "" : ", ") + std::string(info.name);
    }
    throw std::invalid_argument(fmt::format("unknown technique '{}'; valid: {}", name, names));
}

std::string defaultText(const LWParameter& parameter) {
    if (parameter.kind == LW_PARAMETER_ENUM || parameter.kind == LW_PARAMETER_TECHNIQUE)
        return parameter.choices[std::size_t(parameter.defaultValue)];
    if (parameter.kind == LW_PARAMETER_BOOL) return parameter.defaultValue != 0.0 ? "on" : "off";
    return fmt::format("{}", parameter.defaultValue);
}

std::string Settings::text() const {
    const LWTechniqueInfo info = describeTechnique(technique);
    std::string parts, others;
    for (const auto& [name, value] : assignments) {
        std::string& words = isTechniqueParameter(info, name) ? parts : others;
        words += fmt::format("{}={} ", name, value);
    }
    std::string all = parts + others;
    if (!all.empty()) all.pop_back();
    return all;
}

bool Settings::uses(const std::string& name) const {
    if (technique == name) return true;
    const LWTechniqueInfo info = describeTechnique(technique);
    for (std::uint32_t i = 0; i < info.parameterCount; ++i) {
        const LWParameter& parameter = info.parameters[i];
        if (parameter.kind != LW_PARAMETER_TECHNIQUE) continue;
        const auto chosen = assignments.find(parameter.name);
        if (name == (chosen != assignments.end() ? chosen->second : defaultText(parameter))) return true;
    }
    return false;
}

Indirect::Indirect(const std::string& selector, bool wantsCopies)
    : device_(openDevice(selector, wantsCopies, sharing_, sharingText_)), info_(device_.info()) {}

void Indirect::resize(int width, int height) {
    view_ = std::make_unique<lightwell::View>(device_, std::uint32_t(width), std::uint32_t(height));
    reset_ = true;
}

void Indirect::choose(const Settings& settings) {
    const std::string text = settings.text();
    lightwell::Technique technique = lightwell::Technique::fromText(device_, settings.technique.c_str(), text.c_str());
    if (view_) technique.prewarm(*view_);
    technique_ = technique;
    settings_ = settings;
    reset_ = true;
}

// Placed once as `lightwell place-vpls` does by default; those of moving objects move with them.
void Indirect::addStaticVpls(LWFrame& frame, const studio::RayScene& scene) {
    if (!hasPlaced_) {
        studio::PlacementOptions options;
        for (const studio::Light& light : scene.lights())
            if (light.kind != studio::LightKind::Sun) options.from.push_back(light.position);
        if (options.from.empty()) options.from.push_back({frame.focus[0], frame.focus[1], frame.focus[2]});
        placed_ = studio::placeVpls(scene, options, {}).vpls;
        hasPlaced_ = true;
    }
    const studio::StaticVpls posed = studio::posedVpls(placed_, scene.scene(), scene.time());
    staticVpls_.clear();
    for (const studio::StaticVpl& from : posed.vpls) {
        LWStaticVpl to{};
        for (int i = 0; i < 3; ++i) {
            to.position[i] = from.position[i];
            to.normal[i] = from.normal[i];
            to.reflectance[i] = from.reflectance[i];
        }
        to.weight = from.weight ? *from.weight * posed.areaPerWeight : 0.0f;
        to.lightMask = from.lightMask;
        staticVpls_.push_back(to);
    }
    frame.staticVpls = staticVpls_.data();
    frame.staticVplCount = std::uint32_t(staticVpls_.size());
}

void Indirect::render(FrameInputs& inputs, const IndirectImages& images, const studio::RayScene& scene) {
    LWFrame& frame = inputs.frame();
    frame.frameIndex = frameIndex_++;
    frame.reset = reset_ ? 1 : 0;
    if (settings_.uses("static_vpl")) addStaticVpls(frame, scene);
    const LWSourceView source{view_->get(), &inputs.gbuffer()};
    frame.sourceViews = &source;
    frame.sourceViewCount = 1;
    LWOutput output = lightwell::make<LWOutput>();
    output.irradiance = images.irradiance();
    output.validity = images.validity();
    const auto start = std::chrono::steady_clock::now();
    try {
        technique_->update(frame);
        technique_->render(*view_, inputs.gbuffer(), output);
        device_.finish();
    } catch (...) {
        lwFinish(device_.get());  // commands on their way may still read what the caller unmaps next
        frame.sourceViews = nullptr;
        frame.sourceViewCount = 0;
        throw;
    }
    const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start;
    frame.sourceViews = nullptr;  // `source` ends here
    frame.sourceViewCount = 0;
    reset_ = false;
    readFigures(wall.count());
}

void Indirect::readFigures(double wallMilliseconds) {
    const LWStats stats = technique_->stats();
    figures_ = {};
    figures_.wallMilliseconds = wallMilliseconds;
    figures_.deviceMilliseconds = stats.totalMilliseconds;
    for (std::uint32_t i = 0; i < stats.passCount; ++i) figures_.passes.push_back({stats.passes[i].name, stats.passes[i].milliseconds});
    for (std::uint32_t i = 0; i < stats.countCount; ++i) figures_.counts.emplace_back(stats.counts[i].name, stats.counts[i].value);
    for (std::uint32_t i = 0; i < stats.choiceCount; ++i) figures_.choices.emplace_back(stats.choices[i].name, stats.choices[i].reason);
    figures_.deviceBytes = stats.deviceBytes;
    figures_.hostCopyBytes = stats.hostCopyBytes;
}

std::vector<LWInputFinding> Indirect::check(FrameInputs& inputs, std::vector<float>& overlay) {
    const auto [width, height] = view_->size();
    overlay.assign(std::size_t(width) * height * 3, 0.0f);
    LWImage image{};
    image.host = overlay.data();
    image.format = LW_FORMAT_FLOAT3;
    image.width = width;
    image.height = height;
    return lightwell::checkInputs(*view_, &inputs.frame(), &inputs.gbuffer(), &image);
}

}  // namespace viewer
