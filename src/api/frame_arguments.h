// Copies of what a host describes per frame, at our struct sizes and with every count and number
// checked.
#pragma once

#include <vector>

#include "lightwell/lightwell.h"

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

}  // namespace lightwell
