// Runs single kernels in tests: a device per width, guarded buffers, comparisons with stated tolerances.
//
//     const auto width = GENERATE(1u, 16u);
//     KernelRig rig(width);
//     const Guarded in = rig.upload(values), out = rig.make<float>(values.size());
//     rig.run("sum", rig.kernel("folder/program", "kernel"), {64 / width, 1}, {1, 1}, in, out);
//     CHECK(disagreement(rig.download<float>(out), expected) == "");
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "compute/buffer.h"
#include "compute/device.h"
#include "compute/executor.h"

namespace lightwell::test {

// The device that LIGHTWELL_DEVICE names, at this width; one per process and width, never destroyed
// before the process ends.
Device& sharedDevice(std::uint32_t width);

// Device memory followed by a canary: bytes of a pattern that no kernel may touch. (Oclgrind checks
// bounds itself, so there the buffer ends where it should.)
class Guarded : public Buffer {
public:
    std::size_t dataBytes() const { return dataBytes_; }

private:
    friend class KernelRig;
    Guarded(Buffer&& buffer, std::size_t dataBytes) : Buffer(std::move(buffer)), dataBytes_(dataBytes) {}
    std::size_t dataBytes_ = 0;
};

// An image's size, made small (still no multiple of a width) on slow drivers: Oclgrind, Rusticl.
std::pair<std::uint32_t, std::uint32_t> testSize(std::pair<std::uint32_t, std::uint32_t> size);

class KernelRig {
public:
    explicit KernelRig(std::uint32_t width);
    ~KernelRig();  // waits, then fails the test if a canary was touched

    Device& device() { return device_; }
    Executor& executor() { return executor_; }
    Profile& profile() { return profile_; }
    std::uint32_t width() const { return device_.width(); }

    Kernel& kernel(const std::string& program, const std::string& name, const Defines& defines = {}) {
        return device_.programs().kernel(program, name, defines);
    }
    // Executor::run, waiting for the end.
    template <class... Args>
    void run(const char* pass, Kernel& kernel, Range global, Range local, const Args&... args) {
        executor_.run(pass, kernel, global, local, args...);
        device_.finish();
    }

    // Every buffer is watched until the rig ends, also after the caller has dropped it. New memory is
    // filled with 0xA5 bytes: huge negative floats and integers, so that what was never written shows.
    template <class T>
    Guarded make(std::size_t count) {
        return allocate(count * sizeof(T));
    }
    template <class T>
    Guarded upload(const std::vector<T>& values) {
        Guarded buffer = allocate(values.size() * sizeof(T));
        write(buffer, values.data(), values.size() * sizeof(T));
        return buffer;
    }
    template <class T>
    std::vector<T> download(const Guarded& buffer) {
        std::vector<T> values(buffer.dataBytes() / sizeof(T));
        read(buffer.get(), 0, values.size() * sizeof(T), values.data());
        return values;
    }

    // Planar images in rows padded to 16: `packed` holds count planes of width * height floats without
    // padding; the padding gets `padding` (NaN: it may hold anything, so nothing may depend on it).
    Guarded uploadPlanes(const std::vector<float>& packed, std::uint32_t width, std::uint32_t height,
                         std::uint32_t count, float padding);
    Guarded makePlanes(std::uint32_t width, std::uint32_t height, std::uint32_t count);
    Planes planes(const Guarded& buffer, std::uint32_t width, std::uint32_t height,
                  std::uint32_t count) const;
    std::vector<float> downloadPlanes(const Planes& planes);

    void checkCanaries();  // now, instead of at the end

private:
    Guarded allocate(std::size_t bytes);
    void write(const Guarded& to, const void* from, std::size_t bytes);
    void read(cl_mem from, std::size_t byteOffset, std::size_t bytes, void* to);

    struct Watched {
        Buffer memory;
        std::size_t dataBytes;
    };
    Device& device_;
    Profile profile_;
    Executor executor_;
    std::vector<Watched> watched_;
};

// Two implementations agree when |a - b| <= relative * (|b| + mean|b|) for all but `share` of the values
// (design of the dialect: 1e-5, and 1e-4 of discrete decisions). Empty, or the worst value described.
// NaN agrees with nothing.
std::string disagreement(const std::vector<float>& actual, const std::vector<float>& expected,
                         double relative = 1e-5, double share = 0.0);

// The same bits, or the first value that differs described.
std::string bitDifference(const std::vector<float>& actual, const std::vector<float>& expected);

}  // namespace lightwell::test
