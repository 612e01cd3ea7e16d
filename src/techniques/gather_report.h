// What techniques that gather from a grid report of a view's pixels alike.
#pragma once

#include "compute/buffer.h"
#include "compute/report.h"

namespace lightwell {

inline void startGatherReport(Report& report) {
    for (const char* name : {"rejected_pixels", "saturated_pixels", "pixels_outside", "upsample_fallbacks"})
        report.counts.push_back({name, 0});
}

// counts: of the gather, rejected pixels, saturated ones, those outside; upsampled: where fewer pixels were gathered, rejected pixels and
// fallbacks of the up-sampling, else null.
inline void reportGather(Device& device, Report& report, const Buffer& counts, const Buffer* upsampled) {
    // Down-sampling turns what is neither surface nor background into background; up-sampling counts it.
    report.read(device, "rejected_pixels", upsampled ? *upsampled : counts, 0);
    report.read(device, "saturated_pixels", counts, sizeof(cl_int));
    report.read(device, "pixels_outside", counts, 2 * sizeof(cl_int));
    if (upsampled) report.read(device, "upsample_fallbacks", *upsampled, sizeof(cl_int));
}

}  // namespace lightwell
