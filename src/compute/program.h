// Kernels: embedded sources, builds, and the cache of program binaries on disk.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "compute/binary_store.h"
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
extern const std::size_t kEmbeddedProgramsCount;

// The source of a program: from LIGHTWELL_KERNEL_DIR (read and flattened the same way) when set, else
// embedded. Throws INTERNAL for an unknown name, INVALID_ARGUMENT for an unreadable directory.
std::string programSource(const std::string& name);
// Reads `name`.cl below `directory` and flattens its quoted includes, byte for byte as embed.cmake does.
std::string flattenProgram(const std::string& directory, const std::string& name);

// One kernel of a built program. Owned by the ProgramCache; lives as long as its device.
class Kernel {
public:
    cl_kernel get() const { return kernel_; }
    const std::string& name() const { return name_; }
    std::uint32_t width() const { return width_; }  // lanes per work-item it was built for

    std::uint32_t argumentCount() const { return argumentCount_; }

    // Notes a launch. True when it is the first with this local size and kind of grid: drivers may
    // compile the kernel anew for each (PoCL does, about 44 ms; it tells grids of more than 65535 groups
    // along an axis apart as well).
    bool noteLaunch(const std::array<std::size_t, 2>& global, const std::array<std::size_t, 2>& local);

private:
    friend class ProgramCache;
    std::string name_;
    std::uint32_t width_ = 0, argumentCount_ = 0;
    cl_kernel kernel_ = nullptr;
    std::set<std::string>* programLaunches_ = nullptr;  // of the program: "kernel 16x1"
    std::set<std::array<std::size_t, 3>> launches_;
};

// Options a program is built with, beside -cl-std=CL1.2 and -DLW_WIDTH: {"LW_INTERLEAVE", "4"}.
using Defines = std::vector<std::pair<std::string, std::string>>;

// Builds programs once per (source, defines, width). Binaries go to disk (key: a hash of source,
// options, device, driver) when saveBinaries() is called after first launches, so that they hold what
// the driver compiled at those; a corrupt or stale entry is rebuilt and replaced.
class ProgramCache {
public:
    explicit ProgramCache(Device& device, std::string directory);
    ~ProgramCache();
    ProgramCache(const ProgramCache&) = delete;

    // `width` 0: the device's. Throws BUILD_FAILED with kernel, options and the compiler's log.
    Kernel& kernel(const std::string& program, const std::string& kernelName,
                   const Defines& defines = {}, std::uint32_t width = 0);
    // Adds a program that the library does not embed (tests, benchmarks), or replaces one of that name.
    void addSource(const std::string& program, std::string source);
    // Writes the binaries of programs with launches that their file on disk does not hold yet. Call when
    // the queue is idle. An unwritable directory is warned of once.
    void saveBinaries();

    std::uint64_t built() const { return built_; }
    std::uint64_t loaded() const { return loaded_; }

    const BinaryStore& store() const { return store_; }

private:
    struct Program;
    Program& program(const std::string& name, const Defines& defines, std::uint32_t width);
    void build(Program& program);
    bool load(Program& program);
    void save(Program& program);

    Device& device_;
    BinaryStore store_;
    std::map<std::string, std::string> added_;
    std::map<std::string, std::unique_ptr<Program>> programs_;  // by name and options
    std::uint64_t built_ = 0, loaded_ = 0;
};

}  // namespace lightwell
