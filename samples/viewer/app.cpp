#include "app.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "image.h"
#include "panels.h"
#include "report.h"

namespace viewer {
namespace {

constexpr float kPathStep = 1.0f / 30.0f;  // s, of a path's frames without a window
// A sun's RSM is fitted anew when the view has moved by this share of the scene's size, or turned by this (its cosine).
constexpr float kFitDistance = 0.02f, kFitTurn = 0.996f;
constexpr int kFitRows = 48;  // of the small picture that it is fitted to

std::shared_ptr<const studio::Scene> loadScene(const std::string& name) {
    try {
        return std::make_shared<const studio::Scene>(studio::loadScene(name));
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        throw UsageError(fmt::format("--scene: {}", error.what()));
    }
}

int findCamera(const studio::Scene& scene, const std::string& name) {
    try {
        return scene.findCamera(name);
    } catch (const std::exception& error) {
        throw UsageError(fmt::format("--camera: {}", error.what()));
    }
}

CameraPath readPath(const std::string& file) {
    try {
        return CameraPath(file);
    } catch (const std::exception& error) {
        throw UsageError(error.what());
    }
}

bool isKeyed(const studio::Scene& scene) {
    return !scene.lightTracks.empty() ||
           std::any_of(scene.objects.begin(), scene.objects.end(), [](const studio::Object& object) { return !object.keys.empty(); });
}

std::vector<studio::Light> lightsAt(const studio::Scene& scene, float time) {
    std::vector<studio::Light> lights;
    for (std::size_t i = 0; i < scene.lights.size(); ++i) lights.push_back(scene.lightAt(int(i), time));
    return lights;
}

float secondsSince(std::chrono::steady_clock::time_point& last) {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<float>(now - std::exchange(last, now)).count();
}

}  // namespace

App::App(const Options& options, Context& context)
    : options_(options),
      context_(context),
      look_(options.look),
      scene_(loadScene(options.scene)),
      cameraIndex_(findCamera(*scene_, options.camera)),
      rayScene_(std::make_unique<studio::RayScene>(scene_, options.time)),
      triangles_(studio::sceneTriangles(*rayScene_)),
      lights_(lightsAt(*scene_, options.time)),
      hasMotion_(isKeyed(*scene_)),
      meshes_(*scene_),
      indirect_(options.device),
      camera_(scene_->cameraAt(cameraIndex_, options.time), rayScene_->diagonal()),
      path_(options.path.empty() ? CameraPath(*scene_, cameraIndex_) : readPath(options.path)),
      time_(options.time),
      timeOfScene_(options.time) {
    if (options_.step < 0.0f) options_.step = options.path.empty() ? 0.0f : kPathStep;
    isPlaying_ = !options.path.empty() || (context.window() == nullptr && options_.step > 0.0f);
    look_.farthest = 0.5f * rayScene_->diagonal();
    for (const studio::Light& light : lights_) {
        maps_.emplace_back();
        maps_.back().light = light;
    }
    poses_ = posesBefore_ = posesAt(*scene_, time_);
    resize();
    try {
        indirect_.choose(options.settings);
    } catch (const lightwell::Error& error) {
        if (error.status() != LW_ERROR_INVALID_ARGUMENT) throw;
        throw UsageError(fmt::format("--technique {}: {}", options.settings.technique, error.what()));
    }
    if (!options.truth.empty()) loadTruth();
    if (scene_->emissiveSurfaces || scene_->sky != glm::vec3(0.0f))
        notice_ = "Direct light is that of suns, spots and points: what a sky or glowing surfaces send straight is not drawn.";
    if (!notice_.empty() && context.window() == nullptr) fmt::print(stderr, "note: {}\n", notice_);
}

App::~App() = default;

void App::loadTruth() {
    const std::string& file = options_.truth;
    studio::Image image;
    try {
        image = studio::readImage(file);
        if (!image.has("R") || !image.has("G") || !image.has("B")) throw std::runtime_error("expected irradiance in channels R, G and B");
    } catch (const std::exception& error) {
        throw UsageError(fmt::format("--truth {}: {}", file, error.what()));
    }
    if (image.width != width_ || image.height != height_)
        throw UsageError(fmt::format("--truth {}: expected the view's size, {}x{}, got {}x{}; give --size", file, width_, height_, image.width,
                                     image.height));
    std::vector<float> rgb(image.pixelCount() * 3);
    for (std::size_t i = 0; i < image.pixelCount(); ++i) {
        rgb[3 * i] = image.plane("R")[i];
        rgb[3 * i + 1] = image.plane("G")[i];
        rgb[3 * i + 2] = image.plane("B")[i];
    }
    compose_.setTruth(image.width, image.height, rgb);
    truthSize_ = {image.width, image.height};
}

bool App::truthFits() const {
    return compose_.hasTruth() && truthSize_ == glm::ivec2(width_, height_);
}

void App::resize() {
    int width = 0, height = 0;
    context_.size(width, height);
    width = std::max(width, 1);  // an iconified window has no pixels
    height = std::max(height, 1);
    if (width == width_ && height == height_) return;
    width_ = width;
    height_ = height;
    gbuffer_.resize(width, height);
    light_.resize(width, height);
    indirect_.resize(width, height);
    if (context_.window() != nullptr) return;
    screenImage_ = Texture({GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4}, width, height);
    screenTarget_ = Framebuffer({&screenImage_}, nullptr);
}

void App::choose(const Settings& settings) {
    try {
        indirect_.choose(settings);
        message_.clear();
    } catch (const std::exception& error) {
        message_ = error.what();
    }
}

void App::writePath() {
    if (path_.isEmpty()) return;
    try {
        path_.write("viewer_path.json");
        notice_ = "wrote viewer_path.json";
    } catch (const std::exception& error) {
        message_ = error.what();
    }
}

// The clock of paths and keyframes; whoever flies by hand leaves the path.
void App::advance(float seconds) {
    if (isPlaying_ && !isFirst_) time_ += context_.window() != nullptr ? seconds : options_.step;
    const float end = path_.duration();
    if (context_.window() != nullptr && isPlaying_ && !path_.isEmpty() && time_ > end) time_ = 0.0f;  // again
    if (isPlaying_ && !path_.isEmpty()) camera_.set(path_.at(time_));
    if (options_.hasPanels && context_.window() != nullptr && camera_.fly(seconds) && !path_.isEmpty()) isPlaying_ = false;
}

void App::setTime() {
    posesBefore_ = isFirst_ ? posesAt(*scene_, time_) : poses_;
    if (!hasMotion_ || time_ == timeOfScene_) return;
    timeOfScene_ = time_;
    rayScene_ = std::make_unique<studio::RayScene>(scene_, time_);
    triangles_ = studio::sceneTriangles(*rayScene_);
    if (!scene_->lightTracks.empty()) lights_ = lightsAt(*scene_, time_);
    poses_ = posesAt(*scene_, time_);
    lightsMoved_ = true;
}

void App::placeLights() {
    const glm::mat4 now = glm::inverse(eye_.view), fitted = glm::inverse(eyeOfFit_.view);
    const bool hasTurned = glm::dot(glm::vec3(now[2]), glm::vec3(fitted[2])) < kFitTurn;
    const bool hasWalked = glm::length(glm::vec3(now[3]) - glm::vec3(fitted[3])) > kFitDistance * rayScene_->diagonal();
    const bool viewMoved = hasTurned || hasWalked || isFirst_ || eye_.projection != eyeOfFit_.projection;
    if (!lightsMoved_ && !viewMoved) return;
    eyeOfFit_ = eye_;
    const int columns = std::max(1, kFitRows * width_ / height_);
    const studio::GBuffer view = studio::renderGBuffer(*rayScene_, camera_.camera(), columns, kFitRows, camera_.camera(), rayScene_->time());
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
        whileMapped();
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
    eye_ = {camera_.camera().viewMatrix(), camera_.camera().projectionMatrix(width_, height_)};
    if (isFirst_) eyeBefore_ = eye_;
    if (isLast && options_.checks) wantsCheck_ = true;
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

void App::run() {
    std::unique_ptr<Panels> panels;
    if (options_.hasPanels) panels = std::make_unique<Panels>(context_);
    if (options_.frames > 0) timings_.keep(std::size_t(options_.frames));
    auto last = std::chrono::steady_clock::now();
    const int count = options_.frames > 0 ? options_.warmUp + options_.frames : 0;
    for (int frame = 0; count == 0 || frame < count; ++frame) {
        context_.beginFrame();
        if (context_.wantsToClose()) break;
        const float seconds = secondsSince(last);
        if (panels) panels->begin(width_, height_, seconds);
        advance(seconds);
        drawFrame(frame + 1 == count);
        if (panels) panels->draw(*this, screen());
        if (panels) timings_.endStage("panels");
        timings_.endFrame();
        if (wantsScreenshot_) saveScreenshot(fmt::format("viewer_{}.png", ++screenshotCount_));
        if (frame + 1 == count) writeOutputs();
        context_.endFrame();
        if (frame + 1 == options_.warmUp) timings_.restart();
    }
}

void App::saveScreenshot(const std::string& file) {
    wantsScreenshot_ = false;
    try {
        writeScreen(file, screen(), width_, height_);
        notice_ = "wrote " + file;
    } catch (const std::exception& error) {
        if (context_.window() == nullptr) throw;
        message_ = error.what();
    }
}

void App::writeOutputs() {
    if (!options_.screenshot.empty()) saveScreenshot(options_.screenshot);
    if (!options_.out.empty()) writeLayers(options_.out, gbuffer_.images(), light_.texture());
    Report report;
    report.options = &options_;
    report.scene = scene_.get();
    report.camera = scene_->cameras.at(std::size_t(cameraIndex_)).name;
    report.width = width_;
    report.height = height_;
    report.context = context_.description();
    report.indirect = &indirect_;
    report.indirectFrames = &indirectFrames_;
    report.timings = &timings_;
    report.readBackBytes = inputs_.byteCount();
    report.uploadBytes = light_.byteCount();
    report.exposure = look_.exposure;
    report.findings = &findings_;
    for (const LightMaps& maps : maps_)
        for (const RsmImages& rsm : maps.rsms) report.rsms.push_back(sumRsm(maps.light.name, rsm));
    if (options_.asJson)
        fmt::print("{}", toJson(report));
    else
        fmt::print("{}", toText(report));
}

}  // namespace viewer
