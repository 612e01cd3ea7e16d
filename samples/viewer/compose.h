// The picture: L = L_d + albedo / pi * E, tone-mapped as the studio does (Reinhard's L / (1 + L), exposure by the
// log-average luminance), and what else a frame can show instead.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "gbuffer_pass.h"
#include "host_images.h"

namespace viewer {

enum class Show { Picture, Direct, Indirect, Irradiance, Validity, Albedo, Normal, Depth, Motion, Check, Debug };
// For --show and the panel, in the enumeration's order.
const std::vector<std::string>& showNames();

struct Look {
    Show show = Show::Picture;
    float exposure = 1.0f;
    bool isAutomatic = true;      // the exposure is measured in each frame
    float split = 1.0f;           // share of the width left of which the technique shows, right of it the truth
    float debugScale = 1.0f;      // of a debug view's values
    int debugChannel = 0;         // the first of those shown
    float farthest = 10.0f;       // m, shown white as depth
};

class Compose {
public:
    Compose();
    // RGB floats, packed. A truth has the view's size, in W/m^2.
    void setTruth(int width, int height, const std::vector<float>& rgb);
    void dropTruth() { truth_ = Texture(); }
    bool hasTruth() const { return truth_.get() != 0; }
    // Of Show::Check (a picture of the view's size) and Show::Debug: planes.
    void setExtra(int width, int height, int channels, const std::vector<float>& planes);

    float measureExposure(const GBufferImages& images, const Texture& indirect);
    // Into `target`, the right way up.
    void draw(GLuint target, int width, int height, const GBufferImages& images, const Texture& indirect, const Look& look);

private:
    const Program& pictureOf(Show show);
    void bind(const Program& program, const GBufferImages& images, const Texture& indirect) const;
    Program brightness_;
    std::map<Show, Program> pictures_;  // compiled when first shown
    Texture truth_, extra_, grid_;
    Framebuffer gridTarget_;
    int extraChannels_ = 0;
    Texture nothing_, nothingLayered_;  // bound where there is none of the above
};

}  // namespace viewer
