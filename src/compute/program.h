// Kernels: embedded sources, builds, and the cache of program binaries on disk.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "compute/cl.h"

namespace lightwell {

class Device;

// A source that embed.cmake flattened into the library: name = path below kernels/ without ".cl",
// e.g. "interleaved_gather/interleaved_gather".
struct EmbeddedProgram {
    const char* name;
    const unsigned char* bytes;
    std::size_t size;
};
extern const EmbeddedProgram kEmbeddedPrograms[];
extern const std::size_t kEmbeddedProgramCount;

// The source of a program: from LIGHTWELL_KERNEL_DIR (read and flattened the same way) when set, else
// embedded. Throws INTERNAL for an unknown name, INVALID_ARGUMENT for an unreadable directory.
std::string programSource(const std::string& name);

// One kernel of a built program. Owned by the ProgramCache; lives as long as its device.
class Kernel {
public:
    cl_kernel get() const { return kernel_; }
    const std::string& name() const { return name_; }
    std::uint32_t width() const { return width_; }  // lanes per work-item it was built for

private:
    friend class ProgramCache;
    friend class Executor;
    std::string name_;
    std::uint32_t width_ = 0;
    cl_kernel kernel_ = nullptr;
    void* program_ = nullptr;                     // ProgramCache's record
    std::vector<std::uint64_t> launchedSizes_;    // local sizes launched before, for the counters
};

// Options a program is built with, beside -cl-std=CL1.2 and -DLW_WIDTH: {"LW_INTERLEAVE", "4"}.
using Defines = std::vector<std::pair<std::string, std::string>>;

// Builds programs once per (source, defines, width). Binaries go to disk (key: a hash of source,
// options, device, driver) when saveBinaries() is called after first launches, by temporary file and
// rename; a corrupt or stale entry is rebuilt and replaced.
class ProgramCache {
public:
    explicit ProgramCache(Device& device, std::string directory);
    ~ProgramCache();
    ProgramCache(const ProgramCache&) = delete;

    // `width` 0: the device's. Throws BUILD_FAILED with kernel, options and the compiler's log.
    Kernel& kernel(const std::string& program, const std::string& kernelName, const Defines& defines = {},
                   std::uint32_t width = 0);
    // Writes the binaries of programs that were launched since they were built. Errors are logged.
    void saveBinaries();

    std::uint64_t built() const { return built_; }
    std::uint64_t loaded() const { return loaded_; }

private:
    struct Program;
    Device& device_;
    std::string directory_;
    std::map<std::string, std::unique_ptr<Program>> programs_;
    std::uint64_t built_ = 0, loaded_ = 0;
};

}  // namespace lightwell
