// `lightwell compare`: the errors of a picture against a reference (studio/metrics.h), and their maps.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli.h"
#include "image.h"
#include "metrics.h"

namespace cli {
namespace {

// A reference noisier than this share of the error does not measure the error any more.
constexpr double kNoiseShare = 0.1;

struct CompareOptions {
    std::string image, reference, maps;
    bool asJson = false;
};

void writeMaps(const std::string& directory, const studio::MetricMaps& maps) {
    const std::filesystem::path root(directory);
    studio::writePng((root / "relative_error.png").string(), maps.relativeError);
    studio::writePng((root / "ssim.png").string(), maps.ssim);
    studio::writePng((root / "flip.png").string(), maps.flip);
}

// JSON has no NaN and no "not stored": both are null.
nlohmann::ordered_json number(double value, bool isKnown = true) {
    if (!isKnown || !std::isfinite(value)) return nullptr;
    return value;
}

void printJson(const studio::Metrics& m) {
    nlohmann::ordered_json json;
    json["relMSE"] = number(m.relMse);
    json["nrmse"] = number(m.nrmse);
    json["bias"] = number(m.bias);
    json["p99"] = number(m.p99);
    json["rmse"] = number(m.rmse);
    json["ssim"] = number(m.ssim);
    json["score"] = number(m.score);
    json["score255"] = number(m.score255);
    json["flip"] = number(m.flip);
    json["reference_noise"] = number(m.referenceNoise, m.referenceNoise >= 0.0);
    fmt::print("{}\n", json.dump(2));
}

void printText(const studio::Metrics& m) {
    fmt::print("indirect irradiance (linear)\n");
    fmt::print("  {:<10} {:.6g}\n  {:<10} {:.5g}\n  {:<10} {:+.5g}\n  {:<10} {:.5g}\n", "relMSE",
               m.relMse, "nrmse", m.nrmse, "bias", m.bias, "p99", m.p99);
    fmt::print("composite (tone-mapped)\n");
    fmt::print(
        "  {:<10} {:.5f}\n  {:<10} {:.5f}\n  {:<10} {:.3f} of 10\n  {:<10} {:.3f} of 10\n  {:<10} "
        "{:.5f}\n",
        "rmse", m.rmse, "ssim", m.ssim, "score", m.score, "score255", m.score255, "flip", m.flip);
    if (m.referenceNoise >= 0.0)
        fmt::print("reference noise (relMSE) {:.3g}\n", m.referenceNoise);
    else
        fmt::print("reference noise unknown: the reference stores no halves\n");
}

void compare(const CompareOptions& options) {
    if (!options.maps.empty()) asUsage([&] { std::filesystem::create_directories(options.maps); });
    const studio::Image image = asUsage([&] { return studio::readImage(options.image); });
    const studio::Image reference = asUsage([&] { return studio::readImage(options.reference); });
    studio::MetricMaps maps;
    const studio::Metrics metrics = asUsage(
        [&] { return studio::compareImages(image, reference, options.maps.empty() ? nullptr : &maps); });
    if (!options.maps.empty()) writeMaps(options.maps, maps);
    if (options.asJson)
        printJson(metrics);
    else
        printText(metrics);
    if (metrics.referenceNoise > kNoiseShare * metrics.relMse)
        fmt::print(
            stderr,
            "note: the reference's own noise, relMSE {:.3g}, exceeds a tenth of the error, {:.3g}; "
            "trace it with more samples before trusting these figures\n",
            metrics.referenceNoise, metrics.relMse);
}

}  // namespace

void addCompare(CLI::App& app) {
    CLI::App* command = app.add_subcommand("compare", "Errors of a picture against a reference");
    auto options = std::make_shared<CompareOptions>();
    command->add_option("IMAGE", options->image, "EXR written by `lightwell render`")->required();
    command->add_option("REFERENCE", options->reference, "EXR written by `lightwell reference`")
        ->required();
    command->add_option("--maps", options->maps,
                        "Directory (made when missing) for relative_error.png, ssim.png, flip.png");
    command->add_flag(
        "--json", options->asJson,
        "JSON on stdout: relMSE nrmse bias p99 rmse ssim score score255 flip reference_noise "
        "(null: not stored in the reference)");
    command->callback([options] { compare(*options); });
}

}  // namespace cli
