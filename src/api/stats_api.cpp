// Entry points: statistics, debug views.
#include <cstring>

#include "api/call.h"
#include "api/structs.h"
#include "inputs/read_planes.h"

using namespace lightwell;

LWStatus lwGetStats(LWTechnique technique, LWStats* stats) {
    return enter("lwGetStats", [&](Call& call) {
        const auto object = call.technique(technique);
        const std::uint32_t size = checkedStructSize(stats, "stats");
        call.waitIdle();
        call.owner()->device.finish();
        object->report = object->technique->report();
        object->passes.clear();
        LWStats result{};
        result.totalMilliseconds = -1.0;
        if (object->record) {
            object->passes = object->record->profile.passes();
            result.totalMilliseconds = object->record->profile.totalMilliseconds();
            result.hostCopyBytes = object->record->executor.copiedBytes();
        }
        result.frameIndex = object->frameIndex;
        result.passCount = std::uint32_t(object->passes.size());
        result.countCount = std::uint32_t(object->report.counts.size());
        result.choiceCount = std::uint32_t(object->report.choices.size());
        result.passes = object->passes.data();
        result.counts = object->report.counts.data();
        result.choices = object->report.choices.data();
        result.deviceBytes = object->technique->bytes();
        writeStruct(stats, size, result);
    });
}

LWStatus lwCountDebugViews(LWTechnique technique, LWView view, std::uint32_t* count) {
    return enter("lwCountDebugViews", [&](Call& call) {
        const auto object = call.technique(technique);
        const auto own = call.viewOfDevice(view, "view", true);
        if (!count) fail(LW_ERROR_INVALID_ARGUMENT, "count: expected an address, got null");
        *count = std::uint32_t(object->technique->debugViews(own.get()).size());
    });
}

LWStatus lwDescribeDebugView(LWTechnique technique, LWView view, std::uint32_t index,
                             LWDebugView* info) {
    return enter("lwDescribeDebugView", [&](Call& call) {
        const auto object = call.technique(technique);
        const auto own = call.viewOfDevice(view, "view", true);
        const std::uint32_t size = checkedStructSize(info, "info");
        const auto views = object->technique->debugViews(own.get());
        if (index >= views.size())
            fail(LW_ERROR_INVALID_ARGUMENT, "index: expected less than ", views.size(), ", got ", index);
        const DebugView& debug = views[index];
        LWDebugView result{};
        result.width = debug.planes.width;
        result.height = debug.planes.height;
        result.channels = debug.planes.count;
        result.name = debug.name;
        result.description = debug.description;
        writeStruct(info, size, result);
    });
}

LWStatus lwReadDebugView(LWTechnique technique, LWView view, const char* name, float* pixels,
                         std::uint64_t capacity) {
    return enter("lwReadDebugView", [&](Call& call) {
        const auto object = call.technique(technique);
        const auto own = call.viewOfDevice(view, "view", true);
        if (!name) fail(LW_ERROR_INVALID_ARGUMENT, "name: expected a debug view's name, got null");
        if (!pixels) fail(LW_ERROR_INVALID_ARGUMENT, "pixels: expected an address, got null");
        call.waitIdle();
        call.owner()->device.finish();
        std::string names;
        for (const DebugView& debug : object->technique->debugViews(own.get())) {
            names += (names.empty() ? "" : ", ") + std::string(debug.name);
            if (std::strcmp(debug.name, name) != 0) continue;
            const std::uint64_t needed =
                std::uint64_t(debug.planes.width) * debug.planes.height * debug.planes.count;
            if (capacity < needed)
                fail(LW_ERROR_INVALID_ARGUMENT, "capacity: expected at least ", needed, " floats, got ",
                     capacity);
            readPlanes(call.owner()->device, debug.planes, pixels);
            return;
        }
        fail(LW_ERROR_INVALID_ARGUMENT, "name: expected one of ", names.empty() ? "(none yet)" : names,
             ", got \"", std::string(name).substr(0, 64), "\"");
    });
}
