// Truths of sequences' frames: what one trace gives at once is what traces of their own give.
#include <catch2/catch.hpp>
#include <filesystem>

#include <fmt/format.h>
#include <unistd.h>

#include "lit_points.h"
#include "path_tracer.h"
#include "sequence.h"
#include "stability_truth.h"

using namespace studio;
namespace fs = std::filesystem;

TEST_CASE("a truth of two bounces brings that of one along, to the bit") {
    const fs::path folder = fs::temp_directory_path() / fmt::format("lw_truth_{}", getpid());
    const SequenceFrame frame = makeSequence("light_sweep_slow", {2, 24, 14}).frames[1];
    const RayScene scene(frame.scene, frame.time);
    const GBuffer view = renderGBuffer(scene, frame.camera, 24, 14, frame.camera, frame.time);
    const auto guide = makeGuide(scene, view);
    cli::SequenceTruths::Request request;
    request.samples = 16;
    request.guide = guide.get();
    cli::SequenceTruths one((folder / "alone").string());
    const auto alone = one.obtain(scene, view, request);

    cli::SequenceTruths two((folder / "together").string());
    request.bounces = 2;
    request.keepsFirstBounce = true;
    const auto both = two.obtain(scene, view, request);
    request.bounces = 1;
    const auto along = two.obtain(scene, view, request);
    CHECK(two.tracedCount() == 1);
    CHECK(along->first == alone->first);
    CHECK(along->second == alone->second);
    CHECK(both->first != along->first);
    fs::remove_all(folder);
}
