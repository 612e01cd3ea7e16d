// Changes a view's light evenly from what it showed last to something else, followed from surface to surface.
// kernels/cross_fade derives it.
//
//     CrossFade fade(device);                                        // the technique's
//     FadedView view(device, maxWidth, maxHeight);                   // a view's
//     update:  view.startFrame(frame.reset != 0 || lost);
//     render:  fade.record(executor, images, camera, 1.0f, view);    // the last frame before: keeps what it shows
//              fade.record(executor, images, camera, 1.0f / k, view) // then k, k - 1, .. 1
//              view.forget();                                        // or: this frame is shown without being kept
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "compute/report.h"
#include "inputs/camera.h"
#include "lightwell/lightwell.h"

namespace lightwell {

// Images of one frame, all of the position's size.
struct FadeFrame {
    Planes position, normal;
    Planes motion;                            // GBufferInput::motion; empty: by the cameras alone
    Planes irradiance, validity;              // the new ones, W/m^2; one may be empty, and then so is what is shown of it
    Planes shownIrradiance, shownValidity;
};

// The last picture of one view, at that view's largest size.
class FadedView {
public:
    FadedView(Device& device, std::uint32_t maxWidth, std::uint32_t maxHeight);

    // Once per update of the technique. `forget`: a cut, or commands that were lost on the device.
    void startFrame(bool forget);
    // Before a frame that is not recorded here: the next has nothing to begin from.
    void forget();
    bool isKept() const { return drawn_[last_].camera.has_value(); }
    // Of the last record: the count "fade_new", surfaces that took the new light at once; 0 where share was 1, when all do.
    void report(Device& device, Report& report) const;
    static std::uint64_t estimateBytes(std::uint32_t maxWidth, std::uint32_t maxHeight);
    std::uint64_t bytes() const { return images_[0].bytes() + images_[1].bytes() + counts_.bytes(); }

private:
    friend class CrossFade;
    Planes planes(std::size_t which, std::uint32_t width, std::uint32_t height) const;

    std::array<Buffer, 2> images_;
    Buffer counts_;
    struct Drawn {
        std::uint32_t width = 0, height = 0;
        bool hasIrradiance = false, hasValidity = false;
        LWCamera matrices{};
        std::optional<Camera> camera;  // none: nothing to begin from
        WorldOrigin origin{};          // of its positions
    };
    std::array<Drawn, 2> drawn_;
    std::size_t last_ = 0;       // image of the last record
    bool isDrawn_ = false;       // since the last update
    std::uint32_t updates_ = 0;  // since the last record
    std::uint32_t records_ = 0;  // so far
    std::uint32_t lead_ = 0;     // from the image that the last record read to it, in updates
};

class CrossFade {
public:
    explicit CrossFade(Device& device);

    // Pass "cross_fade.mix". `camera`: gbuffer.camera, which must be one. share: of the new light, above 0 to 1.
    void record(Executor& executor, const FadeFrame& frame, const LWCamera& camera, float share, FadedView& view);

private:
    Kernel& mix_;
};

}  // namespace lightwell
