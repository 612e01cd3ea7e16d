// Entry points: techniques and frames.
#include <cmath>
#include <string>

#include "api/call.h"
#include "api/frame_arguments.h"
#include "api/parameters.h"
#include "api/structs.h"
#include "compute/raw_enum.h"

using namespace lightwell;

namespace {

LWStatus createTechnique(const char* function, LWDevice device, const char* name, const void* desc,
                         LWTechnique* technique) {
    return enter(function, [&](Call& call) {
        Device& own = call.device(device);
        if (!technique)
            fail(LW_ERROR_INVALID_ARGUMENT, "technique: expected an address for the handle, got null");
        *technique = nullptr;
        const TechniqueEntry& entry = findTechniqueEntry(name);
        const auto descriptor = readDescriptor(entry, desc);
        auto object = std::make_shared<TechniqueObject>();
        object->device = call.owner();
        object->entry = &entry;
        object->descriptor = descriptor;
        object->parts = partsOf(call, entry, descriptor);
        std::vector<std::shared_ptr<Technique>> parts;  // each keeps its handle's object alive
        for (const auto& part : object->parts) parts.emplace_back(part, part->technique.get());
        object->technique = entry.join ? entry.join(own, parts) : entry.create(own, descriptor.data());
        *technique = static_cast<LWTechnique>(addHandle(HandleKind::kTechnique, std::move(object)));
    });
}

// True when a failed update left the technique's world part as it was: techniques and inputs check their
// arguments before they change anything. (What the kernels' indices or the device cannot hold is UNSUPPORTED,
// and found out on the way.)
bool refusedUnchanged(LWStatus status) {
    return status == LW_ERROR_INVALID_ARGUMENT || status == LW_ERROR_INVALID_HANDLE;
}

void checkOutput(const LWOutput& output) {
    for (const LWImage* image : {&output.irradiance, &output.validity, &output.ambientOcclusion,
                                 &output.specularRadiance, &output.refractedRadiance, &output.shadow})
        if (rawEnum(image->format) != LW_FORMAT_NONE || image->host || image->clMem) return;
    fail(LW_ERROR_INVALID_ARGUMENT, "output: expected at least one image, got none");
}

// Records what a view or points get of the last update, by `record`.
template <class Record>
void light(TechniqueObject& object, const LWSync* sync, Record record) {
    if (!object.updated || !object.isWhole())
        fail(LW_ERROR_NOT_UPDATED, "technique: expected a successful lwUpdate before, got none");
    object.device->device.raiseFailure();
    if (!object.current())
        fail(LW_ERROR_NOT_UPDATED, "technique: expected another lwUpdate since commands failed on the device, got none");
    Executor& executor = object.record->executor;
    try {
        executor.waitFor(sync);
        record();
        executor.signal(sync);
        executor.flush();
    } catch (const Error& error) {
        executor.forgetWaits();  // the host may release its events as soon as the call is back
        // The world part stays whole; what views keep may not. (Outputs that a technique has not are UNSUPPORTED, found out first.)
        if (!refusedUnchanged(error.status()) && error.status() != LW_ERROR_UNSUPPORTED) object.lose();
        throw;
    } catch (...) {
        executor.forgetWaits();
        object.lose();
        throw;
    }
}

// Of it and of all of its parts.
void checkMakesPoints(const TechniqueObject& object) {
    if (!object.entry->info.points) {
        std::string makers;
        for (const TechniqueEntry& entry : techniqueEntries())
            if (entry.info.points) makers += (makers.empty() ? "" : ", ") + std::string(entry.info.name);
        fail(LW_ERROR_UNSUPPORTED, "technique: ", object.entry->info.name,
             " takes its light from a view's own pixels and has none at points; techniques that have: ", makers.empty() ? "none" : makers);
    }
    for (const auto& part : object.parts) checkMakesPoints(*part);
}

constexpr std::uint32_t kMaxSide = 16384;  // of views and RSMs

std::uint64_t estimateWith(const TechniqueEntry& entry, const std::vector<std::uint64_t>& descriptor,
                           const std::vector<std::shared_ptr<TechniqueObject>>& parts, const LWViewDesc& view,
                           const FrameShape& shape) {
    std::uint64_t total = entry.estimateBytes(descriptor.data(), view, shape);
    for (const auto& part : parts) total += estimateWith(*part->entry, part->descriptor, part->parts, view, shape);
    return total;
}

void estimate(Call& call, const char* name, const void* desc, const LWViewDesc* view, FrameShape shape,
              std::uint64_t* bytes) {
    if (!bytes) fail(LW_ERROR_INVALID_ARGUMENT, "bytes: expected an address, got null");
    const TechniqueEntry& entry = findTechniqueEntry(name);
    const auto descriptor = readDescriptor(entry, desc);
    const LWViewDesc own = readStruct(view, "view");
    if (own.maxWidth == 0 || own.maxHeight == 0 || own.maxWidth > kMaxSide || own.maxHeight > kMaxSide)
        fail(LW_ERROR_INVALID_ARGUMENT, "view: expected 1 .. ", kMaxSide, " pixels a side, got ",
             own.maxWidth, " x ", own.maxHeight);
    shape.uploads = !call.owner()->device.unifiedMemory();
    *bytes = estimateWith(entry, descriptor, partsOf(call, entry, descriptor), own, shape);
}

}  // namespace

std::uint32_t lwCountTechniques(void) {
    return std::uint32_t(techniqueEntries().size());
}

LWStatus lwDescribeTechnique(std::uint32_t index, LWTechniqueInfo* info) {
    return enter("lwDescribeTechnique", [&](Call&) {
        const std::uint32_t size = checkedStructSize(info, "info");
        const auto& entries = techniqueEntries();
        if (index >= entries.size())
            fail(LW_ERROR_INVALID_ARGUMENT, "index: expected less than ", entries.size(), ", got ",
                 index);
        writeStruct(info, size, entries[index].info);
    });
}

LWStatus lwCreateTechnique(LWDevice device, const char* name, const void* desc, LWTechnique* technique) {
    return createTechnique("lwCreateTechnique", device, name, desc, technique);
}

LWStatus lwCreateRsm(LWDevice device, const LWRsmDesc* desc, LWTechnique* technique) {
    return createTechnique("lwCreateRsm", device, "rsm", desc, technique);
}

LWStatus lwCreateSsvp(LWDevice device, const LWSsvpDesc* desc, LWTechnique* technique) {
    return createTechnique("lwCreateSsvp", device, "ssvp", desc, technique);
}

LWStatus lwCreateFallback(LWDevice device, const LWFallbackDesc* desc, LWTechnique* technique) {
    return createTechnique("lwCreateFallback", device, "fallback", desc, technique);
}

LWStatus lwCreateScreenSpace(LWDevice device, const LWScreenSpaceDesc* desc, LWTechnique* technique) {
    return createTechnique("lwCreateScreenSpace", device, "screen_space", desc, technique);
}

LWStatus lwCreateHorizon(LWDevice device, const LWHorizonDesc* desc, LWTechnique* technique) {
    return createTechnique("lwCreateHorizon", device, "horizon", desc, technique);
}

LWStatus lwCreateAo(LWDevice device, const LWAoDesc* desc, LWTechnique* technique) {
    return createTechnique("lwCreateAo", device, "ao", desc, technique);
}

LWStatus lwCreateLpv(LWDevice device, const LWLpvDesc* desc, LWTechnique* technique) {
    return createTechnique("lwCreateLpv", device, "lpv", desc, technique);
}

LWStatus lwCreateConeTracing(LWDevice device, const LWConeTracingDesc* desc, LWTechnique* technique) {
    return createTechnique("lwCreateConeTracing", device, "cone_tracing", desc, technique);
}

LWStatus lwRetainTechnique(LWTechnique technique) {
    return enter("lwRetainTechnique",
                 [&](Call&) { retainHandle(HandleKind::kTechnique, technique, "technique"); });
}

LWStatus lwReleaseTechnique(LWTechnique technique) {
    return enter("lwReleaseTechnique", [&](Call& call) {
        auto object = std::static_pointer_cast<TechniqueObject>(
            releaseHandle(HandleKind::kTechnique, technique, "technique"));
        if (object) call.dispose(std::move(object));
    });
}

LWStatus lwEstimateMemory(LWDevice device, const char* name, const void* desc, const LWViewDesc* view,
                          std::uint64_t rsmTexels, std::uint64_t* bytes) {
    return enter("lwEstimateMemory", [&](Call& call) {
        call.device(device);
        constexpr std::uint64_t kMaxTexels = std::uint64_t(1) << 40;  // products with it stay in 64 bits
        if (rsmTexels > kMaxTexels)
            fail(LW_ERROR_INVALID_ARGUMENT, "rsmTexels: expected fewer texels than a frame may have, got ",
                 rsmTexels);
        FrameShape shape;
        // A square map, or the next smaller square and the rows for the rest.
        const auto side = std::uint64_t(std::ceil(std::sqrt(double(rsmTexels))));
        if (side) shape.addMap(side, (rsmTexels + side - 1) / side);
        estimate(call, name, desc, view, shape, bytes);
    });
}

LWStatus lwEstimateFrameMemory(LWDevice device, const char* name, const void* desc, const LWViewDesc* view,
                               const LWFrame* frame, std::uint64_t* bytes) {
    return enter("lwEstimateFrameMemory", [&](Call& call) {
        call.device(device);
        const FrameArgument own(call, frame);
        FrameShape shape;
        shape.vplCount = own.get().vplCount;
        if (own.get().geometry) {
            shape.triangles = own.get().geometry->triangleCount;
            shape.surfels = own.get().geometry->surfelCount;
        }
        for (std::uint32_t i = 0; i < own.get().sourceViewCount; ++i) {
            const LWImage& image = own.get().sourceViews[i].gbuffer->normal;
            if (image.width > kMaxSide || image.height > kMaxSide)
                fail(LW_ERROR_INVALID_ARGUMENT, "frame.sourceViews[", i, "].gbuffer.normal: expected at most ", kMaxSide,
                     " pixels a side, got ", image.width, " x ", image.height);
            shape.sources.emplace_back(image.width, image.height);
            shape.sourcePixels += (std::uint64_t(image.width) + 15) / 16 * 16 * image.height;
        }
        for (std::uint32_t l = 0; l < own.get().lightCount; ++l)
            for (std::uint32_t r = 0; r < own.get().lights[l].rsmCount; ++r) {
                const LWImage& flux = own.get().lights[l].rsms[r].flux;
                if (flux.width == 0 || flux.height == 0 || flux.width > kMaxSide || flux.height > kMaxSide)
                    fail(LW_ERROR_INVALID_ARGUMENT, "frame.lights[", l, "].rsms[", r, "].flux: expected 1 .. ",
                         kMaxSide, " pixels a side, got ", flux.width, " x ", flux.height);
                shape.addMap(flux.width, flux.height);
            }
        estimate(call, name, desc, view, shape, bytes);
    });
}

LWStatus lwPrewarm(LWTechnique technique, LWView view) {
    return enter("lwPrewarm", [&](Call& call) {
        const auto object = call.technique(technique);
        const auto own = call.viewOfDevice(view, "view");
        FrameRecord scratch(call.owner()->device);  // its times belong to no frame
        object->technique->prewarm(scratch.executor, own);
        call.settle();
    });
}

LWStatus lwUpdate(LWTechnique technique, const LWFrame* frame) {
    return enter("lwUpdate", [&](Call& call) {
        const auto object = call.technique(technique);
        Device& device = call.owner()->device;
        const FrameArgument own(call, frame);
        const SyncArgument sync(own.get().sync, device.context(), "frame.sync");
        device.raiseFailure();
        auto record = std::make_unique<FrameRecord>(device);
        object->begun = true;
        try {
            record->executor.waitFor(sync.get());
            object->technique->update(record->executor, own.get());
            record->executor.signal(sync.get());
            record->executor.flush();
        } catch (const Error& error) {
            if (!refusedUnchanged(error.status())) object->breakOff();
            throw;
        } catch (...) {
            object->breakOff();
            throw;
        }
        object->setBroken(false);
        object->record = std::move(record);
        object->frameIndex = own.get().frameIndex;
        object->updated = true;
        object->failures = device.failures();
    });
}

LWStatus lwRender(LWTechnique technique, LWView view, const LWGBuffer* gbuffer, const LWOutput* output) {
    return enter("lwRender", [&](Call& call) {
        const auto object = call.technique(technique);
        const auto own = call.viewOfDevice(view, "view");
        const LWGBuffer ownGBuffer = readStruct(gbuffer, "gbuffer");
        const LWOutput ownOutput = readStruct(output, "output");
        checkOutput(ownOutput);
        const SyncArgument sync(ownOutput.sync, call.owner()->device.context(), "output.sync");
        light(*object, sync.get(), [&] { object->technique->render(object->record->executor, own, ownGBuffer, ownOutput); });
    });
}

LWStatus lwRenderPoints(LWTechnique technique, const LWImage* positions, const LWImage* normals, std::uint32_t count,
                        const LWPointOutput* output) {
    return enter("lwRenderPoints", [&](Call& call) {
        const auto object = call.technique(technique);
        const PointsArgument own(positions, normals, count, output);
        const SyncArgument sync(own.get().output.sync, call.owner()->device.context(), "output.sync");
        checkMakesPoints(*object);
        light(*object, sync.get(), [&] { object->technique->renderPoints(object->record->executor, own.get()); });
    });
}
