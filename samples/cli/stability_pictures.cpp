#include "stability_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "false_colour.h"
#include "layers.h"

namespace cli {
namespace {

constexpr int kGap = 4;  // white pixels between the panels
constexpr const char* kChannels[] = {"R", "G", "B"};

void setPlanes(studio::Image& image, const std::string& prefix, const std::vector<float>& planes) {
    const std::size_t count = image.pixelCount();
    for (std::size_t c = 0; c < 3; ++c)
        image.plane(prefix + kChannels[c])
            .assign(planes.begin() + std::ptrdiff_t(c * count),
                    planes.begin() + std::ptrdiff_t((c + 1) * count));
}

// Square root of relMSE's term, mean over the channels; where the truth has no light at all, any light
// is an error of 1.
studio::Image errorMap(const studio::StabilityFrame& frame, const std::vector<float>& truth) {
    const std::size_t count = frame.surface.size();
    double sum = 0.0, surfaces = 0.0;
    for (std::size_t i = 0; i < 3 * count; ++i)
        if (frame.surface[i % count] != 0) {
            sum += double(truth[i]);
            surfaces += 1.0;
        }
    const double mean = surfaces > 0.0 ? sum / surfaces : 0.0;
    std::vector<float> errors(count, 0.0f);
    for (std::size_t i = 0; i < 3 * count; ++i) {
        const double difference = double(frame.image[i]) - double(truth[i]);
        if (frame.surface[i % count] == 0 || difference == 0.0) continue;
        const double squared = difference * difference,
                     relative = double(truth[i]) * double(truth[i]) + 0.01 * mean * mean;
        errors[i % count] += float((relative > 0.0 ? std::sqrt(squared / relative) : 1.0) / 3.0);
    }
    return studio::falseColour(errors, frame.width, frame.height);
}

studio::Image sideBySide(const std::array<const studio::Image*, 3>& panels) {
    const int width = panels[0]->width, height = panels[0]->height;
    studio::Image row(3 * width + 2 * kGap, height);
    for (const char* channel : kChannels) {
        std::vector<float>& plane = row.plane(channel);
        std::fill(plane.begin(), plane.end(), 1.0f);
        for (std::size_t i = 0; i < panels.size(); ++i)
            for (int y = 0; y < height; ++y)
                std::copy_n(
                    panels[i]->plane(channel).data() + std::ptrdiff_t(y) * width, width,
                    plane.data() + std::ptrdiff_t(y) * row.width + std::ptrdiff_t(i) * (width + kGap));
    }
    return row;
}

}  // namespace

void SequencePictures::addFrame(const studio::GBuffer& view) {
    frames_.push_back({view.width, view.height, packedPlanes(view.albedo), packedPlanes(view.direct)});
}

nlohmann::ordered_json SequencePictures::write(const std::string& folder, const std::string& name,
                                               std::size_t frame, const JudgedFrame& judged) const {
    const Layers& layers = frames_[frame];
    studio::Image image(layers.width, layers.height);
    setPlanes(image, "direct.", layers.direct);
    setPlanes(image, "albedo.", layers.albedo);
    setPlanes(image, "", judged.truth->mean);
    const studio::Image trueLight = studio::composite(image);
    setPlanes(image, "", judged.frame.image);
    const float exposure = studio::autoExposure(trueLight);
    const studio::Image ours = studio::toneMap(studio::composite(image), exposure);
    const studio::Image truth = studio::toneMap(trueLight, exposure);
    const studio::Image error = errorMap(judged.frame, judged.truth->mean);

    std::string stem = name;  // of a variant that names a file (vpls_file) with its folders
    std::replace(stem.begin(), stem.end(), '/', '_');
    nlohmann::ordered_json names;
    const auto write = [&](const char* key, const studio::Image& picture) {
        const std::string file = "images/" + stem + "_" + key + ".png";
        studio::writePng((std::filesystem::path(folder) / file).string(), picture);
        names[key] = file;
    };
    write("picture", ours);
    write("truth", truth);
    write("error", error);
    write("triptych", sideBySide({&ours, &truth, &error}));
    return names;
}

}  // namespace cli
