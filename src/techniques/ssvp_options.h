// What technique ssvp's descriptor asks of each pass.
#pragma once

#include <cstddef>
#include <cstdint>

#include "inputs/frame_shape.h"
#include "lightwell/lightwell.h"
#include "passes/clustered_gather.h"
#include "passes/kmeans.h"
#include "passes/second_bounce.h"
#include "passes/ssvp_plan.h"
#include "passes/vpl_sampling.h"
#include "techniques/interleaved_view.h"
#include "techniques/occluder_maps.h"

namespace lightwell {

VplSamplingOptions samplingOptions(const LWSsvpDesc& desc);
std::uint32_t settlingOf(const LWSsvpDesc& desc);  // updates of the same light and geometry in which clusters come to rest
// Of bounce `stage` + 1.
KMeansOptions clusterOptions(const LWSsvpDesc& desc, std::size_t stage);
SecondBounceOptions nextOptions(const LWSsvpDesc& desc, std::size_t stage);
InterleavedOptions interleavedOptions(const LWSsvpDesc& desc);
CompensationOptions compensationOptions(const LWSsvpDesc& desc);  // of one that compensates
OccluderOptions occluderOptions(const LWSsvpDesc& desc);
SsvpPlanOptions planOptions(const LWSsvpDesc& desc);  // of one with an error target
std::uint32_t groupsOf(const LWSsvpDesc& desc);
bool looksStrictly(const LWSsvpDesc& desc);  // strictly or carefully
bool bearsOut(const LWSsvpDesc& desc);  // light of bounces without shadows counts as far as shadowed light bears it out, at least a quarter
// Bounces whose VPLs are shadowed, and those whose VPLs have clusters.
std::size_t shadowedOf(const LWSsvpDesc& desc);
std::size_t stagesOf(const LWSsvpDesc& desc);
// As TechniqueEntry::estimateBytes.
std::uint64_t estimateSsvpBytes(const void* desc, const LWViewDesc& view, const FrameShape& shape);

}  // namespace lightwell
