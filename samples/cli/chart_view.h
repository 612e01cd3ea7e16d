// One view of a scene as a chart needs it: what techniques get, and the truths to judge them by.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cli.h"
#include "pixel_picks.h"
#include "reference_cache.h"
#include "render_inputs.h"

namespace cli {

struct TruthOptions {
    int block = 1;              // irradiance is judged at one pixel of each block x block; 1: at all
    double noise = 1e-3;        // relMSE at the judged pixels
    double pictureNoise = 0.0;  // of whole pictures, where the judged pixels are fewer; 0: none are made
    double seconds = 0.0;       // for each view, 0: no limit
    bool onScreen = false;      // one bounce from what the view shows, too
    bool takesShipped = false;  // shipped one-bounce references where they fit
    bool takesKept = false;     // those in the cache, whatever their noise
    std::string directory;      // of the cache
    std::function<void(double fraction, double noise)> progress;
};

struct JudgedTruth {
    Truth truth;                 // at the view's judged pixels
    std::optional<Truth> whole;  // of every pixel, where the judged ones are fewer
    const Truth& picture() const { return whole ? *whole : truth; }
    bool isShipped = false;
    bool isBlack = false;   // no light: errors relative to it have no meaning
    float exposure = 1.0f;  // of its composite
};

class ChartView {
public:
    ChartView(std::shared_ptr<studio::RayScene> scene, const studio::Camera& camera,
              const InputOptions& options);

    const std::string& sceneName() const { return scene_->scene().name; }
    const std::string& cameraName() const { return camera_; }
    std::string id() const { return sceneName() + "/" + camera_; }
    std::string hash() const;  // of scene, view and size
    const RenderInputs& inputs() const { return inputs_; }

    // Traces or loads the truths of these counts of bounces, with the layers that a comparison needs.
    void obtainTruths(const std::set<int>& bounces, const TruthOptions& options);
    // One bounce from surfaces that the view shows, at the judged pixels; null: not asked for.
    const JudgedTruth* onScreen() const { return onScreen_ ? &*onScreen_ : nullptr; }
    const std::map<int, JudgedTruth>& truths() const { return truths_; }
    bool isBlack() const;  // in all its truths
    const PixelPicks& picks() const { return *picks_; }  // since obtainTruths: the judged pixels
    // Irradiance with the layers of this view, for comparisons and composites.
    studio::Image withLayers(const studio::PlanarBuffer& irradiance) const;

private:
    bool loadShipped(JudgedTruth& truth) const;
    void addTruth(JudgedTruth judged);
    void complete(JudgedTruth& judged) const;
    void traceOnScreen(const TruthOptions& options);
    std::vector<Truth> trace(const studio::GBuffer& gbuffer, const std::vector<int>& bounces,
                             const TruthOptions& options, double noise, bool onScreen = false) const;
    void addLayers(studio::Image& image) const;

    std::shared_ptr<studio::RayScene> scene_;
    std::string camera_;
    RenderInputs inputs_;
    std::map<int, JudgedTruth> truths_;  // by bounces
    std::optional<JudgedTruth> onScreen_;
    std::optional<PixelPicks> picks_;
};

// The names of all scenes that are found.
std::vector<std::string> sceneNames();
// UsageError for names that are none, paths that lead nowhere, and two files of one name: at once, not after hours with the
// scenes before them.
void requireScenes(const std::vector<std::string>& scenes);
// --size, or else `standard`. UsageError also where the machine has not the memory for one view.
Size chartedSize(const std::string& text, const std::string& standard);

// What commands are told of their truths: --noise ("": `standardNoise`) and --truth-seconds. UsageError
// where one is no number, or not in its range.
void setTruthLimits(TruthOptions& truth, const std::string& noise, double standardNoise,
                    const std::string& seconds);

// --judge-one-of (0: not given): one pixel of 4 x 4, every one in quick runs and small pictures. UsageError where too few
// pixels would be left.
int judgedBlock(int asked, const Size& size, bool isQuick);

// Cameras that keyframes don't move; of those the first alone, or all.
std::vector<std::size_t> stillCameras(const studio::Scene& scene, bool firstOnly);

// "one bounce", "2 bounces", "all bounces".
std::string bouncesText(int bounces);

}  // namespace cli
