// Devices shared by a test process, buffers with canaries, comparisons.
#include "support/kernel_rig.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <sstream>

#include "compute/error.h"
#include "support/test_device.h"

namespace lightwell::test {
namespace {

constexpr unsigned char kPattern = 0xA5;
constexpr std::size_t kCanaryBytes = 4096;  // several rows of the widest work-item

constexpr std::uint32_t kSmallWidth = 35, kSmallHeight = 5;

bool isSlow(const Device& device) {
    LWDeviceInfo info{};
    device.describe(info);
    return std::strstr(info.name, "Oclgrind") || std::strstr(info.platform, "rusticl");
}

std::size_t canaryBytes(const Device& device) {
    LWDeviceInfo info{};
    device.describe(info);
    return std::strstr(info.name, "Oclgrind") ? 0 : kCanaryBytes;
}

}  // namespace

Device& sharedDevice(std::uint32_t width) {
    // Leaked on purpose: some OpenCL drivers are gone before static destructors run.
    static auto& devices = *new std::map<std::uint32_t, Device*>;
    Device*& device = devices[width];
    if (!device) {
        LWDeviceDesc desc{};
        desc.structSize = sizeof desc;
        desc.width = width;
        device = new Device(desc);
        addTestPrograms(*device);
    }
    return *device;
}

std::pair<std::uint32_t, std::uint32_t> testSize(std::pair<std::uint32_t, std::uint32_t> size) {
    if (!isSlow(sharedDevice(1))) return size;
    return {std::min(size.first, kSmallWidth), std::min(size.second, kSmallHeight)};
}

KernelRig::KernelRig(std::uint32_t width) : device_(sharedDevice(width)), executor_(device_, profile_) {}

KernelRig::~KernelRig() {
    try {
        checkCanaries();
    } catch (const Error& error) {
        FAIL_CHECK("the device failed before the canaries could be read: " << error.what());
    }
}

Guarded KernelRig::allocate(std::size_t bytes) {
    const std::size_t whole = (bytes + canaryBytes(device_) + 3) / 4 * 4;
    Buffer memory(device_, whole, "test buffer");
    executor_.fill("test.fill", memory, 0x01010101u * kPattern, 0, whole);
    watched_.push_back({Buffer::retained(device_, memory.get()), bytes});
    return Guarded(std::move(memory), bytes);
}

void KernelRig::write(const Guarded& to, const void* from, std::size_t bytes) {
    if (bytes) executor_.write("test.write", to, 0, bytes, from);
    device_.finish();
}

void KernelRig::read(cl_mem from, std::size_t byteOffset, std::size_t bytes, void* to) {
    if (bytes) executor_.read("test.read", from, byteOffset, bytes, to);
    device_.finish();
}

void KernelRig::checkCanaries() {
    device_.finish();
    for (std::size_t i = 0; i < watched_.size(); ++i) {
        const Watched& watched = watched_[i];
        std::vector<unsigned char> canary(watched.memory.bytes() - watched.dataBytes);
        read(watched.memory.get(), watched.dataBytes, canary.size(), canary.data());
        std::size_t damaged = 0;
        while (damaged < canary.size() && canary[damaged] == kPattern) ++damaged;
        if (damaged < canary.size())
            FAIL_CHECK("buffer " << i << " of " << watched.dataBytes << " bytes was written " << damaged
                                 << " bytes past its end at width " << width());
    }
}

Planes KernelRig::planes(const Guarded& buffer, std::uint32_t width, std::uint32_t height,
                         std::uint32_t count) const {
    Planes planes;
    planes.memory = buffer.get();
    planes.rowStride = paddedWidth(width);
    planes.planeStride = planes.rowStride * height;
    planes.width = width;
    planes.height = height;
    planes.count = count;
    return planes;
}

Guarded KernelRig::makePlanes(std::uint32_t width, std::uint32_t height, std::uint32_t count) {
    return make<float>(std::size_t(paddedWidth(width)) * height * count);
}

Guarded KernelRig::uploadPlanes(const std::vector<float>& packed, std::uint32_t width,
                                std::uint32_t height, std::uint32_t count, float padding) {
    const std::size_t rows = std::size_t(height) * count, stride = paddedWidth(width);
    REQUIRE(packed.size() == rows * width);
    std::vector<float> padded(rows * stride, padding);
    for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t x = 0; x < width; ++x) padded[row * stride + x] = packed[row * width + x];
    return upload(padded);
}

std::vector<float> KernelRig::downloadPlanes(const Planes& planes) {
    const std::size_t rows = std::size_t(planes.height) * planes.count;
    std::vector<float> packed(rows * planes.width);
    for (std::size_t plane = 0; plane < planes.count; ++plane)
        for (std::size_t y = 0; y < planes.height; ++y) {
            const std::int64_t first = planes.offset + std::int64_t(plane) * planes.planeStride +
                                       std::int64_t(y) * planes.rowStride;
            executor_.read("test.read", planes.memory, std::size_t(first) * sizeof(float),
                           planes.width * sizeof(float),
                           &packed[(plane * planes.height + y) * planes.width]);
        }
    device_.finish();
    return packed;
}

std::string disagreement(const std::vector<float>& actual, const std::vector<float>& expected,
                         double relative, double share) {
    std::ostringstream text;
    text.precision(9);
    if (actual.size() != expected.size()) {
        text << actual.size() << " values, expected " << expected.size();
        return text.str();
    }
    double mean = 0.0;
    for (float value : expected) mean += std::fabs(double(value));
    mean /= expected.empty() ? 1.0 : double(expected.size());
    std::size_t wrong = 0, worst = 0;
    double worstExcess = 0.0;
    for (std::size_t i = 0; i < actual.size(); ++i) {
        const double limit = relative * (std::fabs(double(expected[i])) + mean);
        const double error = std::fabs(double(actual[i]) - double(expected[i]));
        if (error <= limit) continue;
        ++wrong;
        const double excess = std::isfinite(error) ? error - limit : HUGE_VAL;
        if (wrong == 1 || excess > worstExcess) {
            worst = i;
            worstExcess = excess;
        }
    }
    if (double(wrong) <= share * double(actual.size())) return {};
    text << wrong << " of " << actual.size() << " values differ by more than " << relative
         << " of themselves and their mean (allowed: " << share * double(actual.size())
         << "); worst: value " << worst << " is " << actual[worst] << ", expected " << expected[worst];
    return text.str();
}

std::string bitDifference(const std::vector<float>& actual, const std::vector<float>& expected) {
    std::ostringstream text;
    text.precision(9);
    if (actual.size() != expected.size()) {
        text << actual.size() << " values, expected " << expected.size();
        return text.str();
    }
    for (std::size_t i = 0; i < actual.size(); ++i)
        if (std::memcmp(&actual[i], &expected[i], sizeof(float)) != 0) {
            text << "value " << i << " is " << actual[i] << ", expected the same bits as "
                 << expected[i];
            return text.str();
        }
    return {};
}

}  // namespace lightwell::test
