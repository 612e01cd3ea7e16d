// Device memory: limits, counting, ownership, host memory in place, planar layouts.
#include <catch2/catch.hpp>
#include <utility>

#include "support/errors.h"
#include "support/kernel_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

cl_uint references(cl_mem memory) {
    cl_uint count = 0;
    clGetMemObjectInfo(memory, CL_MEM_REFERENCE_COUNT, sizeof count, &count, nullptr);
    return count;
}

}  // namespace

TEST_CASE("buffers count what they hold", "[buffer]") {
    Device& device = sharedDevice(1);
    const std::uint64_t before = device.allocatedBytes();
    {
        Buffer a(device, 1000, "a");
        CHECK(a.bytes() == 1000);
        CHECK(device.allocatedBytes() == before + 1000);
        Buffer b = std::move(a);
        CHECK_FALSE(a);
        CHECK(device.allocatedBytes() == before + 1000);
        b = Buffer(device, 24, "b");
        CHECK(device.allocatedBytes() == before + 24);
        Buffer c(device, 8, "c");
        std::swap(b, c);
        CHECK(b.bytes() == 8);
        CHECK(device.allocatedBytes() == before + 32);
    }
    CHECK(device.allocatedBytes() == before);
}

TEST_CASE("impossible buffers are refused with the byte counts", "[buffer]") {
    Device& device = sharedDevice(1);
    const std::uint64_t before = device.allocatedBytes();
    const std::uint64_t large = device.maxAllocation() + 1;
    const Thrown tooLarge = thrown([&] { Buffer(device, large, "voxels"); });
    CHECK(tooLarge.status == LW_ERROR_OUT_OF_MEMORY);
    CHECK(tooLarge.says("voxels"));
    CHECK(tooLarge.says(std::to_string(large)));
    CHECK(tooLarge.says(std::to_string(device.maxAllocation())));
    CHECK(thrown([&] { Buffer(device, 0, "nothing"); }).status == LW_ERROR_INTERNAL);

    // Together more than the device has: each piece alone would be allowed.
    std::vector<Buffer> held;
    Thrown together;
    const std::uint64_t piece = device.maxAllocation();
    for (std::uint64_t i = 0; i <= device.globalMemory() / piece && !together.status; ++i)
        together = thrown([&] { held.emplace_back(device, piece, "piece"); });
    CHECK(together.status == LW_ERROR_OUT_OF_MEMORY);
    held.clear();
    CHECK(device.allocatedBytes() == before);
}

TEST_CASE("reserve grows, never shrinks, and keeps the old memory when it fails", "[buffer]") {
    Device& device = sharedDevice(1);
    Buffer buffer;
    buffer.reserve(device, 100, "grown");
    CHECK(buffer.bytes() == 100);
    const cl_mem first = buffer.get();
    buffer.reserve(device, 50, "grown");
    CHECK(buffer.get() == first);
    CHECK(thrown([&] { buffer.reserve(device, device.maxAllocation() + 1, "grown"); }).status ==
          LW_ERROR_OUT_OF_MEMORY);
    CHECK(buffer.get() == first);
    CHECK(buffer.bytes() == 100);
    buffer.reserve(device, 200, "grown");
    CHECK(buffer.bytes() == 200);
}

TEST_CASE("foreign memory is referenced, not counted", "[buffer]") {
    Device& device = sharedDevice(1);
    const std::uint64_t before = device.allocatedBytes();
    cl_mem memory = clCreateBuffer(device.context(), CL_MEM_READ_WRITE, 256, nullptr, nullptr);
    REQUIRE(memory);
    {
        const Buffer buffer = Buffer::retained(device, memory);
        CHECK(buffer.bytes() == 256);
        CHECK(references(memory) == 2);
        CHECK(device.allocatedBytes() == before);
    }
    CHECK(references(memory) == 1);
    clReleaseMemObject(memory);
}

TEST_CASE("kernels work on host memory in place", "[buffer]") {
    KernelRig rig(1);
    alignas(64) static cl_int values[64];
    for (int i = 0; i < 64; ++i) values[i] = i;
    const Buffer buffer = Buffer::overHost(rig.device(), values, sizeof values, true);
    rig.executor().run("test.add", rig.kernel("executor_test", "add_one"), {64, 1}, {16, 1}, buffer,
                       cl_int(64));
    rig.executor().publish("test.publish", buffer);
    rig.device().finish();
    for (int i = 0; i < 64; ++i) CHECK(values[i] == i + 1);
    CHECK(thrown([&] { Buffer::overHost(rig.device(), nullptr, 64, true); }).status ==
          LW_ERROR_INTERNAL);
    CHECK(thrown([&] { Buffer::overHost(rig.device(), values, 0, true); }).status == LW_ERROR_INTERNAL);
}

TEST_CASE("planar images pad their rows and hold every smaller size", "[buffer]") {
    Device& device = sharedDevice(1);
    const PlanarImage image(device, 100, 30, 3, "image");
    CHECK(image.bytes() == 112u * 30 * 3 * 4);
    const Planes full = image.planes(100, 30);
    CHECK(full.rowStride == 112);
    CHECK(full.planeStride == 112 * 30);
    CHECK(full.count == 3);
    const Planes small = image.planes(17, 9);
    CHECK(small.memory == full.memory);
    CHECK(small.rowStride == 32);
    CHECK(small.planeStride == 32 * 9);
    CHECK(thrown([&] { image.planes(100, 31); }).status == LW_ERROR_INTERNAL);
    CHECK(thrown([&] { image.planes(113, 30); }).status == LW_ERROR_INTERNAL);
    CHECK_FALSE(PlanarImage());
}
