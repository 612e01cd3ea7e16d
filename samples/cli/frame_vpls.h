// Static VPLs and blockers of a file (--set vpls_file=FILE) in a frame of the library.
#pragma once

#include <string>
#include <vector>

#include "render_inputs.h"
#include "static_vpls.h"

namespace cli {

class FrameVpls {
public:
    FrameVpls() = default;  // none
    // Reads it, in the inputs' unit of length; std::runtime_error as of readStaticVpls.
    FrameVpls(const std::string& file, const RenderInputs& inputs);

    // Without a file: placed as `lightwell place-vpls` does by default, or with a --cap, from the lamps,
    // or from where the camera is. None, with a word to the user, where that cannot be.
    FrameVpls(const RenderInputs& inputs, std::uint32_t cap);  // cap 0: the default

    // Where the scene's objects are in this frame; `frame` points to what this keeps. Masks: a VPL whose
    // receiverMask has bit 0 lights what has no baked light, with bit 1 what has.
    void fill(const RenderInputs& inputs, LWFrame& frame);

private:
    studio::StaticVpls source_;
    std::vector<LWStaticVpl> vpls_;
    std::vector<LWBlocker> blockers_;
};

}  // namespace cli
