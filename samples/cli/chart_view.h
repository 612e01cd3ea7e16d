// One view of a scene as a chart needs it: what techniques get, and the truths to judge them by.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "pixel_picks.h"
#include "reference_cache.h"
#include "render_inputs.h"

namespace cli {

struct TruthOptions {
    int block = 1;              // irradiance is judged at one pixel of each block x block; 1: at all
    double noise = 1e-3;        // relMSE at the judged pixels
    double pictureNoise = 0.0;  // of whole pictures, where the judged pixels are fewer; 0: none are made
    double seconds = 0.0;       // for each view, 0: no limit
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
    const std::map<int, JudgedTruth>& truths() const { return truths_; }
    bool isBlack() const;  // in all its truths
    const PixelPicks& picks() const { return *picks_; }  // since obtainTruths: the judged pixels
    // Irradiance with the layers of this view, for comparisons and composites.
    studio::Image withLayers(const studio::PlanarBuffer& irradiance) const;

private:
    bool loadShipped(JudgedTruth& truth) const;
    void addTruth(JudgedTruth judged);
    std::vector<Truth> trace(const studio::GBuffer& gbuffer, const std::vector<int>& bounces,
                             const TruthOptions& options, double noise) const;
    void addLayers(studio::Image& image) const;

    std::shared_ptr<studio::RayScene> scene_;
    std::string camera_;
    RenderInputs inputs_;
    std::map<int, JudgedTruth> truths_;  // by bounces
    std::optional<PixelPicks> picks_;
};

// Cameras that keyframes don't move; of those the first alone, or all.
std::vector<std::size_t> stillCameras(const studio::Scene& scene, bool firstOnly);

// "one bounce", "2 bounces", "all bounces".
std::string bouncesText(int bounces);

}  // namespace cli
