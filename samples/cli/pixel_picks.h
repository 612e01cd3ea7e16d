// One pixel of each block of a picture. The error of a picture's irradiance is a mean over its pixels:
// some of them, chosen evenly and blindly, tell it to a per cent or two, and the path tracer then has
// many times as long for each.
#pragma once

#include <cstddef>
#include <vector>

#include "gbuffer.h"
#include "image.h"

namespace cli {

class PixelPicks {
public:
    // Blocks of block x block pixels; where a side is no multiple of that, some of them are a pixel
    // shorter, evenly spread: a border of smaller ones would count several times. 1: every pixel. Which
    // pixel of its block is picked follows a hash, so that no pattern of the picture's own (an
    // interleaved gather has one) is met in step.
    PixelPicks(int width, int height, int block);

    bool areAll() const { return block_ == 1; }
    int block() const { return block_; }
    int width() const { return width_; }  // picks along a row: of the pictures that pick() makes
    int height() const { return height_; }
    std::size_t pixel(int x, int y) const;  // index in the whole picture

    // The picked pixels side by side: every channel and the metadata of an image; position, normal,
    // albedo and direct light of a G-buffer.
    studio::Image pick(const studio::Image& image) const;
    studio::GBuffer pick(const studio::GBuffer& gbuffer) const;

private:
    int wholeWidth_, wholeHeight_, block_, width_, height_;
    std::vector<std::size_t> pixels_;
};

}  // namespace cli
