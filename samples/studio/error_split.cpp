#include "error_split.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace studio {
namespace {

constexpr const char* kChannels[] = {"R", "G", "B"};
constexpr double kDarkShare = 0.01;  // of the squared mean, as in relMSE (metrics.h)

}  // namespace

ErrorSplitter::ErrorSplitter(const Image& own, const Image& all)
    : width_(own.width), height_(own.height) {
    for (std::size_t i = 0; i < own.pixelCount(); ++i)
        if (std::any_of(std::begin(kChannels), std::end(kChannels), [&](const char* channel) {
                return own.plane(std::string("normal.") + channel)[i] != 0.0f;
            }))
            pixels_.push_back(i);
    own_ = flatten(own);
    all_ = flatten(all);
    double mean = 0.0;
    for (const double value : all_) mean += value / double(all_.size());
    if (!(mean > 0.0)) throw std::runtime_error("the truth is black: no share has a meaning");
    for (const double value : all_)
        inverseWeight_.push_back(1.0 / (value * value + kDarkShare * mean * mean));
    sum_.assign(own_.size(), 0.0);
    sumOfSquares_.assign(own_.size(), 0.0);
}

std::vector<double> ErrorSplitter::flatten(const Image& image) const {
    if (image.width != width_ || image.height != height_)
        throw std::runtime_error(fmt::format("expected pictures of {}x{} pixels, got {}x{}", width_,
                                             height_, image.width, image.height));
    std::vector<double> values;
    values.reserve(3 * pixels_.size());
    for (const char* channel : kChannels) {
        const std::vector<float>& plane = image.plane(channel);
        for (const std::size_t pixel : pixels_) {
            if (!std::isfinite(plane[pixel]))
                throw std::runtime_error(
                    fmt::format("channel {}, pixel {}: expected a finite irradiance, got {}", channel,
                                pixel, plane[pixel]));
            values.push_back(double(plane[pixel]));
        }
    }
    return values;
}

double ErrorSplitter::error(const std::vector<double>& picture, const std::vector<double>& truth) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < picture.size(); ++i) {
        const double difference = picture[i] - truth[i];
        sum += difference * difference * inverseWeight_[i];
    }
    return sum / double(picture.size());
}

void ErrorSplitter::add(const Image& rendered, const Image& fullResolution,
                        const Image& exactVisibility) {
    const std::vector<double> picture = flatten(rendered), visible = flatten(exactVisibility);
    total_ += error(picture, all_);
    modelled_ += error(picture, own_);
    full_ += error(flatten(fullResolution), own_);
    visible_ += error(visible, own_);
    for (std::size_t i = 0; i < visible.size(); ++i) {
        sum_[i] += visible[i];
        sumOfSquares_[i] += visible[i] * visible[i];
    }
    ++patterns_;
}

ErrorSplit ErrorSplitter::result() const {
    if (patterns_ == 0) throw std::logic_error("error split: no picture was added");
    const double n = patterns_;
    ErrorSplit split;
    split.total = total_ / n;
    split.model = (total_ - modelled_) / n;
    split.resolution = (modelled_ - full_) / n;
    split.visibility = (full_ - visible_) / n;
    split.bounding = visible_ / n;
    if (patterns_ < 2) return split;
    double variance = 0.0;
    for (std::size_t i = 0; i < sum_.size(); ++i)
        variance += std::max(0.0, sumOfSquares_[i] - sum_[i] * sum_[i] / n) / (n - 1.0) *
                    inverseWeight_[i] / double(sum_.size());
    split.sampling = variance;
    split.bounding -= variance;
    return split;
}

}  // namespace studio
