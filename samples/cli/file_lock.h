// One process at a time: a lock that ends with its process, however that ends.
#pragma once

#include <filesystem>
#include <functional>

namespace cli {

class FileLock {
public:
    // The file is made when missing, and stays. While another holds it, `waits` is asked every 0.2 s:
    // false gives up, an exception comes out. std::runtime_error naming the path when it cannot be
    // opened.
    FileLock(const std::filesystem::path& path, const std::function<bool()>& waits);
    ~FileLock();
    FileLock(const FileLock&) = delete;
    FileLock& operator=(const FileLock&) = delete;

    bool isHeld() const { return isHeld_; }

private:
    int file_ = -1;
    bool isHeld_ = false;
};

}  // namespace cli
