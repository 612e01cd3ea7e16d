// The skeleton of docs/adding-a-technique.md works: its sky gives pi * L on surfaces and nothing
// elsewhere.
#include <catch2/catch.hpp>
#include <vector>

#include "compute/device.h"
#include "skeleton/ambient_sky.h"
#include "support/kernel_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr std::uint32_t kWidth = 37, kHeight = 5;
constexpr float kTolerance = 1e-6f;  // one rounding of pi * L

LWImage interleaved(std::vector<float>& pixels) {
    LWImage image = {};
    image.host = pixels.data();
    image.format = LW_FORMAT_FLOAT3;
    image.width = kWidth;
    image.height = kHeight;
    return image;
}

}  // namespace

TEST_CASE("the skeleton technique lights surfaces with its sky", "[skeleton]") {
    const auto width = GENERATE(1u, 16u);
    Device& device = sharedDevice(width);
    AmbientSkyDesc desc;
    ambientSkyEntry().info.setDefaults(&desc);
    desc.gain = 2.0f;
    const auto technique = ambientSkyEntry().create(device, &desc);

    std::vector<float> position(3 * kWidth * kHeight, 1.0f), normal(3 * kWidth * kHeight, 0.0f);
    std::vector<float> irradiance(3 * kWidth * kHeight, -1000.0f);
    for (std::size_t i = 0; i < kWidth * kHeight; ++i) normal[3 * i + 1] = i % 3 == 0 ? 0.0f : 1.0f;
    LWFrame frame;
    LW_INIT(frame);
    for (std::size_t c = 0; c < 3; ++c) frame.environment[c] = float(c + 1);
    LWGBuffer gbuffer;
    LW_INIT(gbuffer);
    gbuffer.position = interleaved(position);
    gbuffer.normal = interleaved(normal);
    LWOutput output;
    LW_INIT(output);
    output.irradiance = interleaved(irradiance);

    Profile profile;
    Executor executor(device, profile);
    const auto view = std::make_shared<View>(kWidth, kHeight);
    technique->prewarm(executor, view);
    technique->update(executor, frame);
    technique->render(executor, view, gbuffer, output);
    device.finish();
    for (std::size_t i = 0; i < kWidth * kHeight; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const float expected = i % 3 == 0 ? 0.0f : 2.0f * 3.14159265f * float(c + 1);
            CAPTURE(width, i, c);
            CHECK(irradiance[3 * i + c] == Approx(expected).epsilon(kTolerance));
        }
}
