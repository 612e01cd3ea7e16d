// A blob's file: header (magic, key, size, checksum), then the bytes.
#include "compute/binary_store.h"

#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace lightwell {
namespace {

namespace fs = std::filesystem;

constexpr char kMagic[8] = {'L', 'W', 'C', 'A', 'C', 'H', 'E', '1'};
constexpr std::uint64_t kFnvPrime = 1099511628211u;
constexpr std::uint64_t kFnvOffset = 14695981039346656037u;
constexpr std::uint64_t kOtherOffset = 0x6c69676874776c6cu;  // any other start gives an independent hash

struct Header {
    char magic[8];
    std::uint64_t keyHigh, keyLow, size, checksum;
};

// FNV-1a over bytes.
std::uint64_t fnv(std::uint64_t hash, const void* data, std::size_t size) {
    const unsigned char* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * kFnvPrime;
    return hash;
}

Header headerOf(const StoreKey& key, const BinaryStore::Bytes& bytes) {
    Header header{};
    std::memcpy(header.magic, kMagic, sizeof kMagic);
    header.keyHigh = key.high;
    header.keyLow = key.low;
    header.size = bytes.size();
    header.checksum = fnv(kFnvOffset, bytes.data(), bytes.size());
    return header;
}

}  // namespace

StoreKey hashKey(const std::vector<std::string>& parts) {
    StoreKey key{kOtherOffset, kFnvOffset};
    for (const std::string& part : parts) {
        // The length keeps {"ab", "c"} apart from {"a", "bc"}.
        const std::uint64_t size = part.size();
        for (std::uint64_t* hash : {&key.high, &key.low}) {
            *hash = fnv(*hash, &size, sizeof size);
            *hash = fnv(*hash, part.data(), part.size());
        }
    }
    return key;
}

std::string BinaryStore::path(const StoreKey& key) const {
    char name[40];
    std::snprintf(name, sizeof name, "%016llx%016llx.bin", static_cast<unsigned long long>(key.high),
                  static_cast<unsigned long long>(key.low));
    return (fs::path(directory_) / name).string();
}

BinaryStore::Found BinaryStore::read(const StoreKey& key, Bytes& bytes) const {
    if (!enabled()) return Found::kNo;
    std::ifstream file(path(key), std::ios::binary | std::ios::ate);
    if (!file) return Found::kNo;
    const std::streamoff total = file.tellg();
    Header header{};
    if (total < std::streamoff(sizeof header)) return Found::kDamaged;
    file.seekg(0);
    file.read(reinterpret_cast<char*>(&header), sizeof header);
    // Before memory is taken for it: a file of any size, or a directory, may bear the name.
    if (!file || header.size != std::uint64_t(total) - sizeof header) return Found::kDamaged;
    bytes.resize(std::size_t(total) - sizeof header);
    file.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size()));
    const Header expected = headerOf(key, bytes);
    if (!file || std::memcmp(&header, &expected, sizeof header) != 0) return Found::kDamaged;
    return Found::kYes;
}

std::optional<std::string> BinaryStore::write(const StoreKey& key, const Bytes& bytes) const {
    if (!enabled()) return std::nullopt;
    std::error_code error;
    fs::create_directories(directory_, error);
    if (error) return directory_ + ": " + error.message();

    static std::atomic<unsigned> counter{0};
    const std::string target = path(key);
    const std::string temporary =
        target + '.' + std::to_string(::getpid()) + '.' + std::to_string(++counter) + ".tmp";
    const Header header = headerOf(key, bytes);
    std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(&header), sizeof header);
    file.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    file.close();
    if (!file) {
        fs::remove(temporary, error);
        return temporary + ": cannot be written";
    }
    fs::rename(temporary, target, error);
    if (error) {
        const std::string message = target + ": " + error.message();
        fs::remove(temporary, error);
        return message;
    }
    return std::nullopt;
}

std::string defaultCacheDirectory() {
    for (const auto& [variable, below] :
         {std::pair{"LIGHTWELL_CACHE_DIR", ""}, std::pair{"XDG_CACHE_HOME", "lightwell"},
          std::pair{"HOME", ".cache/lightwell"}})
        if (const char* value = std::getenv(variable); value && *value) {
            const fs::path root(value);
            return *below ? (root / below).string() : root.string();
        }
    return {};
}

}  // namespace lightwell
