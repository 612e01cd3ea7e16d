#include "pixel_picks.h"

#include <cstdint>

#include "sampler.h"

namespace cli {
namespace {

// Where block i of `count` along a side of `length` begins.
int startOf(int i, int count, int length) {
    return int(std::int64_t(i) * length / count);
}

}  // namespace

PixelPicks::PixelPicks(int width, int height, int block)
    : wholeWidth_(width),
      wholeHeight_(height),
      block_(block),
      width_((width + block - 1) / block),
      height_((height + block - 1) / block) {
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
            const int left = startOf(x, width_, width), top = startOf(y, height_, height),
                      columns = startOf(x + 1, width_, width) - left,
                      rows = startOf(y + 1, height_, height) - top;
            const auto place = int(studio::mixBits(std::uint64_t(y) << 32 | std::uint64_t(x)) %
                                   std::uint64_t(columns * rows));
            pixels_.push_back(std::size_t(top + place / columns) * std::size_t(width) +
                              std::size_t(left + place % columns));
        }
}

std::size_t PixelPicks::pixel(int x, int y) const {
    return pixels_[std::size_t(y) * std::size_t(width_) + std::size_t(x)];
}

studio::Image PixelPicks::pick(const studio::Image& image) const {
    studio::Image picked(width_, height_);
    picked.metadata = image.metadata;
    for (const auto& [name, from] : image.channels) {
        std::vector<float>& to = picked.plane(name);
        for (std::size_t i = 0; i < pixels_.size(); ++i) to[i] = from[pixels_[i]];
    }
    return picked;
}

studio::GBuffer PixelPicks::pick(const studio::GBuffer& gbuffer) const {
    studio::GBuffer picked;
    picked.camera = gbuffer.camera;
    picked.previousCamera = gbuffer.previousCamera;
    picked.width = width_;
    picked.height = height_;
    using Member = studio::PlanarBuffer studio::GBuffer::*;
    for (const Member member : {&studio::GBuffer::position, &studio::GBuffer::normal,
                                &studio::GBuffer::albedo, &studio::GBuffer::direct}) {
        picked.*member = studio::PlanarBuffer(width_, height_, 3);
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x) {
                const std::size_t at = pixel(x, y);
                (picked.*member)
                    .setRgb(x, y,
                            (gbuffer.*member)
                                .rgb(int(at % std::size_t(wholeWidth_)),
                                     int(at / std::size_t(wholeWidth_))));
            }
    }
    return picked;
}

}  // namespace cli
