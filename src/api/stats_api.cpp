// Entry points: statistics, debug views.
#include <cstring>

#include "api/call.h"
#include "api/structs.h"
#include "inputs/read_planes.h"

using namespace lightwell;

namespace {

// Has a debug view written to `pixels`; one that must be made first is made in `made`.
void enqueueDebugRead(Executor& executor, const DebugView& debug, Buffer& made, float* pixels) {
    Planes planes = debug.planes;
    if (debug.fill) {
        made = Buffer(executor.device(), std::size_t(planes.planeStride) * planes.count * sizeof(float), debug.name);
        planes.memory = made.get();
        debug.fill(executor, planes);
    }
    enqueueReadPlanes(executor, planes, pixels);
}

// None before the first lwUpdate, and after one that failed: buffers may then hold anything.
std::vector<DebugView> debugViewsOf(const TechniqueObject& object, const View* view) {
    return object.current() ? object.technique->debugViews(view) : std::vector<DebugView>();
}

}  // namespace

LWStatus lwGetStats(LWTechnique technique, LWStats* stats) {
    return enter("lwGetStats", [&](Call& call) {
        const auto object = call.technique(technique);
        const std::uint32_t size = checkedStructSize(stats, "stats");
        // As things stand now; other threads may go on while this call waits.
        LWStats result{};
        result.frameIndex = object->frameIndex;
        result.deviceBytes = object->technique->bytes();
        result.totalMilliseconds = -1.0;
        std::unique_ptr<Profile> profile;
        if (object->record) {
            profile = object->record->profile.snapshot();
            result.hostCopyBytes = object->record->executor.copiedBytes();
        }
        Report report;
        if (object->current() || (!object->begun && object->isWhole())) report = object->technique->report();
        call.wait();
        report.resolve();  // before anything is thrown: it waits for reads on their way, now with the lock held
        call.owner()->device.settle();
        object->report = std::move(report);
        object->passes.clear();
        if (profile) {
            object->passes = profile->passes();
            result.totalMilliseconds = profile->totalMilliseconds();
        }
        result.passCount = std::uint32_t(object->passes.size());
        result.countCount = std::uint32_t(object->report.counts.size());
        result.choiceCount = std::uint32_t(object->report.choices.size());
        result.passes = object->passes.data();
        result.counts = object->report.counts.data();
        result.choices = object->report.choices.data();
        writeStruct(stats, size, result);
    });
}

LWStatus lwCountDebugViews(LWTechnique technique, LWView view, std::uint32_t* count) {
    return enter("lwCountDebugViews", [&](Call& call) {
        const auto object = call.technique(technique);
        const auto own = call.viewOfDevice(view, "view", true);
        if (!count) fail(LW_ERROR_INVALID_ARGUMENT, "count: expected an address, got null");
        *count = std::uint32_t(debugViewsOf(*object, own.get()).size());
    });
}

LWStatus lwDescribeDebugView(LWTechnique technique, LWView view, std::uint32_t index,
                             LWDebugView* info) {
    return enter("lwDescribeDebugView", [&](Call& call) {
        const auto object = call.technique(technique);
        const auto own = call.viewOfDevice(view, "view", true);
        const std::uint32_t size = checkedStructSize(info, "info");
        const auto views = debugViewsOf(*object, own.get());
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
        Device& device = call.owner()->device;
        std::string names;
        for (const DebugView& debug : debugViewsOf(*object, own.get())) {
            names += (names.empty() ? "" : ", ") + std::string(debug.name);
            if (std::strcmp(debug.name, name) != 0) continue;
            const std::uint64_t needed =
                std::uint64_t(debug.planes.width) * debug.planes.height * debug.planes.count;
            if (capacity < needed)
                fail(LW_ERROR_INVALID_ARGUMENT, "capacity: expected at least ", needed, " floats, got ",
                     capacity);
            if (needed == 0) return;  // nothing to show, e.g. maps where no light is shadowed
            FrameRecord scratch(device);  // its times belong to no frame
            Buffer made;                   // held until the reads are done
            try {
                enqueueDebugRead(scratch.executor, debug, made, pixels);
                call.wait();
            } catch (...) {
                clFinish(device.queue());  // `pixels` must not be written after this call
                throw;
            }
            device.settle();
            return;
        }
        fail(LW_ERROR_INVALID_ARGUMENT, "name: expected one of ", names.empty() ? "(none yet)" : names,
             ", got \"", std::string(name).substr(0, 64), "\"");
    });
}
