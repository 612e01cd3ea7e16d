// Pictures of a sequence's worst frames.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "gbuffer.h"
#include "stability_judge.h"

namespace cli {

class SequencePictures {
public:
    // Remembers what a composite needs of the sequence's next frame.
    void addFrame(const studio::GBuffer& view);
    // PNGs "<folder>/images/<name>_picture.png", _truth, _error and all three side by side (_triptych),
    // at the exposure of the frame's truth. Returns their names below the folder.
    nlohmann::ordered_json write(const std::string& folder, const std::string& name, std::size_t frame,
                                 const JudgedFrame& judged) const;

private:
    struct Layers {
        int width = 0, height = 0;
        std::vector<float> albedo, direct;  // planes R,G,B
    };
    std::vector<Layers> frames_;
};

}  // namespace cli
