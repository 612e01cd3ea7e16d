// Programs: embedding, live editing, builds that fail, and the binaries on disk.
#include <atomic>
#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>
#include <thread>

#include "support/errors.h"
#include "support/kernel_rig.h"
#include "support/scoped.h"
#include "support/test_device.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

namespace fs = std::filesystem;

const fs::path kKernels = fs::path(LIGHTWELL_SOURCE_DIR) / "kernels";

std::string readAll(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void writeAll(const fs::path& path, const std::string& text) {
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << text;
}

std::vector<fs::path> filesIn(const fs::path& directory) {
    std::vector<fs::path> files;
    if (fs::exists(directory))
        for (const auto& entry : fs::directory_iterator(directory)) files.push_back(entry.path());
    return files;
}

// Adds one to 64 values `times` times on the device and returns the first.
cl_int addOnes(Device& device, int times, std::size_t local = 16) {
    Profile profile;
    Executor executor(device, profile);
    const Buffer values(device, 256, "values");
    executor.fill("test.fill", values, 0, 0, 256);
    Kernel& add = device.programs().kernel("executor_test", "add_one");
    for (int i = 0; i < times; ++i)
        executor.run("test.add", add, {64, 1}, {local, 1}, values, cl_int(64));
    cl_int value = -1;
    executor.read("test.read", values.get(), 0, sizeof value, &value);
    device.finish();
    return value;
}

struct Counters {
    std::uint64_t built, loaded;
};
bool operator==(const Counters& a, const Counters& b) {
    return a.built == b.built && a.loaded == b.loaded;
}

// Opens a device on the cache, runs the kernel and reports where its program came from.
Counters useCache(const std::string& directory, Log& log, std::size_t local = 16) {
    const auto device = freshDevice(directory, &log);
    CHECK(addOnes(*device, 3, local) == 3);
    return {device->programs().built(), device->programs().loaded()};
}

}  // namespace

TEST_CASE("what CMake embeds is what flattening at run time gives", "[program]") {
    REQUIRE(kEmbeddedProgramsCount > 0);
    for (std::size_t i = 0; i < kEmbeddedProgramsCount; ++i) {
        const EmbeddedProgram& program = kEmbeddedPrograms[i];
        CAPTURE(program.name);
        const std::string embedded(reinterpret_cast<const char*>(program.bytes), program.size);
        CHECK((embedded == flattenProgram(kKernels.string(), program.name)));
    }
}

TEST_CASE("includes are flattened once each and keep their lines", "[program]") {
    const ScopedDirectory root;
    writeAll(root.path() / "shared/b.h", "b1\n");
    writeAll(root.path() / "shared/a.h", "a1\n  #  include \"b.h\"  // beside\na3");
    writeAll(root.path() / "stem/k.cl",
             "#include \"shared/a.h\"\n#include <left.h>\n\n#include \"shared/b.h\"\nk5\n");
    CHECK(flattenProgram(root.string(), "stem/k") ==
          "#line 1 \"stem/k.cl\"\n"
          "#line 1 \"shared/a.h\"\na1\n"
          "#line 1 \"shared/b.h\"\nb1\n"
          "#line 3 \"shared/a.h\"\na3\n"
          "#line 2 \"stem/k.cl\"\n#include <left.h>\n\n"
          "#line 5 \"stem/k.cl\"\nk5\n");
    writeAll(root.path() / "stem/lost.cl", "#include \"nowhere.h\"\n");
    const Thrown lost = thrown([&] { flattenProgram(root.string(), "stem/lost"); });
    CHECK(lost.status == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lost.says("nowhere.h"));
    CHECK(lost.says("lost.cl"));
}

TEST_CASE("LIGHTWELL_KERNEL_DIR replaces the embedded sources", "[program]") {
    const ScopedDirectory root;
    fs::copy(kKernels, root.path(), fs::copy_options::recursive);
    const std::string marker = "// edited\n";
    writeAll(root.path() / "probe/width.cl", marker + readAll(root.path() / "probe/width.cl"));
    const std::string embedded = programSource("probe/width");
    CHECK(embedded.find(marker) == std::string::npos);
    {
        const ScopedVariable variable("LIGHTWELL_KERNEL_DIR", root.string().c_str());
        CHECK(programSource("probe/width").find(marker) != std::string::npos);
        // The edited source is another program to the cache: it is built, not taken from the old binary.
        const auto device = freshDevice();
        CHECK(device->programs().kernel("probe/width", "probe_gather").name() == "probe_gather");
        CHECK(thrown([] { programSource("no/such"); }).status == LW_ERROR_INTERNAL);
    }
    const ScopedVariable variable("LIGHTWELL_KERNEL_DIR", "/no/such/directory");
    const Thrown missing = thrown([] { programSource("probe/width"); });
    CHECK(missing.status == LW_ERROR_INVALID_ARGUMENT);
    CHECK(missing.says("LIGHTWELL_KERNEL_DIR"));
    CHECK(missing.says("/no/such/directory"));
}

TEST_CASE("a failed build names kernel, options, file and line", "[program]") {
    const ScopedDirectory root;
    writeAll(root.path() / "broken.h", "// first line\nint broken = ;\n");
    writeAll(root.path() / "bad.cl",
             "#include \"broken.h\"\n__kernel void k(__global int* p) { p[0] = broken; }\n");
    const auto device = freshDevice();
    device->programs().addSource("tests/bad", flattenProgram(root.string(), "bad"));
    const Thrown failed = thrown([&] {
        device->programs().kernel("tests/bad", "k", {{"LW_SOME", "7"}});
    });
    CHECK(failed.status == LW_ERROR_BUILD_FAILED);
    CHECK(failed.says("tests/bad"));
    CHECK(failed.says("-DLW_SOME=7"));
    CHECK(failed.says("-DLW_WIDTH=1"));
    CHECK(failed.says("broken.h:2"));
    // The cache is as before: the next program builds.
    CHECK(addOnes(*device, 2) == 2);

    CHECK(thrown([&] { device->programs().kernel("tests/none", "k"); }).status == LW_ERROR_INTERNAL);
    const Thrown kernel = thrown([&] { device->programs().kernel("executor_test", "no_kernel"); });
    CHECK(kernel.status == LW_ERROR_INTERNAL);
    CHECK(kernel.says("no_kernel"));
}

TEST_CASE("a program is built once per defines and width", "[program]") {
    const auto device = freshDevice();
    ProgramCache& programs = device->programs();
    Kernel& plain = programs.kernel("executor_test", "all_kinds");
    CHECK(plain.width() == 1);
    CHECK(programs.kernel("executor_test", "all_kinds", {}, 16).width() == 16);
    CHECK(programs.built() == 2);
    programs.kernel("executor_test", "all_kinds", {{"LW_OTHER", "1"}});
    CHECK(programs.built() == 3);
    programs.kernel("executor_test", "all_kinds", {{"LW_OTHER", "1"}});
    programs.kernel("executor_test", "add_one");
    CHECK(&programs.kernel("executor_test", "all_kinds", {}, 1) == &plain);
    CHECK(programs.built() == 3);
}

TEST_CASE("binaries are saved after launches and loaded by the next device", "[cache]") {
    const ScopedDirectory cache;
    const std::string directory = (cache.path() / "made/on/demand").string();
    Log log;
    CHECK(useCache(directory, log) == Counters{1, 0});
    REQUIRE(filesIn(directory).size() == 1);
    const fs::path file = filesIn(directory)[0];
    const auto written = fs::last_write_time(file);
    CHECK(useCache(directory, log) == Counters{0, 1});
    CHECK(fs::last_write_time(file) == written);  // nothing new to save
    // A new local size may have been compiled for: saved again, once.
    CHECK(useCache(directory, log, 8) == Counters{0, 1});
    CHECK(fs::last_write_time(file) != written);
    const auto again = fs::last_write_time(file);
    CHECK(useCache(directory, log, 8) == Counters{0, 1});
    CHECK(fs::last_write_time(file) == again);
    CHECK(filesIn(directory).size() == 1);
    CHECK(log.count(LW_LOG_WARNING) == 0);
}

TEST_CASE("damaged and stale binaries are rebuilt and replaced", "[cache]") {
    const ScopedDirectory cache;
    Log log;
    CHECK(useCache(cache.string(), log) == Counters{1, 0});
    REQUIRE(filesIn(cache.path()).size() == 1);
    const fs::path file = filesIn(cache.path())[0];
    const std::string good = readAll(file);
    std::string flipped = good, otherKey = good, otherMagic = good;
    flipped[flipped.size() / 2] = char(flipped[flipped.size() / 2] ^ 0x40);
    otherKey[8] = char(otherKey[8] ^ 1);
    otherMagic[0] = '?';
    for (const std::string& bad : {std::string(), good.substr(0, 17), good.substr(0, good.size() - 1),
                                   good + "x", flipped, otherKey, otherMagic}) {
        CAPTURE(bad.size());
        log.lines.clear();
        writeAll(file, bad);
        CHECK(useCache(cache.string(), log) == Counters{1, 0});
        CHECK(log.count(LW_LOG_WARNING) == 1);
        CHECK(log.says(file.string()));
        CHECK(useCache(cache.string(), log) == Counters{0, 1});
    }
}

TEST_CASE("a binary that the driver refuses is rebuilt", "[cache]") {
    if (driverIs("rusticl")) return;  // Mesa 22.3's Rusticl aborts the process on a foreign binary
    const ScopedDirectory cache;
    Log log;
    {
        const auto device = freshDevice(cache.string(), &log);
        CHECK(addOnes(*device, 1) == 1);
    }
    // A well-formed entry of the same key whose payload is no program.
    const fs::path file = filesIn(cache.path()).at(0);
    const std::string bytes = readAll(file);
    StoreKey key;
    std::memcpy(&key.high, bytes.data() + 8, 8);
    std::memcpy(&key.low, bytes.data() + 16, 8);
    const std::string junk = std::string("add_one 16x1\n") + '\0' + "this is no program";
    REQUIRE_FALSE(BinaryStore(cache.string()).write(key, BinaryStore::Bytes(junk.begin(), junk.end())));
    CHECK(useCache(cache.string(), log) == Counters{1, 0});
    CHECK(log.says("refuses"));
}

TEST_CASE("an unwritable cache directory is warned of once", "[cache]") {
    const ScopedDirectory root;
    writeAll(root.path() / "file", "not a directory");
    Log log;
    const auto device = freshDevice((root.path() / "file/cache").string(), &log);
    CHECK(addOnes(*device, 1, 16) == 1);
    CHECK(addOnes(*device, 1, 8) == 1);
    CHECK(log.count(LW_LOG_WARNING) == 1);
    CHECK(log.says("LIGHTWELL_CACHE_DIR"));
}

TEST_CASE("the cache directory comes from the environment", "[cache]") {
    const ScopedVariable own("LIGHTWELL_CACHE_DIR", "/a"), xdg("XDG_CACHE_HOME", "/b"),
        home("HOME", "/c");
    CHECK(defaultCacheDirectory() == "/a");
    const ScopedVariable noOwn("LIGHTWELL_CACHE_DIR", "");
    CHECK(defaultCacheDirectory() == "/b/lightwell");
    const ScopedVariable noXdg("XDG_CACHE_HOME", nullptr);
    CHECK(defaultCacheDirectory() == "/c/.cache/lightwell");
    const ScopedVariable noHome("HOME", nullptr);
    CHECK(defaultCacheDirectory() == "");
}

TEST_CASE("whatever bears an entry's name, reading it only says that it is damaged", "[cache]") {
    const ScopedDirectory directory;
    const BinaryStore store(directory.string());
    const StoreKey key = hashKey({"odd"});
    BinaryStore::Bytes bytes;
    SECTION("a directory") { fs::create_directories(store.path(key)); }
    SECTION("a file larger than memory") {
        REQUIRE_FALSE(store.write(key, {1, 2, 3}).has_value());
        fs::resize_file(store.path(key), std::uintmax_t(1) << 42);  // a hole
    }
    SECTION("nothing") { writeAll(store.path(key), ""); }
    CHECK(store.read(key, bytes) == BinaryStore::Found::kDamaged);
}

TEST_CASE("keys differ where any part does", "[cache]") {
    const StoreKey key = hashKey({"ab", "c"});
    for (const auto& parts :
         std::vector<std::vector<std::string>>{{"a", "bc"}, {"ab", "d"}, {"ab"}, {"ab", "c", ""}}) {
        const StoreKey other = hashKey(parts);
        CHECK(other.high != key.high);
        CHECK(other.low != key.low);
    }
    CHECK(hashKey({"ab", "c"}).high == key.high);
}

TEST_CASE("readers never see a half-written entry", "[cache]") {
    const ScopedDirectory cache;
    const BinaryStore store(cache.string());
    const StoreKey key = hashKey({"shared"});
    constexpr std::size_t kBytes = 200000;
    REQUIRE_FALSE(store.write(key, BinaryStore::Bytes(kBytes, 0)));
    std::atomic<int> damaged{0}, mixed{0};
    std::vector<std::thread> threads;
    for (int writer = 1; writer <= 2; ++writer)
        threads.emplace_back([&, writer] {
            for (int i = 0; i < 50; ++i)
                if (store.write(key, BinaryStore::Bytes(kBytes, static_cast<unsigned char>(writer))))
                    ++damaged;
        });
    for (int reader = 0; reader < 2; ++reader)
        threads.emplace_back([&] {
            BinaryStore::Bytes bytes;
            for (int i = 0; i < 50; ++i) {
                if (store.read(key, bytes) != BinaryStore::Found::kYes) ++damaged;
                if (bytes.size() != kBytes || bytes.front() != bytes.back()) ++mixed;
            }
        });
    for (std::thread& thread : threads) thread.join();
    CHECK(damaged == 0);
    CHECK(mixed == 0);
    CHECK(filesIn(cache.path()).size() == 1);
}
