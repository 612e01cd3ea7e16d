// Frames in which nothing moves that a technique's update() is made of, as far as the host tells by versions.
#pragma once

#include <cstdint>

namespace lightwell {

class StillFrames {
public:
    // `settling`: updates of the same before one may be left out: what starts where the frame before left it gets there first.
    explicit StillFrames(std::uint32_t settling) : settling_(settling) {}

    // Of an update() made of light and geometry of these generations (0: not known), whether the `settling` before it were made of the
    // same. restart: nothing before it counts.
    bool note(std::uint64_t light, std::uint64_t geometry, bool restart) {
        const bool isSame = light != 0 && geometry != 0 && light == light_ && geometry == geometry_ && !restart;
        light_ = light;
        geometry_ = geometry;
        if (!isSame) made_ = 0;
        else if (made_ < settling_) ++made_;
        return made_ >= settling_;
    }

private:
    std::uint32_t settling_, made_ = 0;  // made_: updates in a row that were of what the one before them was
    std::uint64_t light_ = 0, geometry_ = 0;
};

}  // namespace lightwell
