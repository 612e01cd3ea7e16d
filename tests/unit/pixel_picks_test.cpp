// Pixels that stand for all: which they are, and that an error's mean over them is that over all.
#include "pixel_picks.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <set>

using cli::PixelPicks;

TEST_CASE("one pixel of every block, each place of a block as often as the others", "[pixel_picks]") {
    for (const int block : {1, 2, 4, 7}) {
        const PixelPicks picks(1260, 728, block);
        REQUIRE(picks.width() == 1260 / block);
        REQUIRE(picks.height() == 728 / block);
        std::vector<int> ofPlace(std::size_t(block * block), 0);
        for (int y = 0; y < picks.height(); ++y)
            for (int x = 0; x < picks.width(); ++x) {
                const int column = int(picks.pixel(x, y) % 1260), row = int(picks.pixel(x, y) / 1260);
                REQUIRE(column / block == x);
                REQUIRE(row / block == y);
                ++ofPlace[std::size_t(row % block * block + column % block)];
            }
        // Of binomial numbers none is off its mean by five standard deviations.
        const double mean = double(picks.width() * picks.height()) / (block * block);
        for (const int count : ofPlace) CHECK(std::abs(count - mean) <= 5.0 * std::sqrt(mean));
    }
}

TEST_CASE("where blocks do not divide a picture no border counts several times", "[pixel_picks]") {
    constexpr int kWidth = 1281, kHeight = 723;
    for (const int block : {2, 4, 7}) {
        const PixelPicks picks(kWidth, kHeight, block);
        REQUIRE(picks.width() == (kWidth + block - 1) / block);
        REQUIRE(picks.height() == (kHeight + block - 1) / block);
        // The columns and rows that blocks are found to reach: as many as a block has, or one less.
        std::vector<std::set<int>> columns(std::size_t(picks.width())),
            rows(std::size_t(picks.height()));
        for (int y = 0; y < picks.height(); ++y)
            for (int x = 0; x < picks.width(); ++x) {
                columns[std::size_t(x)].insert(int(picks.pixel(x, y) % kWidth));
                rows[std::size_t(y)].insert(int(picks.pixel(x, y) / kWidth));
            }
        for (const auto* all : {&columns, &rows}) {
            int last = -1;
            for (const std::set<int>& of : *all) {
                REQUIRE(*of.begin() == last + 1);  // no pixel out of reach, none in two blocks
                REQUIRE(int(of.size()) >= block - 1);
                REQUIRE(int(of.size()) <= block);
                last = *of.rbegin();
            }
            CHECK(last == (all == &columns ? kWidth : kHeight) - 1);
        }
    }
}

TEST_CASE("the picked pixels of images and G-buffers, side by side", "[pixel_picks]") {
    constexpr int kWidth = 18, kHeight = 10;
    const PixelPicks picks(kWidth, kHeight, 4);
    studio::Image image(kWidth, kHeight);
    image.metadata["layer"] = "bounce1";
    studio::GBuffer gbuffer;
    gbuffer.width = kWidth;
    gbuffer.height = kHeight;
    for (auto* plane : {&gbuffer.position, &gbuffer.normal, &gbuffer.albedo, &gbuffer.direct})
        *plane = studio::PlanarBuffer(kWidth, kHeight, 3);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            image.plane("R")[std::size_t(y * kWidth + x)] = float(y * kWidth + x);
            gbuffer.position.setRgb(x, y, {float(x), float(y), 1.0f});
            gbuffer.direct.setRgb(x, y, {0.0f, float(y * kWidth + x), 0.0f});
        }
    const studio::Image picked = picks.pick(image);
    const studio::GBuffer surfaces = picks.pick(gbuffer);
    REQUIRE(picked.width == 5);
    REQUIRE(surfaces.height == 3);
    CHECK(picked.metadata.at("layer") == "bounce1");
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 5; ++x) {
            const std::size_t pixel = picks.pixel(x, y);
            CHECK(picked.plane("R")[std::size_t(y * 5 + x)] == float(pixel));
            CHECK(surfaces.position.rgb(x, y) ==
                  glm::vec3(float(pixel % kWidth), float(pixel / kWidth), 1.0f));
            CHECK(surfaces.direct.rgb(x, y).y == float(pixel));
        }
}

TEST_CASE("a pattern in step with the blocks has its own mean among the picks", "[pixel_picks]") {
    // An interleaved picture: each pixel of 4 x 4 off by another amount, 0 on the mean.
    const PixelPicks picks(640, 360, 4);
    double sum = 0.0;
    for (int y = 0; y < picks.height(); ++y)
        for (int x = 0; x < picks.width(); ++x) {
            const std::size_t pixel = picks.pixel(x, y);
            sum += double(pixel / 640 % 4 * 4 + pixel % 4) - 7.5;
        }
    // The amounts' standard deviation is 4.6; five of those of the mean.
    CHECK(std::abs(sum / (picks.width() * picks.height())) <= 5.0 * 4.61 / std::sqrt(160.0 * 90.0));
}
