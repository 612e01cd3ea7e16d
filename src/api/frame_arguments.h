// Copies of what a host describes per frame, at our struct sizes and with every count and number
// checked.
#pragma once

#include <cstdint>
#include <vector>

#include "lightwell/lightwell.h"
#include "techniques/technique.h"

namespace lightwell {

class Call;

// An LWSync; null where the host gave none.
class SyncArgument {
public:
    SyncArgument(const LWSync* from, void* clContext, const char* name);
    const LWSync* get() const { return given_ ? &sync_ : nullptr; }

private:
    LWSync sync_{};
    bool given_ = false;
};

// An LWFrame with all that it points to, pixels and plain arrays excepted.
class FrameArgument {
public:
    FrameArgument(Call& call, const LWFrame* from);
    FrameArgument(const FrameArgument&) = delete;
    FrameArgument& operator=(const FrameArgument&) = delete;
    const LWFrame& get() const { return frame_; }

private:
    void copyLights();
    void copySourceViews(Call& call);
    void checkNumbers() const;

    LWFrame frame_{};
    std::vector<LWLight> lights_;
    std::vector<std::vector<LWRsm>> rsms_;
    std::vector<LWSourceView> sourceViews_;
    std::vector<LWGBuffer> sourceGBuffers_;
    LWGeometry geometry_{};
};

// What lwRenderPoints is asked for; images are the technique's to check.
class PointsArgument {
public:
    PointsArgument(const LWImage* positions, const LWImage* normals, std::uint32_t count, const LWPointOutput* output);
    const Points& get() const { return points_; }

private:
    Points points_;
};

}  // namespace lightwell
