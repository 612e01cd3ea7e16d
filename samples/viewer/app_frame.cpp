// A frame of the viewer, from where its lights' maps lie to its picture.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app.h"

namespace viewer {
namespace {

// A sun's RSM is fitted anew when the view has moved by this share of the scene's size, or turned by this (its cosine).
constexpr float kFitDistance = 0.02f, kFitTurn = 0.996f;
constexpr int kFitRows = 48, kFitColumns = 192;  // at most, of the small picture that it is fitted to

// The nearest plane as a share of the farthest: 2e-4 without a reversed depth put the Cornell box's lamp into its ceiling.
constexpr float kNearShare = 1e-4f, kNearShareOfGl = 5e-3f;

}  // namespace

// The studio casts rays, which its cameras' planes don't cut. Here planes hold all of the scene, in powers of two: a camera
// that flies keeps its projection.
Eye App::eyeOfCamera() const {
    studio::Camera camera = camera_.camera();
    const glm::vec3 reach = glm::max(glm::abs(camera.position - lower_), glm::abs(camera.position - upper_));
    camera.farPlane = std::exp2(std::ceil(std::log2(std::max(1.01f * glm::length(reach), 1e-6f))));
    camera.nearPlane = (DepthTest::isReversed() ? kNearShare : kNearShareOfGl) * camera.farPlane;
    return {camera.viewMatrix(), camera.projectionMatrix(width_, height_)};
}

void App::placeLights() {
    const glm::mat4 now = glm::inverse(eye_.view), fitted = glm::inverse(eyeOfFit_.view);
    const bool hasTurned = glm::dot(glm::vec3(now[2]), glm::vec3(fitted[2])) < kFitTurn;
    const bool hasWalked = glm::length(glm::vec3(now[3]) - glm::vec3(fitted[3])) > kFitDistance * rayScene_->diagonal();
    const bool viewMoved = hasTurned || hasWalked || isFirst_ || eye_.projection != eyeOfFit_.projection;
    if (!lightsMoved_ && !viewMoved) return;
    eyeOfFit_ = eye_;
    const int columns = std::clamp(kFitRows * width_ / height_, 1, kFitColumns);
    const int rows = std::clamp(columns * height_ / width_, 1, kFitRows);
    const studio::GBuffer view = studio::renderGBuffer(*rayScene_, camera_.camera(), columns, rows, camera_.camera(), rayScene_->time());
    studio::RsmOptions rsm;
    rsm.size = options_.rsmSize;
    rsm.view = &view;
    for (std::size_t i = 0; i < maps_.size(); ++i) {
        maps_[i].light = lights_[i];
        if (lightsMoved_ || lights_[i].kind == studio::LightKind::Sun) lightPasses_.place(maps_[i], *rayScene_, rsm, options_.shadowSize);
    }
    lightsMoved_ = false;
}

void App::drawScene() {
    placeLights();
    timings_.endStage("fit_lights");
    gbuffer_.draw(meshes_, eye_, eyeBefore_, poses_, posesBefore_);
    timings_.endStage("gbuffer");
    for (const LightMaps& maps : maps_) lightPasses_.drawShadows(maps, meshes_, poses_);
    timings_.endStage("shadow_maps");
    for (const LightMaps& maps : maps_) lightPasses_.drawRsms(maps, meshes_, poses_);
    timings_.endStage("rsms");
    direct_.draw(gbuffer_.images(), eye_, maps_);
    timings_.endStage("direct_light");
}

void App::lightIndirectly() {
    struct Unmap {  // whatever is thrown in between
        FrameInputs& inputs;
        IndirectImages& light;
        ~Unmap() { inputs.unmap(), light.unmap(); }
    };
    inputs_.read(gbuffer_.images(), maps_);
    {
        const Unmap unmap{inputs_, light_};
        inputs_.map(eye_, eyeBefore_, maps_, triangles_, scene_->sky);
        light_.map();
        timings_.endStage("read_back");
        try {
            indirect_.render(inputs_, light_, *rayScene_);
        } catch (const std::exception& error) {
            if (context_.window() == nullptr) throw;
            message_ = error.what();
        }
        timings_.endStage("lightwell");
        try {
            whileMapped();
        } catch (const std::exception& error) {  // e.g. a buffer that is larger than OpenGL's images can be
            if (context_.window() == nullptr) throw;
            message_ = error.what();
            look_.show = Show::Picture;
        }
    }
    light_.upload();
    timings_.endStage("upload");
}

// What reads the frame's inputs once more.
void App::whileMapped() {
    debugViews_ = indirect_.debugViews();
    if (wantsCheck_) {
        std::vector<float> overlay;
        findings_ = indirect_.check(inputs_, overlay);
        std::vector<float> planes(overlay.size());
        const std::size_t count = overlay.size() / 3;
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t c = 0; c < 3; ++c) planes[c * count + i] = overlay[3 * i + c];
        compose_.setExtra(width_, height_, 3, planes);
        wantsCheck_ = false;
        timings_.endStage("check_inputs");
    }
    if (look_.show != Show::Debug) return;
    const auto view = std::find_if(debugViews_.begin(), debugViews_.end(),
                                   [this](const LWDebugView& info) { return options_.debugView == info.name; });
    if (view == debugViews_.end()) {
        std::vector<std::string> names;
        for (const LWDebugView& info : debugViews_) names.emplace_back(info.name);
        message_ = fmt::format("--debug-view: no '{}' of technique {}; there are: {}", options_.debugView, settings().technique, fmt::join(names, ", "));
        if (context_.window() == nullptr) throw UsageError(message_);
        look_.show = Show::Picture;
        return;
    }
    compose_.setExtra(int(view->width), int(view->height), int(view->channels), indirect_.readDebugView(*view));
    timings_.endStage("debug_view");
}

void App::drawFrame(bool isLast) {
    timings_.beginFrame();
    resize();
    setTime();
    eyeBefore_ = eye_;
    eye_ = eyeOfCamera();
    if (isFirst_) eyeBefore_ = eye_;
    if (options_.checks && (isLast || (isFirst_ && options_.frames == 0))) wantsCheck_ = true;
    drawScene();
    lightIndirectly();
    if (look_.isAutomatic) look_.exposure = compose_.measureExposure(gbuffer_.images(), light_.texture());
    Look look = look_;
    if (!truthFits()) look.split = 1.0f;
    compose_.draw(screen(), width_, height_, gbuffer_.images(), light_.texture(), look);
    timings_.endStage("compose");
    indirectFrames_.push_back(indirect_.figures());
    if (indirectFrames_.size() > std::size_t(std::max(1, options_.frames))) indirectFrames_.erase(indirectFrames_.begin());
    isFirst_ = false;
}

}  // namespace viewer
