// Named blobs in a directory, safe against truncation, corruption and concurrent writers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lightwell {

// 128 bits from two FNV-1a hashes with different offsets: names a blob, guards against staleness.
struct StoreKey {
    std::uint64_t high = 0, low = 0;
};
StoreKey hashKey(const std::vector<std::string>& parts);

class BinaryStore {
public:
    using Bytes = std::vector<unsigned char>;
    enum class Found { kYes, kNo, kDamaged };

    // `directory` empty: nothing is kept. The directory is created at the first write.
    explicit BinaryStore(std::string directory) : directory_(std::move(directory)) {}

    bool enabled() const { return !directory_.empty(); }
    const std::string& directory() const { return directory_; }
    std::string path(const StoreKey& key) const;

    // kDamaged: a file of that key exists but is truncated, corrupt, or of another format or key.
    Found read(const StoreKey& key, Bytes& bytes) const;
    // Writes to a temporary file of its own and renames it. Returns what went wrong, or nothing.
    std::optional<std::string> write(const StoreKey& key, const Bytes& bytes) const;

private:
    std::string directory_;
};

// $LIGHTWELL_CACHE_DIR, $XDG_CACHE_HOME/lightwell or ~/.cache/lightwell; empty when none is set.
std::string defaultCacheDirectory();

}  // namespace lightwell
