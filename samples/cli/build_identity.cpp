#include "build_identity.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "film.h"
#include "lightwell/lightwell.h"

namespace cli {
namespace {

namespace fs = std::filesystem;

std::uint64_t hashFile(const fs::path& path, std::uint64_t seed) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    return studio::hashBytes(bytes.data(), bytes.size(), seed);
}

fs::path libraryPath() {
    Dl_info info{};
    if (dladdr(reinterpret_cast<const void*>(&lwCountTechniques), &info) == 0 ||
        info.dli_fname == nullptr)
        return {};
    return info.dli_fname;
}

std::vector<fs::path> kernelFiles() {
    std::vector<fs::path> files;
    const char* folder = std::getenv("LIGHTWELL_KERNEL_DIR");
    if (folder == nullptr || *folder == '\0') return files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

std::string cpuName() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.rfind("model name", 0) == 0 && line.find(": ") != std::string::npos)
            return line.substr(line.find(": ") + 2);
    return "unknown";
}

}  // namespace

std::string buildIdentity() {
    std::uint64_t hash = hashFile("/proc/self/exe", 4);
    if (const fs::path library = libraryPath(); !library.empty()) hash = hashFile(library, hash);
    for (const fs::path& file : kernelFiles()) hash = hashFile(file, hash);
    return fmt::format("{:016x}", hash);
}

std::vector<std::pair<std::string, std::string>> buildVersions() {
    return {{"lightwell", LIGHTWELL_CLI_VERSION},
            {"embree", LIGHTWELL_EMBREE_VERSION},
            {"openimageio", LIGHTWELL_OIIO_VERSION},
            {"compiler", LIGHTWELL_COMPILER},
            {"cpu", cpuName()},
            {"threads", std::to_string(std::thread::hardware_concurrency())}};
}

}  // namespace cli
