// `lightwell triptych`: direct light only | with Lightwell | path-traced truth, at one exposure.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>

#include "cli.h"
#include "image.h"
#include "layers.h"

namespace cli {
namespace {

constexpr int kGap = 4;  // white pixels between the panels

struct TriptychOptions {
    std::string render, reference, out;
    std::string exposure;
};

studio::Image withoutIndirect(studio::Image image) {
    for (const char* channel : {"R", "G", "B"})
        std::fill(image.plane(channel).begin(), image.plane(channel).end(), 0.0f);
    return image;
}

studio::Image sideBySide(const std::array<studio::Image, 3>& panels) {
    const int width = panels[0].width, height = panels[0].height;
    studio::Image row(3 * width + 2 * kGap, height);
    for (const char* channel : {"R", "G", "B"}) {
        std::vector<float>& plane = row.plane(channel);
        std::fill(plane.begin(), plane.end(), 1.0f);
        for (std::size_t i = 0; i < panels.size(); ++i)
            for (int y = 0; y < height; ++y) {
                const float* from = panels[i].plane(channel).data() + std::ptrdiff_t(y) * width;
                const std::ptrdiff_t column = std::ptrdiff_t(i) * (width + kGap);
                std::copy(from, from + width, plane.data() + std::ptrdiff_t(y) * row.width + column);
            }
    }
    return row;
}

void writeTriptych(const TriptychOptions& options) {
    requireOutputPath("--out", options.out, {".png"});
    const float given = options.exposure.empty() ? 0.0f : parsePositive("--exposure", options.exposure);
    const studio::Image render = asUsage([&] { return studio::readImage(options.render); });
    const studio::Image reference = asUsage([&] { return studio::readImage(options.reference); });
    if (render.width != reference.width || render.height != reference.height)
        throw UsageError(fmt::format("{} is {}x{} pixels, {} is {}x{}; expected one size",
                                     options.render, render.width, render.height, options.reference,
                                     reference.width, reference.height));
    const studio::Image truth = asUsage([&] { return shownRadiance(reference); });
    const studio::Image lit = asUsage([&] { return shownRadiance(render); });
    const float exposure = options.exposure.empty() ? studio::autoExposure(truth) : given;
    const std::array<studio::Image, 3> panels{
        studio::toneMap(studio::composite(withoutIndirect(render)), exposure),
        studio::toneMap(lit, exposure), studio::toneMap(truth, exposure)};
    studio::writePng(options.out, sideBySide(panels));
    fmt::print("{}: direct only | with Lightwell | truth, exposure {:.4g}\n", options.out, exposure);
}

}  // namespace

void addTriptych(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "triptych", "PNG of direct light only | with Lightwell | truth, at one exposure");
    auto options = std::make_shared<TriptychOptions>();
    command->add_option("RENDER", options->render, "EXR written by `lightwell render`")->required();
    command->add_option("REFERENCE", options->reference, "EXR written by `lightwell reference`")
        ->required();
    command->add_option("--out", options->out, "PNG to write")->required();
    command->add_option("--exposure", options->exposure,
                        "Factor on radiance before Reinhard's L/(1+L); default: puts the truth's "
                        "log-average luminance at 0.18");
    command->callback([options] { writeTriptych(*options); });
}

}  // namespace cli
