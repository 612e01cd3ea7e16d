#include "file_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <stdexcept>
#include <thread>

namespace cli {
namespace {

constexpr std::chrono::milliseconds kInterval{200};

}  // namespace

FileLock::FileLock(const std::filesystem::path& path, const std::function<bool()>& waits)
    : file_(::open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666)) {
    const auto fail = [&] {
        throw std::runtime_error(
            fmt::format("{}: cannot be locked: {}", path.string(), std::strerror(errno)));
    };
    if (file_ < 0) fail();
    try {
        while (!isHeld_) {
            isHeld_ = ::flock(file_, LOCK_EX | LOCK_NB) == 0;
            if (isHeld_) break;
            if (errno != EWOULDBLOCK && errno != EINTR) fail();
            if (!waits()) break;
            std::this_thread::sleep_for(kInterval);
        }
    } catch (...) {
        ::close(file_);
        throw;
    }
}

FileLock::~FileLock() {
    ::close(file_);
}

}  // namespace cli
