#include "api/handles.h"

#include <limits>
#include <mutex>
#include <unordered_map>

#include "compute/error.h"

namespace lightwell {
namespace {

struct Entry {
    HandleKind kind;
    std::uint32_t references;
    std::shared_ptr<Object> object;
};

struct Table {
    std::mutex mutex;
    std::unordered_map<std::uintptr_t, Entry> entries;
    std::uintptr_t last = 0;
};

Table& table() {
    static Table& instance = *new Table;
    return instance;
}

const char* kindName(HandleKind kind) {
    switch (kind) {
        case HandleKind::kDevice:
            return "device";
        case HandleKind::kView:
            return "view";
        default:
            return "technique";
    }
}

// The table's mutex must be held.
Entry& entryOf(HandleKind kind, const void* handle, const char* argument) {
    if (!handle) fail(LW_ERROR_INVALID_HANDLE, argument, ": expected a ", kindName(kind), ", got null");
    auto& entries = table().entries;
    const auto found = entries.find(reinterpret_cast<std::uintptr_t>(handle));
    if (found == entries.end())
        fail(LW_ERROR_INVALID_HANDLE, argument, ": expected a ", kindName(kind),
             ", got a handle that was released or never made");
    if (found->second.kind != kind)
        fail(LW_ERROR_INVALID_HANDLE, argument, ": expected a ", kindName(kind), ", got a ",
             kindName(found->second.kind));
    return found->second;
}

}  // namespace

void* addHandle(HandleKind kind, std::shared_ptr<Object> object) {
    Table& all = table();
    const std::lock_guard<std::mutex> lock(all.mutex);
    all.entries.emplace(all.last + 1, Entry{kind, 1, std::move(object)});
    return reinterpret_cast<void*>(++all.last);
}

std::shared_ptr<Object> findHandle(HandleKind kind, const void* handle, const char* argument) {
    const std::lock_guard<std::mutex> lock(table().mutex);
    return entryOf(kind, handle, argument).object;
}

void retainHandle(HandleKind kind, const void* handle, const char* argument) {
    const std::lock_guard<std::mutex> lock(table().mutex);
    Entry& entry = entryOf(kind, handle, argument);
    if (entry.references == std::numeric_limits<std::uint32_t>::max())
        fail(LW_ERROR_INVALID_ARGUMENT, argument, ": expected fewer than 2^32 references");
    ++entry.references;
}

std::shared_ptr<Object> releaseHandle(HandleKind kind, const void* handle, const char* argument) {
    const std::lock_guard<std::mutex> lock(table().mutex);
    Entry& entry = entryOf(kind, handle, argument);
    if (--entry.references > 0) return nullptr;
    std::shared_ptr<Object> object = std::move(entry.object);
    table().entries.erase(reinterpret_cast<std::uintptr_t>(handle));
    return object;
}

}  // namespace lightwell
