// Lightwell: the device, the technique that is chosen, and a frame's indirect light.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "frame_inputs.h"
#include "lightwell/lightwell.hpp"
#include "static_vpls.h"

namespace viewer {

// A technique and those of its parameters that differ from the defaults, as text: "vpls", "second.vpls".
struct Settings {
    std::string technique = "ssvp";
    std::map<std::string, std::string> assignments;
    std::string text() const;  // for lwCreateTechniqueFromText; techniques that are parameters come first
    bool uses(const std::string& name) const;  // it, or a technique that is a parameter
};

LWTechniqueInfo describeTechnique(const std::string& name);  // std::invalid_argument listing the techniques
std::string defaultText(const LWParameter& parameter);

struct PassTime {
    std::string name;
    double milliseconds;
};

// Of the last frame.
struct IndirectFigures {
    double wallMilliseconds = 0.0, deviceMilliseconds = -1.0;  // device: -1 where its queue has no clock
    std::vector<PassTime> passes;
    std::vector<std::pair<std::string, std::uint64_t>> counts;
    std::vector<std::pair<std::string, std::string>> choices;
    std::uint64_t deviceBytes = 0, hostCopyBytes = 0;
};

class Indirect {
public:
    // `selector` as LWDeviceDesc's, "": its default. OpenGL's buffers are shared where that can be done, unless copies are
    // wanted. lightwell::Error.
    Indirect(const std::string& selector, bool wantsCopies);
    const LWDeviceInfo& deviceInfo() const { return info_; }
    // How OpenGL's images come to this device, and why so.
    const std::string& sharing() const { return sharingText_; }
    const std::shared_ptr<GlSharing>& glSharing() const { return sharing_; }  // null: copies

    void resize(int width, int height);
    // lightwell::Error naming what is wrong; the technique before stays in force.
    void choose(const Settings& settings);
    const Settings& settings() const { return settings_; }

    // Waits for the light. What `inputs` and `output` describe is free again afterwards.
    void render(FrameInputs& inputs, const IndirectImages& images, const studio::RayScene& scene);
    const IndirectFigures& figures() const { return figures_; }

    // While the last frame's inputs are still mapped.
    std::vector<LWDebugView> debugViews() const { return technique_->debugViews(view_.get()); }
    std::vector<float> readDebugView(const LWDebugView& view) const { return technique_->readDebugView(view, view_.get()); }
    // `overlay`: RGB floats of the view's pixels.
    std::vector<LWInputFinding> check(FrameInputs& inputs, std::vector<float>& overlay);

private:
    void addStaticVpls(LWFrame& frame, const studio::RayScene& scene);
    void readFigures(double wallMilliseconds);

    std::shared_ptr<GlSharing> sharing_;
    std::string sharingText_;
    lightwell::Device device_;
    LWDeviceInfo info_{};
    std::unique_ptr<lightwell::View> view_;
    std::optional<lightwell::Technique> technique_;
    Settings settings_;
    IndirectFigures figures_;
    std::uint64_t frameIndex_ = 0;
    bool reset_ = true;
    bool hasPlaced_ = false;
    studio::StaticVpls placed_;
    std::vector<LWStaticVpl> staticVpls_;
};

}  // namespace viewer
