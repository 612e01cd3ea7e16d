// Entry points: techniques and frames.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "api/call.h"
#include "api/frame_arguments.h"
#include "api/parameters.h"
#include "api/structs.h"
#include "compute/raw_enum.h"
#include "techniques/from_text.h"

using namespace lightwell;

namespace {

// With its parts; `object->entry` and `object->descriptor` are set.
void makeTechniqueOf(TechniqueObject& object, Device& device) {
    std::vector<std::shared_ptr<Technique>> parts;  // each keeps its handle's object alive
    for (const auto& part : object.parts) parts.emplace_back(part, part->technique.get());
    object.technique = object.entry->join ? object.entry->join(device, parts) : object.entry->create(device, object.descriptor.data());
}

std::shared_ptr<TechniqueObject> objectOf(const std::shared_ptr<DeviceObject>& device, const TechniqueText& text) {
    auto object = std::make_shared<TechniqueObject>();
    object->device = device;
    object->entry = text.entry;
    object->descriptor = text.descriptor;
    for (const TechniqueText& part : text.parts) object->parts.push_back(objectOf(device, part));
    makeTechniqueOf(*object, device->device);
    return object;
}

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
        makeTechniqueOf(*object, own);
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

// Names of the techniques whose description says yes to `makes`.
template <class Makes>
std::string techniquesThat(Makes makes) {
    std::string names;
    for (const TechniqueEntry& entry : techniqueEntries())
        if (makes(entry.info)) names += (names.empty() ? "" : ", ") + std::string(entry.info.name);
    return names.empty() ? "none" : names;
}

// Of it and of all of its parts.
void checkMakesPoints(const TechniqueObject& object) {
    if (!object.entry->info.points) {
        fail(LW_ERROR_UNSUPPORTED, "technique: ", object.entry->info.name,
             " takes its light from a view's own pixels and has none at points; techniques that have: ",
             techniquesThat([](const LWTechniqueInfo& info) { return info.points != 0; }));
    }
    for (const auto& part : object.parts) checkMakesPoints(*part);
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

LWStatus lwCreateTechniqueFromText(LWDevice device, const char* name, const char* settings, LWTechnique* technique) {
    return enter("lwCreateTechniqueFromText", [&](Call& call) {
        call.device(device);
        if (!technique)
            fail(LW_ERROR_INVALID_ARGUMENT, "technique: expected an address for the handle, got null");
        *technique = nullptr;
        if (!name) fail(LW_ERROR_INVALID_ARGUMENT, "name: expected a technique's name, got null");
        const TechniqueText text = parseTechnique(name, settings ? settings : "");
        *technique = static_cast<LWTechnique>(addHandle(HandleKind::kTechnique, objectOf(call.owner(), text)));
    });
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

LWStatus lwCreateStaticVpl(LWDevice device, const LWStaticVplDesc* desc, LWTechnique* technique) {
    return createTechnique("lwCreateStaticVpl", device, "static_vpl", desc, technique);
}

LWStatus lwCreateAuto(LWDevice device, const LWAutoDesc* desc, LWTechnique* technique) {
    return createTechnique("lwCreateAuto", device, LW_TECHNIQUE_AUTO, desc, technique);
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
            const double(&origin)[3] = own.get().worldOrigin;
            record->executor.setWorldOrigin({origin[0], origin[1], origin[2]});
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
        object->setOrigin(object->record->executor.worldOrigin());
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

LWStatus lwReadLightList(LWTechnique technique, LWListedLight* lights, std::uint32_t capacity, std::uint32_t* count) {
    return enter("lwReadLightList", [&](Call& call) {
        const auto object = call.technique(technique);
        if (!count) fail(LW_ERROR_INVALID_ARGUMENT, "count: expected an address, got null");
        if (capacity > 0 && !lights) fail(LW_ERROR_INVALID_ARGUMENT, "lights: expected an array of ", capacity, ", got null");
        if (!object->entry->info.lightList)
            fail(LW_ERROR_UNSUPPORTED, "technique: ", object->entry->info.name, " does not list lights; techniques that do: ",
                 techniquesThat([](const LWTechniqueInfo& info) { return info.lightList != 0; }));
        std::vector<LWListedLight> listed(object->technique->listedLights());
        Device& device = call.owner()->device;
        try {
            light(*object, nullptr, [&] { object->technique->readLightList(object->record->executor, listed.data()); });
            call.wait();
        } catch (...) {
            clFinish(device.queue());  // `listed` must not be written after this call
            throw;
        }
        device.settle();
        listed.erase(std::remove_if(listed.begin(), listed.end(), [](const LWListedLight& one) { return one.vpls == 0; }),
                     listed.end());
        if (capacity < listed.size())
            fail(LW_ERROR_INVALID_ARGUMENT, "capacity: expected at least ", listed.size(), " lights, got ", capacity);
        std::copy(listed.begin(), listed.end(), lights);
        *count = std::uint32_t(listed.size());
    });
}
