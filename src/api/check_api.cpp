// Entry points: checking inputs.
#include <algorithm>
#include <cstring>

#include "api/call.h"
#include "api/frame_arguments.h"
#include "api/structs.h"
#include "compute/raw_enum.h"
#include "inputs/image_check.h"
#include "inputs/input_check.h"

using namespace lightwell;

namespace {

bool sameImage(const LWImage& a, const LWImage& b) {
    return a.host == b.host && a.clMem == b.clMem && rawEnum(a.format) == rawEnum(b.format) &&
           a.byteOffset == b.byteOffset && a.byteRowStride == b.byteRowStride &&
           a.bytePixelStride == b.bytePixelStride && a.bytePlaneStride == b.bytePlaneStride;
}

// The same pixels seen by the same cameras.
bool sameGBuffer(const LWGBuffer& a, const LWGBuffer& b) {
    for (LWImage LWGBuffer::*image :
         {&LWGBuffer::position, &LWGBuffer::depth, &LWGBuffer::normal, &LWGBuffer::albedo,
          &LWGBuffer::directRadiance, &LWGBuffer::roughness, &LWGBuffer::motion,
          &LWGBuffer::receiveMask})
        if (!sameImage(a.*image, b.*image)) return false;
    return rawEnum(a.depthKind) == rawEnum(b.depthKind) &&
           std::memcmp(&a.camera, &b.camera, sizeof a.camera) == 0 &&
           std::memcmp(&a.previousCamera, &b.previousCamera, sizeof a.previousCamera) == 0;
}

}  // namespace

std::uint32_t lwCountInputFaults(void) {
    return std::uint32_t(inputFaults().size());
}

LWStatus lwDescribeInputFault(std::uint32_t index, LWInputFaultInfo* info) {
    return enter("lwDescribeInputFault", [&](Call&) {
        const std::uint32_t size = checkedStructSize(info, "info");
        if (index >= inputFaults().size())
            fail(LW_ERROR_INVALID_ARGUMENT, "index: expected 0 .. ", inputFaults().size() - 1, ", got ",
                 index);
        writeStruct(info, size, inputFaults()[index]);
    });
}

LWStatus lwCheckInputs(LWView view, const LWFrame* frame, const LWGBuffer* gbuffer,
                       LWInputFinding* findings, std::uint32_t capacity, std::uint32_t* count,
                       const LWImage* overlay) {
    return enter("lwCheckInputs", [&](Call& call) {
        const auto object = call.view(view);
        if (!count)
            fail(LW_ERROR_INVALID_ARGUMENT,
                 "count: expected an address for the number of findings, got null");
        *count = 0;
        if (capacity > 0 && !findings)
            fail(LW_ERROR_INVALID_ARGUMENT, "findings: expected room for ", capacity,
                 " findings, got null");
        if (!frame && !gbuffer)
            fail(LW_ERROR_INVALID_ARGUMENT, "frame, gbuffer: expected at least one, got null");
        // As everywhere, an image of which nothing is set is none.
        if (overlay && imageAbsent(*overlay)) overlay = nullptr;
        if (overlay && !gbuffer)
            fail(LW_ERROR_INVALID_ARGUMENT, "overlay: expected a gbuffer to draw it over, got null");

        std::unique_ptr<FrameArgument> ownFrame;
        if (frame) ownFrame = std::make_unique<FrameArgument>(call, frame);
        const LWFrame* const checkedFrame = ownFrame ? &ownFrame->get() : nullptr;
        LWGBuffer ownGBuffer{};
        std::vector<std::shared_ptr<View>> held;  // of the source views
        std::vector<std::string> names;
        std::vector<CheckedView> views;
        if (gbuffer) {
            ownGBuffer = readStruct(gbuffer, "gbuffer");
            views.push_back({object->view.get(), &ownGBuffer, "gbuffer"});
        }
        const std::uint32_t sources = checkedFrame ? checkedFrame->sourceViewCount : 0;
        names.reserve(sources);
        for (std::uint32_t i = 0; i < sources; ++i) {
            const LWSourceView& source = checkedFrame->sourceViews[i];
            names.push_back("frame.sourceViews[" + std::to_string(i) + "].gbuffer");
            held.push_back(call.viewOfDevice(source.view, names.back().c_str()));
            // The view's own G-buffer, handed over twice as is usual.
            const bool again =
                gbuffer && source.view == view && sameGBuffer(*source.gbuffer, ownGBuffer);
            if (!again) views.push_back({held.back().get(), source.gbuffer, names.back().c_str()});
        }
        const SyncArgument sync(checkedFrame ? checkedFrame->sync : nullptr,
                                call.owner()->device.context(), "frame.sync");

        FrameRecord record(call.owner()->device);
        record.executor.waitFor(sync.get());
        std::vector<LWInputFinding> found;
        try {
            found = checkInputs(record.executor, checkedFrame, views, overlay);
            record.executor.signal(sync.get());
            record.executor.flush();
        } catch (...) {
            record.executor.forgetWaits();
            clFinish(
                call.owner()->device.queue());  // what is still being read must not outlive its memory
            throw;
        }
        std::copy_n(found.begin(), std::min<std::size_t>(capacity, found.size()), findings);
        *count = std::uint32_t(found.size());
    });
}
