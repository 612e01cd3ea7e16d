// The viewer: a scene, what is drawn of it, and the state that panels and the command line change.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "camera_control.h"
#include "compose.h"
#include "context.h"
#include "frame_inputs.h"
#include "indirect.h"
#include "light_maps.h"
#include "options.h"
#include "timings.h"

namespace viewer {

class App {
public:
    // Loads, compiles, allocates; the context is current. std::exception naming what is wrong.
    App(const Options& options, Context& context);
    ~App();
    App(const App&) = delete;
    App& operator=(const App&) = delete;

    void run();  // to the last frame, with its outputs

    // For the panels: all of these may be changed between frames.
    Options& options() { return options_; }
    Look& look() { return look_; }
    const Settings& settings() const { return indirect_.settings(); }
    void choose(const Settings& settings);  // what is refused stands in message()
    const std::string& message() const { return message_; }
    const std::string& notice() const { return notice_; }  // what is worth knowing
    const Indirect& indirect() const { return indirect_; }
    const Timings& timings() const { return timings_; }
    const std::vector<LWDebugView>& debugViews() const { return debugViews_; }
    const std::vector<LWInputFinding>& findings() const { return findings_; }
    void askForCheck() { wantsCheck_ = true; }
    const studio::Scene& scene() const { return *scene_; }
    std::vector<studio::Light>& lights() { return lights_; }
    void moveLights() { lightsMoved_ = true; }
    CameraControl& camera() { return camera_; }
    CameraPath& path() { return path_; }
    float& time() { return time_; }
    bool& isPlaying() { return isPlaying_; }
    void askForScreenshot() { wantsScreenshot_ = true; }
    void writePath();
    bool truthFits() const;
    std::uint64_t copiedBytes() const { return inputs_.byteCount(); }
    int width() const { return width_; }
    int height() const { return height_; }
    std::size_t triangleCount() const { return meshes_.triangleCount(); }
    const Context& context() const { return context_; }

private:
    void resize();
    void advance(float seconds);
    void setTime();
    Eye eyeOfCamera() const;
    void placeLights();
    void drawScene();
    void lightIndirectly();
    void whileMapped();
    void drawFrame(bool isLast);
    void loadTruth();
    void saveScreenshot(const std::string& file);
    GLuint screen() const { return context_.window() != nullptr ? 0 : screenTarget_.get(); }
    void writeOutputs();

    Options options_;
    Context& context_;
    Look look_;
    std::shared_ptr<const studio::Scene> scene_;
    int cameraIndex_;
    std::unique_ptr<studio::RayScene> rayScene_;  // at time_: for fitting RSMs and for triangles
    studio::SceneTriangles triangles_;
    glm::vec3 lower_{0.0f}, upper_{0.0f};  // the scene's bounds, m
    std::vector<studio::Light> lights_;
    bool lightsMoved_ = true, hasMotion_ = false;
    SceneMeshes meshes_;
    GBufferPass gbuffer_;
    LightPasses lightPasses_;
    DirectPass direct_;
    std::vector<LightMaps> maps_;
    FrameInputs inputs_;
    IndirectImages light_;
    Indirect indirect_;
    Compose compose_;
    Texture screenImage_;
    Framebuffer screenTarget_;
    CameraControl camera_;
    CameraPath path_;
    Eye eye_, eyeBefore_, eyeOfFit_;
    Poses poses_, posesBefore_;
    Timings timings_;
    std::vector<IndirectFigures> indirectFrames_;  // measured ones
    std::vector<LWDebugView> debugViews_;
    std::vector<LWInputFinding> findings_;
    std::string message_, notice_;
    float time_ = 0.0f, timeOfScene_ = 0.0f;
    bool isPlaying_ = false, wantsCheck_ = false, wantsScreenshot_ = false, isFirst_ = true;
    int width_ = 0, height_ = 0, screenshotCount_ = 0;
    glm::ivec2 truthSize_{0};
};

}  // namespace viewer
