// The errors that docs/accuracy.md defines. RGB: every mean and percentile runs over pixels and channels
// alike, as if each channel were a sample of its own.
#include "metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "false_colour.h"
#include "flip.h"
#include "ssim.h"

namespace studio {
namespace {

constexpr std::array<const char*, 3> kRgb{"R", "G", "B"};
constexpr double kFloor = 0.01;  // of mean(R)^2 in relMSE's denominator
constexpr double kPercentile = 0.99;

bool hasLayer(const Image& image, const std::string& prefix) {
    return image.has(prefix + "R") || image.has(prefix + "G") || image.has(prefix + "B");
}

bool isFinite(float value) {
    return std::isfinite(value);
}

// Throws when `image` lacks a channel of these layers ("" = R,G,B) or one holds a NaN or an infinity.
void checkLayers(const Image& image, const std::string& role, const std::vector<std::string>& prefixes) {
    std::vector<bool> bad(image.pixelCount(), false);
    std::string badChannels;
    for (const std::string& prefix : prefixes)
        for (const char* colour : kRgb) {
            const std::string name = prefix + colour;
            if (!image.has(name))
                throw std::runtime_error(role + ": " + "missing channel " + name +
                                         "; expected R,G,B (irradiance), direct.*, albedo.*");
            const std::vector<float>& plane = image.plane(name);
            if (plane.size() != image.pixelCount())
                throw std::runtime_error(fmt::format("{}: channel {} has {} values, expected {}", role,
                                                     name, plane.size(), image.pixelCount()));
            if (std::all_of(plane.begin(), plane.end(), isFinite)) continue;
            badChannels += (badChannels.empty() ? "" : ", ") + name;
            for (std::size_t i = 0; i < plane.size(); ++i) bad[i] = bad[i] || !isFinite(plane[i]);
        }
    if (!badChannels.empty())
        throw std::runtime_error(fmt::format("{}: {} of {} pixels hold NaN or infinity, in {}", role,
                                             std::count(bad.begin(), bad.end(), true), bad.size(),
                                             badChannels));
}

void checkInputs(const Image& image, const Image& reference) {
    if (image.width != reference.width || image.height != reference.height)
        throw std::runtime_error(fmt::format("sizes differ: image {}x{}, reference {}x{}", image.width,
                                             image.height, reference.width, reference.height));
    for (const auto& [candidate, role] :
         {std::pair{&image, "image"}, std::pair{&reference, "reference"}})
        if (candidate->metadata.count(kDisplayReferredKey) != 0)
            throw std::runtime_error(
                std::string(role) + ": expected scene-linear layers (EXR), got a display picture (PNG)");
    checkLayers(reference, "reference", {"", "direct.", "albedo."});
    std::vector<std::string> layers{""};
    for (const char* layer : {"direct.", "albedo."})
        if (hasLayer(image, layer)) layers.push_back(layer);
    checkLayers(image, "image", layers);
}

// The image with the layers that a composite needs, taken from the reference where it has none.
Image withShading(const Image& image, const Image& reference) {
    Image complete(image.width, image.height);
    for (const char* colour : kRgb) complete.channels[colour] = image.plane(colour);
    for (const char* layer : {"direct.", "albedo."})
        for (const char* colour : kRgb) {
            const std::string name = std::string(layer) + colour;
            complete.channels[name] = (hasLayer(image, layer) ? image : reference).plane(name);
        }
    return complete;
}

// True where any of these channels, those that exist, isn't 0.
void markNonZero(const Image& image, const std::vector<std::string>& names, std::vector<bool>& mark) {
    for (const std::string& name : names) {
        if (!image.has(name)) continue;
        const std::vector<float>& plane = image.plane(name);
        for (std::size_t i = 0; i < mark.size(); ++i) mark[i] = mark[i] || plane[i] != 0.0f;
    }
}

// Pixels that show a surface in either image: a normal that isn't zero; where neither image stores
// normals, any light at all.
std::vector<bool> surfacePixels(const Image& image, const Image& reference) {
    const std::vector<std::string> normals{"normal.X", "normal.Y", "normal.Z",
                                           "normal.R", "normal.G", "normal.B"};
    const std::vector<std::string> light{"R", "G", "B", "direct.R", "direct.G", "direct.B"};
    const auto hasNormals = [&](const Image& candidate) {
        return std::any_of(normals.begin(), normals.end(),
                           [&](const auto& name) { return candidate.has(name); });
    };
    const bool useNormals = hasNormals(image) || hasNormals(reference);
    std::vector<bool> surface(image.pixelCount(), false);
    for (const Image* candidate : {&image, &reference})
        markNonZero(*candidate, useNormals ? normals : light, surface);
    return surface;
}

double meanOf(const Image& image, const std::vector<bool>& counted) {
    double sum = 0.0;
    for (const char* colour : kRgb) {
        const std::vector<float>& plane = image.plane(colour);
        for (std::size_t i = 0; i < plane.size(); ++i) sum += counted[i] ? double(plane[i]) : 0.0;
    }
    return sum / (3.0 * double(std::count(counted.begin(), counted.end(), true)));
}

// relMSE's term: squared difference over the squared reference, with a floor where it is dark.
double relativeTerm(double difference, double reference, double mean) {
    return difference * difference / (reference * reference + kFloor * mean * mean);
}

// Smallest value that at least `share` of the values don't exceed (nearest rank).
double percentile(std::vector<double> values, double share) {
    const auto rank = std::ptrdiff_t(std::ceil(share * double(values.size()))) - 1;
    std::nth_element(values.begin(), values.begin() + rank, values.end());
    return values[std::size_t(rank)];
}

// The HDR metrics; `relativeError`: square root of the term's mean over channels, 0 where not counted.
void compareIrradiance(const Image& image, const Image& reference, const std::vector<bool>& counted,
                       double mean, Metrics& metrics, std::vector<float>& relativeError) {
    double squares = 0.0, differences = 0.0, terms = 0.0;
    std::vector<double> roots;
    std::vector<double> pixelTerms(image.pixelCount(), 0.0);
    for (const char* colour : kRgb) {
        const std::vector<float>&f = image.plane(colour), &r = reference.plane(colour);
        for (std::size_t i = 0; i < f.size(); ++i) {
            if (!counted[i]) continue;
            const double difference = double(f[i]) - double(r[i]);
            const double term = relativeTerm(difference, double(r[i]), mean);
            squares += difference * difference;
            differences += difference;
            terms += term;
            roots.push_back(std::sqrt(term));
            pixelTerms[i] += term / 3.0;
        }
    }
    const double count = double(roots.size());
    metrics.relMse = terms / count;
    metrics.nrmse = std::sqrt(squares / count) / mean;
    metrics.bias = differences / count / mean;
    metrics.p99 = percentile(std::move(roots), kPercentile);
    relativeError.resize(pixelTerms.size());
    for (std::size_t i = 0; i < pixelTerms.size(); ++i)
        relativeError[i] = float(std::sqrt(pixelTerms[i]));
}

Image encoded(Image display) {
    for (auto& channel : display.channels)
        for (float& value : channel.second) value = srgbEncode(value);
    return display;
}

double rootMeanSquare(const Image& a, const Image& b) {
    double sum = 0.0;
    for (const char* colour : kRgb) {
        const std::vector<float>&x = a.plane(colour), &y = b.plane(colour);
        for (std::size_t i = 0; i < x.size(); ++i)
            sum += (double(x[i]) - double(y[i])) * (double(x[i]) - double(y[i]));
    }
    return std::sqrt(sum / (3.0 * double(a.pixelCount())));
}

double meanOf(const std::vector<float>& values) {
    double sum = 0.0;
    for (float value : values) sum += double(value);
    return sum / double(values.size());
}

// "bounce1+bounce2" to the prefixes of one half: "a.bounce1.", "a.bounce2.".
std::vector<std::string> halfPrefixes(const std::string& half, const std::string& layers) {
    std::vector<std::string> prefixes;
    for (std::size_t from = 0; from <= layers.size();) {
        const std::size_t to = std::min(layers.find('+', from), layers.size());
        prefixes.push_back(half + "." + layers.substr(from, to - from) + ".");
        from = to + 1;
    }
    return prefixes;
}

// R,G,B of one half: the sum of its layers.
Image sumLayers(const Image& image, const std::vector<std::string>& prefixes) {
    Image sum(image.width, image.height);
    for (const char* colour : kRgb) {
        std::vector<float>& to = sum.plane(colour);
        for (const std::string& prefix : prefixes) {
            const std::vector<float>& from = image.plane(prefix + colour);
            for (std::size_t i = 0; i < to.size(); ++i) to[i] += from[i];
        }
    }
    return sum;
}

// The reference is the mean of two independent halves a and b, so its variance is that of (a - b) / 2.
double halvesNoise(const Image& reference, const std::string& layers, const std::vector<bool>& counted,
                   double mean) {
    checkLayers(reference, "reference", halfPrefixes("a", layers));
    checkLayers(reference, "reference", halfPrefixes("b", layers));
    const Image a = sumLayers(reference, halfPrefixes("a", layers)),
                b = sumLayers(reference, halfPrefixes("b", layers));
    double terms = 0.0;
    std::size_t count = 0;
    for (const char* colour : kRgb) {
        const std::vector<float>&x = a.plane(colour), &y = b.plane(colour), &r = reference.plane(colour);
        for (std::size_t i = 0; i < r.size(); ++i) {
            if (!counted[i]) continue;
            terms += relativeTerm(0.5 * (double(x[i]) - double(y[i])), double(r[i]), mean);
            ++count;
        }
    }
    return terms / double(count);
}

// Estimated relMSE of the reference; negative when it stores neither halves nor an estimate.
double referenceNoise(const Image& reference, const std::vector<bool>& counted, double mean) {
    const auto layer = reference.metadata.find("layer");
    if (layer == reference.metadata.end()) return -1.0;
    if (hasLayer(reference, halfPrefixes("a", layer->second).front()))
        return halvesNoise(reference, layer->second, counted, mean);
    const auto stored = reference.metadata.find("noise." + layer->second);
    if (stored == reference.metadata.end()) return -1.0;
    char* end = nullptr;
    const double noise = std::strtod(stored->second.c_str(), &end);
    if (end == stored->second.c_str() || *end != '\0' || !(noise >= 0.0))
        throw std::runtime_error(
            fmt::format("reference: metadata {}: expected a number of at least 0, got \"{}\"",
                        stored->first, stored->second));
    return noise;
}

}  // namespace

namespace {

// All that is judged on the linear irradiance; `relativeError` as compareIrradiance makes it.
Metrics judgeIrradiance(const Image& image, const Image& reference, std::vector<float>& relativeError) {
    checkInputs(image, reference);
    const std::vector<bool> counted = surfacePixels(image, reference);
    if (std::find(counted.begin(), counted.end(), true) == counted.end())
        throw std::runtime_error("no pixel shows a surface in image or reference: nothing to compare");
    const double mean = meanOf(reference, counted);
    if (!(mean > 0.0))
        throw std::runtime_error(fmt::format(
            "reference: mean irradiance is {}: errors relative to it have no meaning", mean));

    Metrics metrics;
    compareIrradiance(image, reference, counted, mean, metrics, relativeError);
    metrics.referenceNoise = referenceNoise(reference, counted, mean);
    return metrics;
}

}  // namespace

Metrics compareIrradiance(const Image& image, const Image& reference) {
    std::vector<float> relativeError;
    return judgeIrradiance(image, reference, relativeError);
}

Metrics compareImages(const Image& image, const Image& reference, MetricMaps* maps) {
    std::vector<float> relativeError;
    Metrics metrics = judgeIrradiance(image, reference, relativeError);

    const Image truth = composite(reference);
    const float exposure = autoExposure(truth);
    const Image display = toneMap(composite(withShading(image, reference)), exposure);
    const Image displayTruth = toneMap(truth, exposure);
    const Image screen = encoded(display), screenTruth = encoded(displayTruth);
    metrics.rmse = rootMeanSquare(screen, screenTruth);
    SsimResult ssim = compareSsim(screen, screenTruth);
    metrics.ssim = ssim.ssim;
    metrics.score = ssim.score;
    metrics.score255 = ssim.score255;
    const std::vector<float> flip = flipMap(display, displayTruth);
    metrics.flip = meanOf(flip);

    if (maps != nullptr) {
        for (float& value : ssim.map) value = 1.0f - value;
        maps->relativeError = falseColour(relativeError, image.width, image.height);
        maps->ssim = falseColour(ssim.map, image.width, image.height);
        maps->flip = falseColour(flip, image.width, image.height);
    }
    return metrics;
}

}  // namespace studio
