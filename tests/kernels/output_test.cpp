// Results in every format and layout: values against the planes they came from, and no byte outside the
// pixels touched.
#include "inputs/output_target.h"

#include <array>
#include <catch2/catch.hpp>
#include <random>

#include "compute/error.h"
#include "support/host_image.h"
#include "support/kernel_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

// Stands for a technique: writes `values` (planes of w * h) into the target's planes, in whole groups of
// 16 pixels as kernels do.
void produce(KernelRig& rig, const Planes& planes, const std::vector<float>& values) {
    const Buffer memory = Buffer::retained(rig.device(), planes.memory);
    std::vector<float> row(paddedWidth(planes.width), -7.0f);
    for (std::uint32_t c = 0; c < planes.count; ++c)
        for (std::uint32_t y = 0; y < planes.height; ++y) {
            const float* from = values.data() + (c * planes.height + y) * planes.width;
            std::copy(from, from + planes.width, row.begin());
            const std::int64_t at = planes.offset + c * planes.planeStride + y * planes.rowStride;
            rig.executor().write("test.produce", memory, std::size_t(at) * 4, row.size() * 4,
                                 row.data());
            rig.device().finish();
        }
}

// One round trip per width, format and layout.
void checkFormats(const std::array<std::uint32_t, 2>& size) {
    const auto width = GENERATE(1u, 16u);
    const auto format = GENERATE(LW_FORMAT_FLOAT1, LW_FORMAT_FLOAT3, LW_FORMAT_FLOAT4, LW_FORMAT_HALF4,
                                 LW_FORMAT_PLANAR_FLOAT3);
    const auto layout =
        GENERATE(HostLayout{}, HostLayout{20, 0, 64, false, false}, HostLayout{0, 8, 4, true, false},
                 HostLayout{0, 0, 0, false, true}, HostLayout{0, 0, 128, true, true});
    KernelRig rig(width);
    const std::uint32_t count = format == LW_FORMAT_FLOAT1 ? 1 : 3;
    HostImage image(format, size[0], size[1], layout);
    std::vector<float> values(std::size_t(size[0]) * size[1] * count);
    std::mt19937 random(11);
    std::uniform_real_distribution<float> exponent(-26.0f, 17.0f);
    for (float& v : values) v = std::exp2(exponent(random));  // half's subnormals to its infinity
    View view(size[0] + 3, size[1] + 2);
    view.width = size[0];
    view.height = size[1];
    OutputTarget target;
    const Planes planes = target.begin(rig.executor(), view, image.image(), count, "output.irradiance");
    REQUIRE(planes.count == count);
    produce(rig, planes, values);
    target.end(rig.executor());
    rig.device().finish();

    int wrong = 0;
    for (std::uint32_t y = 0; y < size[1]; ++y)
        for (std::uint32_t x = 0; x < size[0]; ++x) {
            for (std::uint32_t c = 0; c < count; ++c) {
                const double v = double(values[(c * size[1] + y) * size[0] + x]);
                const double expected = format == LW_FORMAT_HALF4 ? fromHalf(toHalf(v)) : v;
                if (image.value(x, y, int(c)) != expected) ++wrong;
            }
            if (format == LW_FORMAT_FLOAT4 && image.value(x, y, 3) != 1.0) ++wrong;
            if (format == LW_FORMAT_HALF4 && image.value(x, y, 3) != 1.0) ++wrong;
        }
    CAPTURE(width, size[0], size[1], int(format), layout.rowGap, layout.pixelGap, layout.bottomUp,
            layout.aligned);
    CHECK(wrong == 0);
    const bool inPlace =
        layout.aligned && (format == LW_FORMAT_FLOAT1 || format == LW_FORMAT_PLANAR_FLOAT3);
    CHECK(image.damagedBytes(inPlace) == 0);
}

}  // namespace

TEST_CASE("results are packed into every format and layout", "[output]") {
    checkFormats({16, 3});
}
TEST_CASE("one pixel is packed into every format and layout", "[output]") {
    checkFormats({1, 1});
}
TEST_CASE("an image of odd size is packed into every format and layout", "[output][large]") {
    checkFormats({257, 89});
}

TEST_CASE("halves are rounded to nearest even", "[output]") {
    // Checks the test's own conversion against known codes of IEEE 754 binary16.
    CHECK(toHalf(1.0) == 0x3c00);
    CHECK(toHalf(1.0 + 1.0 / 2048) == 0x3c00);  // a tie, to even
    CHECK(toHalf(1.0 + 3.0 / 2048) == 0x3c02);
    CHECK(toHalf(65504.0) == 0x7bff);
    CHECK(toHalf(65520.0) == 0x7c00);
    CHECK(toHalf(std::ldexp(1.0, -24)) == 0x0001);
    CHECK(toHalf(std::ldexp(1.0, -14)) == 0x0400);
    CHECK(fromHalf(0x3555) == Approx(0.33325195));
}

TEST_CASE("planar results on 64-byte borders are written in place", "[output]") {
    KernelRig rig(GENERATE(1u, 16u));
    if (!rig.device().unifiedMemory()) return;
    HostLayout layout;
    layout.aligned = true;
    HostImage image(LW_FORMAT_PLANAR_FLOAT3, 20, 4, layout);
    OutputTarget target;
    target.begin(rig.executor(), View(20, 4), image.image(), 3, "output.irradiance");
    target.end(rig.executor());
    rig.device().finish();
    CHECK(target.bytes() == 0);
    for (const LWPassTime& pass : rig.profile().passes())
        CHECK(std::string(pass.name) == "output.publish");
}

TEST_CASE("results go to device memory", "[output]") {
    KernelRig rig(GENERATE(1u, 16u));
    const bool planar = GENERATE(false, true);
    constexpr std::uint32_t w = 20, h = 3;
    const std::uint32_t row = planar ? 32 : 20 * 4;  // floats
    const Guarded memory = rig.make<float>(planar ? row * h * 3 : row * h);
    LWImage image{};
    image.clMem = memory.get();
    image.format = planar ? LW_FORMAT_PLANAR_FLOAT3 : LW_FORMAT_FLOAT4;
    image.width = w;
    image.height = h;
    image.byteRowStride = row * 4;
    std::vector<float> values(w * h * 3);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = float(i);
    OutputTarget target;
    const Planes planes = target.begin(rig.executor(), View(w, h), image, 3, "output.irradiance");
    CHECK((planes.memory == memory.get()) == planar);
    produce(rig, planes, values);
    target.end(rig.executor());
    const auto result = rig.download<float>(memory);
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x < w; ++x)
            for (std::uint32_t c = 0; c < 3; ++c)
                REQUIRE(result[planar ? (c * h + y) * row + x : y * row + 4 * x + c] ==
                        values[(c * h + y) * w + x]);
}

TEST_CASE("formats that can't hold irradiance are refused", "[output]") {
    KernelRig rig(16);
    HostImage image(LW_FORMAT_FLOAT4, 8, 8);
    OutputTarget target;
    using Catch::Matchers::Contains;
    for (const LWFormat format :
         {LW_FORMAT_UNORM8X4, LW_FORMAT_UNORM8X4_SRGB, LW_FORMAT_OCT16X2, LW_FORMAT_UINT8,
          LW_FORMAT_FLOAT1, LW_FORMAT_FLOAT2, LW_FORMAT_PLANAR_FLOAT2}) {
        LWImage bad = image.image();
        bad.format = format;
        bad.bytePixelStride = bad.byteRowStride = 0;
        CHECK_THROWS_WITH(target.begin(rig.executor(), View(8, 8), bad, 3, "output.irradiance"),
                          Contains("output.irradiance.format: expected one of LW_FORMAT_FLOAT3"));
    }
    CHECK_FALSE(target.begin(rig.executor(), View(8, 8), LWImage{}, 3, "output.irradiance"));
    CHECK_THROWS_WITH(target.begin(rig.executor(), View(8, 7), image.image(), 3, "output.irradiance"),
                      Contains("8 x 7"));
}
