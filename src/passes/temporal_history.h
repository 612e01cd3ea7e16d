// Temporal history of what a technique makes of a view: the mean over frames, followed from surface to surface, for any
// technique whose samples differ from frame to frame. kernels/temporal_history derives it, docs/temporal_history.md explains it.
//
//     TemporalHistory history(device, options);                      // the technique's
//     ViewHistory view(device, options, maxWidth, maxHeight);        // a view's
//     update:  view.startFrame(frame.reset != 0 || lost);            // of every view, also those that are not rendered
//     render:  history.record(executor, {position, normal, motion, current, irradiance}, camera, view);
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "compute/report.h"
#include "inputs/camera.h"
#include "lightwell/lightwell.h"
#include "shared/history_types.h"

namespace lightwell {

struct TemporalHistoryOptions {
    std::uint32_t frames = 0;   // in the mean, at most 64; 0: no history
    float clamp = 3.0f;         // gamma of the bounds that a frame's picture sets to its history; 0: none
    std::uint32_t scalars = 0;  // 1-channel images beside the irradiance: 0, 1, 2

    static constexpr std::uint32_t kMostFrames = 64;
};

// Images of one frame, all of the position's size. `current` must be none of those written.
struct HistoryFrame {
    Planes position, normal;  // as the technique imports them
    Planes motion;            // GBufferInput::motion; empty: by the cameras alone, which is right for what does not move itself
    Planes current;           // 3 planes of irradiance, W/m^2, and the scalars
    Planes irradiance;        // the mean
    Planes first, second;     // those of the scalars; of as many as options.scalars says
};

// The history of one view, at that view's largest size: bytesPerPixel of memory, whatever the current size.
class ViewHistory {
public:
    ViewHistory(Device& device, const TemporalHistoryOptions& options, std::uint32_t maxWidth, std::uint32_t maxHeight);

    // Once per update of the technique. `forget`: a cut, or commands that were lost on the device.
    void startFrame(bool forget);
    // Before a record that nothing recorded before may enter.
    void forget();
    // Of the view's last record: the count "history_new", surfaces that started anew.
    void report(Device& device, Report& report) const;
    static std::uint64_t estimateBytes(const TemporalHistoryOptions& options, std::uint32_t maxWidth, std::uint32_t maxHeight);
    std::uint64_t bytes() const { return images_[0].bytes() + images_[1].bytes() + counts_.bytes(); }

private:
    friend class TemporalHistory;
    Planes planes(std::size_t which, std::uint32_t width, std::uint32_t height) const;

    std::uint32_t planes_;
    std::array<Buffer, 2> images_;
    Buffer counts_;
    // Of an image; without a camera there is nothing to look up.
    struct Drawn {
        std::uint32_t width = 0, height = 0;
        LWCamera matrices{};
        std::optional<Camera> camera;
        WorldOrigin origin{};  // of its positions
        bool isOf(const LWCamera& from, std::uint32_t w, std::uint32_t h) const;
    };
    std::array<Drawn, 2> drawn_;
    std::size_t last_ = 0;         // image of the last record
    bool isDrawn_ = false;         // since the last update
    std::uint32_t updates_ = 0;    // since the last record
    std::uint32_t lead_ = 0;       // from the image that the last record read to it, in updates
};

class TemporalHistory {
public:
    TemporalHistory(Device& device, const TemporalHistoryOptions& options);

    // Pass "temporal_history.blend". `camera`: gbuffer.camera, checked by checkCamera before anything was recorded.
    void record(Executor& executor, const HistoryFrame& frame, const LWCamera& camera, ViewHistory& view);
    // Throws INVALID_ARGUMENT naming gbuffer.camera where a history could not be followed through it.
    static void checkCamera(const LWGBuffer& gbuffer, std::uint32_t width, std::uint32_t height);

    // Debug view "history_age" as planes without memory, empty where the last frame left none, and what fills it.
    Planes ageShape(const ViewHistory& view) const;
    void recordAge(Executor& executor, const ViewHistory& view, const Planes& planes);

private:
    TemporalHistoryOptions options_;
    Kernel &blend_, &age_;
};

}  // namespace lightwell
