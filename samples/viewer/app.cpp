#include "app.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "image.h"
#include "panels.h"
#include "report.h"

namespace viewer {
namespace {

constexpr float kPathStep = 1.0f / 30.0f;  // s, of a path's frames without a window

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

Indirect openIndirect(const std::string& selector, bool wantsCopies) {
    try {
        return Indirect(selector, wantsCopies);
    } catch (const lightwell::Error& error) {
        if (selector.empty() || (error.status() != LW_ERROR_NO_DEVICE && error.status() != LW_ERROR_INVALID_ARGUMENT)) throw;
        throw UsageError(fmt::format("--device '{}': {}", selector, error.what()));
    }
}

CameraPath readPath(const std::string& file) {
    try {
        return CameraPath(file);
    } catch (const std::exception& error) {
        throw UsageError(fmt::format("--path: {}", error.what()));
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
      indirect_(openIndirect(options.device, options.wantsCopies)),
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
    rayScene_->boundsAlong(glm::mat3(1.0f), lower_, upper_);
    poses_ = posesBefore_ = posesAt(*scene_, time_);
    inputs_.share(indirect_.glSharing());
    light_.share(indirect_.glSharing());
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
    if (width_ > 0 && (width < 1 || height < 1)) return;  // an iconified window has no pixels
    width = std::max(width, 1);
    height = std::max(height, 1);
    if (width == width_ && height == height_) return;
    width_ = width;
    height_ = height;
    gbuffer_.resize(width, height);
    light_.resize(width, height);
    indirect_.resize(width, height);
    timings_.restart();  // medians of one size, and of one technique
    if (context_.window() != nullptr) return;
    screenImage_ = Texture({GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4}, width, height);
    screenTarget_ = Framebuffer({&screenImage_}, nullptr);
}

void App::choose(const Settings& settings) {
    try {
        indirect_.choose(settings);
        message_.clear();
        debugViews_.clear();  // their names go with the technique
        timings_.restart();
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
    rayScene_->boundsAlong(glm::mat3(1.0f), lower_, upper_);
    if (!scene_->lightTracks.empty()) lights_ = lightsAt(*scene_, time_);
    poses_ = posesAt(*scene_, time_);
    lightsMoved_ = true;
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
        message_ = error.what();
    }
}

void App::writeOutputs() {
    if (!options_.screenshot.empty()) writeScreen(options_.screenshot, screen(), width_, height_);
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
