#include "inputs/host_memory.h"

#if defined(__linux__)
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#endif

namespace lightwell {

bool maybeMapped(const void* address) {
#if defined(__linux__)
    static const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
    unsigned char resident = 0;
    const auto start = reinterpret_cast<std::uintptr_t>(address) / page * page;
    return mincore(reinterpret_cast<void*>(start), 1, &resident) == 0 || errno != ENOMEM;
#else
    return address != nullptr;
#endif
}

}  // namespace lightwell
