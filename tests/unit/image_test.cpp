// Round trips of float images through EXR and PNG, and the display transform against values by hand.
#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <regex>
#include <string>

#include "image.h"

using Catch::Matchers::Contains;
using studio::Image;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A file name of this process, removed with its file at the end of the scope.
class ScratchFile {
public:
    explicit ScratchFile(const std::string& name)
        : path_((std::filesystem::temp_directory_path() /
                 ("lightwell_" + std::to_string(reinterpret_cast<std::uintptr_t>(this)) + "_" + name))
                    .string()) {}
    ~ScratchFile() { std::filesystem::remove(path_); }
    ScratchFile(const ScratchFile&) = delete;
    ScratchFile& operator=(const ScratchFile&) = delete;
    const std::string& path() const { return path_; }

private:
    std::string path_;
};

// Values over the whole range of half floats, both signs; sizes odd so that padding would show.
Image layeredImage() {
    Image image(37, 11);
    int k = 0;
    for (const char* name : {"R", "G", "B", "direct.R", "direct.G", "direct.B", "albedo.G", "normal.X",
                             "validity", "a.bounce1.R", "b.bounce1+bounce2.B"}) {
        std::vector<float>& plane = image.plane(name);
        for (std::size_t i = 0; i < plane.size(); ++i)
            plane[i] = std::ldexp(std::sin(float(++k)), int(i % 24) - 10);
    }
    return image;
}

Image constantImage(int width, int height, float r, float g, float b) {
    Image image(width, height);
    image.plane("R").assign(image.pixelCount(), r);
    image.plane("G").assign(image.pixelCount(), g);
    image.plane("B").assign(image.pixelCount(), b);
    return image;
}

}  // namespace

TEST_CASE("full-float EXR keeps every layer bit for bit, and the metadata") {
    const ScratchFile file("full.exr");
    Image image = layeredImage();
    image.plane("R")[3] = kInfinity;
    image.plane("R")[4] = 3e38f;
    image.metadata = {
        {"spp", "256"}, {"layer", "bounce1"}, {"noise.bounce1", "1.25e-05"}, {"camera", "main; 2"}};
    writeExr(file.path(), image);
    const Image back = studio::readImage(file.path());
    REQUIRE(back.width == 37);
    REQUIRE(back.height == 11);
    CHECK(back.channels == image.channels);
    CHECK(back.metadata == image.metadata);

    // Written again, nothing is added or lost.
    writeExr(file.path(), back);
    CHECK(studio::readImage(file.path()).metadata == image.metadata);
}

TEST_CASE("long names and text beyond ASCII survive") {
    const ScratchFile file("names.exr");
    Image image(3, 2);
    image.plane("a.bounce1+bounce2+bounce3.and.so.on.R")[5] = 2.0f;
    image.metadata = {{"a_key_longer_than_thirty_one_characters", "Küche; 2 = 1\n\"x\""}};
    writeExr(file.path(), image);
    const Image back = studio::readImage(file.path());
    CHECK(back.channels == image.channels);
    CHECK(back.metadata == image.metadata);
}

TEST_CASE("an EXR holds no time of writing: the same image gives the same bytes") {
    const ScratchFile file("bytes.exr");
    writeExr(file.path(), layeredImage());
    std::ifstream stream(file.path(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    REQUIRE(bytes.size() > 1000);
    CHECK_FALSE(std::regex_search(bytes, std::regex("[0-9]{4}:[0-9]{2}:[0-9]{2} ")));
}

TEST_CASE("half-float EXR keeps values to half precision") {
    // 11 significant bits: half a unit in the last place of normal numbers; below 2^-14 the spacing is
    // 2^-24.
    constexpr float kRelative = 1.0f / 2048.0f, kAbsolute = 0x1p-25f;
    const ScratchFile file("half.exr");
    const Image image = layeredImage();
    writeExr(file.path(), image, true);
    const Image back = studio::readImage(file.path());
    REQUIRE(back.channels.size() == image.channels.size());
    for (const auto& [name, values] : image.channels) {
        const std::vector<float>& read = back.plane(name);
        float worst = 0.0f;
        for (std::size_t i = 0; i < values.size(); ++i)
            worst = std::max(worst, std::abs(read[i] - values[i]) - kRelative * std::abs(values[i]));
        INFO(name);
        CHECK(worst <= kAbsolute);
    }
}

TEST_CASE("half-float EXR refuses what would become infinite") {
    const ScratchFile file("overflow.exr");
    Image image(2, 2);
    image.plane("position.X")[1] = 70000.0f;
    CHECK_THROWS_WITH(writeExr(file.path(), image, true), Contains("70000") && Contains("position.X"));
    CHECK_NOTHROW(writeExr(file.path(), image, false));
}

TEST_CASE("PNG keeps sRGB codes, read back as linear values") {
    // Half a code of 255, through the steepest slope of the decoding curve (2.4 / 1.055 at white).
    constexpr float kTolerance = 0.5f / 255.0f * 2.4f / 1.055f;
    const ScratchFile file("display.png");
    Image image(256, 2);
    for (int i = 0; i < 512; ++i) {
        image.plane("R")[std::size_t(i)] = float(i) / 511.0f;
        image.plane("G")[std::size_t(i)] = studio::srgbDecode(float(i % 256) / 255.0f);  // exact codes
        image.plane("B")[std::size_t(i)] = 1.0f - float(i) / 511.0f;
    }
    writePng(file.path(), image);
    const Image back = studio::readImage(file.path());
    REQUIRE(back.channels.size() == 3);
    for (std::size_t i = 0; i < 512; ++i) {
        CHECK(back.plane("R")[i] == Approx(image.plane("R")[i]).margin(kTolerance));
        CHECK(back.plane("G")[i] == Approx(image.plane("G")[i]).margin(1e-6));
        CHECK(back.plane("B")[i] == Approx(image.plane("B")[i]).margin(kTolerance));
    }
}

TEST_CASE("PNG refuses values that are not display values") {
    const ScratchFile file("bad.png");
    for (float bad : {1.001f, -0.001f, kNan, kInfinity}) {
        Image image = constantImage(3, 2, 0.5f, 0.5f, 0.5f);
        image.plane("G")[4] = bad;
        CHECK_THROWS_WITH(writePng(file.path(), image), Contains("(1, 1)") && Contains("in G"));
    }
    CHECK_FALSE(std::filesystem::exists(file.path()));
}

TEST_CASE("sRGB transfer function: known values and inverse") {
    CHECK(studio::srgbEncode(0.0f) == 0.0f);
    CHECK(studio::srgbEncode(1.0f) == Approx(1.0f));
    CHECK(studio::srgbEncode(0.214041f) == Approx(0.5f).epsilon(1e-5));  // IEC 61966-2-1, by calculator
    for (int i = 0; i <= 100; ++i)
        CHECK(studio::srgbDecode(studio::srgbEncode(float(i) / 100.0f)) ==
              Approx(float(i) / 100.0f).margin(1e-6));
}

TEST_CASE("file errors name the path and the reason") {
    const ScratchFile text("text.exr"), folder("nowhere");
    std::ofstream(text.path()) << "no picture";
    CHECK_THROWS_WITH(studio::readImage(text.path()), Contains(text.path()));
    CHECK_THROWS_WITH(studio::readImage(folder.path() + "/missing.exr"), Contains("missing.exr"));
    const Image image = constantImage(2, 2, 0.1f, 0.2f, 0.3f);
    CHECK_THROWS_WITH(writeExr(folder.path() + "/out.exr", image), Contains("nowhere/out.exr"));
    CHECK_THROWS_WITH(writePng(folder.path() + "/out.png", image), Contains("nowhere/out.png"));
    CHECK_THROWS_WITH(writeExr(text.path(), Image(0, 2)), Contains("0x2"));
    CHECK_THROWS_WITH(writeExr(text.path(), Image(2, 2)), Contains("no channels"));
    Image ragged = image;
    ragged.plane("G").resize(3);
    CHECK_THROWS_WITH(writeExr(text.path(), ragged), Contains("channel G has 3 values"));
    for (const char* key : {"compression", "owner", "dataWindow", "smpte:x", ""}) {
        Image clash = image;
        clash.metadata[key] = "mine";
        CHECK_THROWS_WITH(writeExr(text.path(), clash), Contains(std::string("\"") + key + "\""));
    }
}

TEST_CASE("a missing channel is named with those present") {
    const Image image = constantImage(2, 2, 0.0f, 0.0f, 0.0f);
    CHECK_THROWS_WITH(image.plane("direct.R"), Contains("direct.R") && Contains("B, G, R"));
    CHECK_THROWS_WITH(composite(image), Contains("direct.R"));
    const Image empty(1, 1);
    CHECK_THROWS_WITH(empty.plane("R"), Contains("none"));
}

TEST_CASE("composite adds reflected irradiance to direct radiance") {
    Image image = constantImage(2, 1, 3.14159265f, 6.2831853f, 0.0f);
    for (const char* name : {"R", "G", "B"}) {
        image.plane(std::string("direct.") + name).assign(2, 0.25f);
        image.plane(std::string("albedo.") + name).assign(2, 0.5f);
    }
    const Image radiance = composite(image);
    CHECK(radiance.plane("R")[0] == Approx(0.75f));
    CHECK(radiance.plane("G")[1] == Approx(1.25f));
    CHECK(radiance.plane("B")[1] == Approx(0.25f));
}

TEST_CASE("tone mapping: Reinhard's curve and its ends") {
    const Image mapped = toneMap(constantImage(1, 1, 0.5f, 1.5f, 0.0f), 2.0f);
    CHECK(mapped.plane("R")[0] == Approx(0.5f));
    CHECK(mapped.plane("G")[0] == Approx(0.75f));
    CHECK(mapped.plane("B")[0] == 0.0f);
    const Image ends = toneMap(constantImage(1, 1, -1.0f, kInfinity, kNan));
    CHECK(ends.plane("R")[0] == 0.0f);
    CHECK(ends.plane("G")[0] == 1.0f);
    CHECK(std::isnan(ends.plane("B")[0]));
    CHECK_THROWS_WITH(toneMap(ends, 0.0f), Contains("exposure"));
    CHECK_THROWS_WITH(toneMap(ends, kNan), Contains("exposure"));
}

TEST_CASE("automatic exposure brings the log-average luminance to 0.18") {
    CHECK(autoExposure(constantImage(4, 4, 0.36f, 0.36f, 0.36f)) == Approx(0.5f));
    Image two =
        constantImage(3, 1, 0.0f, 0.0f, 0.0f);  // luminances 0.1 and 10: geometric mean 1; black ignored
    for (const char* name : {"R", "G", "B"}) two.plane(name) = {0.1f, 0.0f, 10.0f};
    CHECK(autoExposure(two) == Approx(0.18f));
    CHECK(autoExposure(constantImage(2, 2, 0.0f, 0.0f, 0.0f)) == 1.0f);
    // No unit: a scene a thousand times as bright gives the same picture.
    for (const char* name : {"R", "G", "B"})
        for (float& value : two.plane(name)) value *= 1000.0f;
    CHECK(autoExposure(two) == Approx(0.18e-3f));
    two.plane("G")[1] = kNan;
    CHECK_THROWS_WITH(autoExposure(two), Contains("(1, 0)"));
}
