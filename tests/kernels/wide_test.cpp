// The dialect's self-test: every form at every width against plain loops here, and whole kernels with
// the same bits at every width. Sizes are small, so that the suite also runs under Oclgrind.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "support/kernel_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr std::size_t kPixels = 64, kMargin = 16;  // margin: unaligned loads reach past the last pixel
constexpr const char* kProgram = "wide_test";
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::vector<float> randomFloats(unsigned seed, float low, float high) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(low, high);
    std::vector<float> values(kPixels + kMargin);
    for (float& v : values) v = value(random);
    return values;
}

std::vector<cl_int> randomInts(unsigned seed, int low, int high) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> value(low, high);
    std::vector<cl_int> values(kPixels + kMargin);
    for (cl_int& v : values) v = value(random);
    return values;
}

float asFloat(std::uint32_t bits) {
    float value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}
std::uint32_t asBits(float value) {
    std::uint32_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    return bits;
}

// Plane `index` of an output made of planes of kPixels.
template <class T>
std::vector<T> plane(const std::vector<T>& planes, std::size_t index) {
    const auto first = planes.begin() + std::ptrdiff_t(index * kPixels);
    return {first, first + std::ptrdiff_t(kPixels)};
}

// What `value(i)` gives for every pixel.
template <class T, class Value>
std::vector<T> forPixels(Value value) {
    std::vector<T> values;
    for (std::size_t i = 0; i < kPixels; ++i) values.push_back(T(value(i)));
    return values;
}

}  // namespace

TEST_CASE("memory forms at every width", "[wide]") {
    const auto width = GENERATE(1u, 4u, 8u, 16u);
    CAPTURE(width);
    KernelRig rig(width);
    const auto floats = randomFloats(1, -5.0f, 5.0f);
    const auto ints = randomInts(2, -100, 100);
    std::vector<cl_uchar> bytes(kPixels + kMargin);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = cl_uchar(i * 7);
    std::vector<cl_int> indices(kPixels);  // a permutation, as scatter needs
    for (std::size_t i = 0; i < kPixels; ++i) indices[i] = cl_int(i * 37 % kPixels);

    const Guarded out = rig.make<float>(8 * kPixels), outInts = rig.make<cl_int>(2 * kPixels);
    rig.run("test.memory", rig.kernel(kProgram, "wide_memory"), {kPixels / width, 1}, {1, 1},
            rig.upload(floats), rig.upload(ints), rig.upload(bytes), rig.upload(indices),
            cl_int(kPixels), out, outInts);
    const auto values = rig.download<float>(out);
    const auto integers = rig.download<cl_int>(outInts);
    const auto at = [&](std::size_t i) { return std::size_t(indices[i]); };
    CHECK(plane(values, 0) == forPixels<float>([&](std::size_t i) { return floats[i + 1]; }));
    CHECK(plane(values, 1) == forPixels<float>([&](std::size_t i) { return floats[at(i)]; }));
    CHECK(plane(values, 2) == forPixels<float>([&](std::size_t i) { return bytes[i + 3]; }));
    for (std::size_t i = 0; i < kPixels; ++i) CHECK(values[3 * kPixels + at(i)] == floats[i]);
    CHECK(plane(values, 4) == forPixels<float>([&](std::size_t i) { return floats[i + 1]; }));
    CHECK(plane(values, 5) == forPixels<float>([&](std::size_t i) { return floats[i]; }));
    for (std::size_t i = 0; i < kPixels; ++i) CHECK(values[6 * kPixels + 1 + i] == floats[i]);
    CHECK(plane(integers, 0) == forPixels<cl_int>([&](std::size_t i) { return ints[i + 3]; }));
    CHECK(plane(integers, 1) == forPixels<cl_int>([&](std::size_t i) { return ints[at(i)]; }));
}

TEST_CASE("mask forms at every width", "[wide]") {
    const auto width = GENERATE(1u, 4u, 8u, 16u);
    CAPTURE(width);
    KernelRig rig(width);
    auto xs = randomFloats(3, -1.0f, 1.0f), ys = randomFloats(4, -1.0f, 1.0f);
    auto ints = randomInts(5, -3, 3);
    xs[5] = kNaN, xs[17] = kInfinity, xs[33] = -kInfinity, ys[7] = xs[7];
    for (std::size_t i = 16; i < 32; ++i)
        xs[i] = i == 17 ? kInfinity : 2.0f;              // a group where none is less
    for (std::size_t i = 32; i < 48; ++i) ys[i] = 3.0f;  // and one where all are

    const std::size_t groups = kPixels / width;
    const Guarded out = rig.make<float>(12 * kPixels), outInts = rig.make<cl_int>(2 * kPixels);
    const Guarded whole = rig.make<cl_int>(4 * groups);
    rig.run("test.masks", rig.kernel(kProgram, "wide_masks"), {groups, 1}, {1, 1}, rig.upload(xs),
            rig.upload(ys), rig.upload(ints), cl_int(kPixels), out, outInts, whole);
    const auto values = rig.download<float>(out);
    const auto integers = rig.download<cl_int>(outInts), wholes = rig.download<cl_int>(whole);
    const auto less = [&](std::size_t i) { return xs[i] < ys[i]; };
    const auto even = [&](std::size_t i) { return (ints[i] & 1) == 0; };
    CHECK(plane(values, 0) == forPixels<float>(less));
    CHECK(plane(values, 1) == forPixels<float>([&](std::size_t i) { return !less(i); }));
    CHECK(plane(values, 2) == forPixels<float>(less));
    CHECK(plane(values, 3) == forPixels<float>([&](std::size_t i) { return less(i) && even(i); }));
    CHECK(plane(values, 4) == forPixels<float>([&](std::size_t i) { return less(i) || even(i); }));
    CHECK(plane(values, 5) == forPixels<float>([&](std::size_t i) { return less(i) && !even(i); }));
    CHECK(plane(values, 6) == forPixels<float>([&](std::size_t i) { return ints[i] != 0; }));
    CHECK(plane(values, 7) == forPixels<float>([&](std::size_t i) { return (ints[i] & 1023) != 0; }));
    CHECK(plane(values, 8) == forPixels<float>([](std::size_t) { return 1; }));
    CHECK(plane(values, 9) == forPixels<float>([](std::size_t) { return 0; }));
    CHECK(plane(values, 10) == forPixels<float>([&](std::size_t i) { return std::isfinite(xs[i]); }));
    CHECK(bitDifference(plane(values, 11),
                        forPixels<float>([&](std::size_t i) { return even(i) ? ys[i] : xs[i]; })) == "");
    CHECK(plane(integers, 0) ==
          forPixels<cl_int>([&](std::size_t i) { return less(i) ? -ints[i] : ints[i]; }));
    CHECK(plane(integers, 1) ==
          forPixels<cl_int>([&](std::size_t i) { return (ints[i] & 1023) + (less(i) ? 5 : 0); }));
    for (std::size_t group = 0; group < groups; ++group) {
        CAPTURE(group);
        int count = 0;
        cl_int bits = 0;
        for (std::size_t lane = 0; lane < width; ++lane) {
            count += less(group * width + lane);
            bits |= less(group * width + lane) << lane;
        }
        CHECK(wholes[4 * group] == (count > 0));
        CHECK(wholes[4 * group + 1] == (count == int(width)));
        CHECK(wholes[4 * group + 2] == count);
        CHECK(wholes[4 * group + 3] == bits);
    }
}

TEST_CASE("conversions at every width", "[wide]") {
    const auto width = GENERATE(1u, 4u, 8u, 16u);
    CAPTURE(width);
    KernelRig rig(width);
    const auto floats = randomFloats(6, -1000.0f, 1000.0f);
    const auto ints = randomInts(7, -(1 << 22), 1 << 22);
    const Guarded out = rig.make<float>(4 * kPixels), outInts = rig.make<cl_int>(2 * kPixels);
    rig.run("test.convert", rig.kernel(kProgram, "wide_convert"), {kPixels / width, 1}, {1, 1},
            rig.upload(floats), rig.upload(ints), cl_int(kPixels), out, outInts);
    const auto values = rig.download<float>(out);
    const auto integers = rig.download<cl_int>(outInts);
    CHECK(plane(values, 0) == forPixels<float>([&](std::size_t i) { return float(ints[i]); }));
    CHECK(plane(values, 1) ==
          forPixels<float>([&](std::size_t i) { return float(unsigned(std::fabs(floats[i]))); }));
    CHECK(bitDifference(plane(values, 2), forPixels<float>([&](std::size_t i) {
                            return asFloat(asBits(floats[i]) ^ std::uint32_t(ints[i]));
                        })) == "");
    CHECK(bitDifference(plane(values, 3),
                        forPixels<float>([&](std::size_t i) { return asFloat(asBits(floats[i]) >> 1); })) == "");
    CHECK(plane(integers, 0) == forPixels<cl_int>([&](std::size_t i) { return int(floats[i]); }));
    CHECK(plane(integers, 1) ==
          forPixels<cl_int>([&](std::size_t i) { return cl_int(asBits(floats[i])); }));
}

TEST_CASE("forms across lanes at every width", "[wide]") {
    const auto width = GENERATE(1u, 4u, 8u, 16u);
    CAPTURE(width);
    KernelRig rig(width);
    const auto floats = randomFloats(8, -9.0f, 9.0f);
    const auto ints = randomInts(9, -99, 99);
    const std::size_t groups = kPixels / (2 * width);
    const Guarded out = rig.make<float>(4 * kPixels), scalars = rig.make<float>(2 * groups);
    const Guarded outInts = rig.make<cl_int>(3 * groups);
    rig.run("test.lanes", rig.kernel(kProgram, "wide_lanes"), {groups, 1}, {1, 1}, rig.upload(floats),
            rig.upload(ints), cl_int(kPixels), out, scalars, outInts);
    const auto values = rig.download<float>(out), extremes = rig.download<float>(scalars);
    const auto integers = rig.download<cl_int>(outInts);
    // even_ is the first half of each group of 2 * width, odd_ the second; the zips restore the order.
    CHECK(plane(values, 0) == forPixels<float>([&](std::size_t i) {
              const std::size_t first = i / (2 * width) * (2 * width), within = i % (2 * width);
              return floats[first + 2 * (within % width) + within / width];
          }));
    CHECK(plane(values, 1) == forPixels<float>([&](std::size_t i) { return floats[i]; }));
    CHECK(plane(values, 2) == forPixels<float>([&](std::size_t i) { return i % width; }));
    // from_left_ and from_right_, both of the first half, whose ends have no neighbour there and stay.
    CHECK(plane(values, 3) == forPixels<float>([&](std::size_t i) {
              const std::size_t first = i / (2 * width) * (2 * width), lane = i % width;
              return floats[first + (i % (2 * width) < width ? std::max<std::size_t>(lane, 1) - 1 : std::min<std::size_t>(lane + 1, width - 1))];
          }));
    for (std::size_t group = 0; group < groups; ++group) {
        CAPTURE(group);
        const auto first = std::ptrdiff_t(2 * width * group), last = first + std::ptrdiff_t(width);
        CHECK(extremes[2 * group] == *std::min_element(floats.begin() + first, floats.begin() + last));
        CHECK(extremes[2 * group + 1] ==
              *std::max_element(floats.begin() + first, floats.begin() + last));
        CHECK(integers[3 * group] == *std::min_element(ints.begin() + first, ints.begin() + last));
        CHECK(integers[3 * group + 1] == *std::max_element(ints.begin() + first, ints.begin() + last));
        CHECK(integers[3 * group + 2] == ints[std::size_t(first)]);
    }
}

TEST_CASE("arithmetic forms at every width", "[wide]") {
    const auto width = GENERATE(1u, 4u, 8u, 16u);
    CAPTURE(width);
    KernelRig rig(width);
    const auto xs = randomFloats(10, -3.0f, 3.0f), ys = randomFloats(11, -3.0f, 3.0f),
               zs = randomFloats(12, -3.0f, 3.0f);
    const Guarded out = rig.make<float>(7 * kPixels), fused = rig.make<cl_int>(1);
    rig.run("test.arithmetic", rig.kernel(kProgram, "wide_arithmetic"), {kPixels / width, 1}, {1, 1},
            rig.upload(xs), rig.upload(ys), rig.upload(zs), cl_int(kPixels), out, fused);
    const auto values = rig.download<float>(out);
    const auto fma = [&](float a, float b, float c) {
        // Elsewhere mad() may or may not fuse: then both results are right, and 1e-6 covers the
        // difference.
        return std::fma(a, b, c);
    };
    const double tolerance = rig.download<cl_int>(fused)[0] ? 0.0 : 1e-6;
    CHECK(disagreement(plane(values, 0),
                       forPixels<float>([&](std::size_t i) { return fma(xs[i], ys[i], zs[i]); }),
                       tolerance) == "");
    CHECK(disagreement(plane(values, 1),
                       forPixels<float>([&](std::size_t i) { return fma(2.0f, xs[i], 1.0f); }),
                       tolerance) == "");
    // Contraction is off: a product is rounded before the sum. (volatile keeps this compiler from
    // fusing.)
    CHECK(bitDifference(plane(values, 2), forPixels<float>([&](std::size_t i) {
                            volatile float product = xs[i] * ys[i];
                            return product + zs[i];
                        })) == "");
    CHECK(bitDifference(plane(values, 3),
                        forPixels<float>([&](std::size_t i) { return xs[i] * xs[i]; })) == "");
    CHECK(plane(values, 4) ==
          forPixels<float>([&](std::size_t i) { return std::min(std::max(xs[i], ys[i]), 0.5f); }));
    // OpenCL allows sqrt 3 and division 2.5 units in the last place.
    CHECK(disagreement(plane(values, 5),
                       forPixels<float>([&](std::size_t i) { return std::sqrt(std::fabs(xs[i])); }),
                       4e-7) == "");
    CHECK(disagreement(plane(values, 6), forPixels<float>([&](std::size_t i) {
                           volatile float square = ys[i] * ys[i];
                           return xs[i] / (square + 0.5f);
                       }),
                       4e-7) == "");
}

TEST_CASE("raw operators on masks go wrong where the forms do not", "[wide]") {
    const auto width = GENERATE(1u, 4u, 8u, 16u);
    CAPTURE(width);
    KernelRig rig(width);
    const Guarded raw = rig.make<cl_int>(3), forms = rig.make<cl_int>(7);
    rig.run("test.traps", rig.kernel(kProgram, "wide_traps"), {1, 1}, {1, 1},
            rig.upload(randomFloats(13, 0.0f, 1.0f)), raw, forms);
    const bool vector = width > 1;
    // any() tests the sign bit, ~1 is still true, true converts to 1 or -1.
    CHECK(rig.download<cl_int>(raw) == std::vector<cl_int>{vector, !vector, vector ? -1 : 1});
    CHECK(rig.download<cl_int>(forms) == std::vector<cl_int>{1, 0, 1, 1, cl_int(width), 0,
                                                               cl_int(width * (width - 1) / 2) - 3 * cl_int(width)});
}

TEST_CASE("whole kernels give the same bits at every width", "[wide]") {
    constexpr int kLights = 12, kField = 256, kSteps = 40;
    const auto px = randomFloats(20, -2.0f, 2.0f), py = randomFloats(21, -2.0f, 2.0f);
    std::mt19937 random(22);
    std::uniform_real_distribution<float> value(0.05f, 1.0f);
    std::vector<float> lights(4 * kLights), field(kField);
    for (float& v : lights) v = value(random);
    for (float& v : field) v = value(random) * 0.3f;

    std::vector<float> gathered, marched, steps;
    for (const std::uint32_t width : {1u, 4u, 8u, 16u}) {
        CAPTURE(width);
        KernelRig rig(width);
        const Guarded x = rig.upload(px), y = rig.upload(py), f = rig.upload(field);
        const Guarded sum = rig.make<float>(kPixels), march = rig.make<float>(kPixels),
                      count = rig.make<float>(kPixels);
        const Range global{kPixels / width, 1};
        rig.run("test.gather", rig.kernel(kProgram, "wide_gather"), global, {1, 1}, x, y,
                rig.upload(lights), cl_int(kLights), f, cl_int(kField - 1), sum);
        rig.run("test.march", rig.kernel(kProgram, "wide_march"), global, {1, 1}, x, f,
                cl_int(kField - 1), cl_int(kSteps), march, count);
        if (width == 1) {
            gathered = rig.download<float>(sum);
            marched = rig.download<float>(march);
            steps = rig.download<float>(count);
            // The lanes really part: they leave the march at different steps.
            CHECK(*std::min_element(steps.begin(), steps.end()) + 2.0f <
                  *std::max_element(steps.begin(), steps.end()));
        }
        CHECK(bitDifference(rig.download<float>(sum), gathered) == "");
        CHECK(bitDifference(rig.download<float>(march), marched) == "");
        CHECK(bitDifference(rig.download<float>(count), steps) == "");
    }
}
