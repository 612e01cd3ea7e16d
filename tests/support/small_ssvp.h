// Technique ssvp with few VPLs, clusters and texels, for tests that run it often.
#pragma once

#include <cstdint>

#include "lightwell/lightwell.h"

namespace lightwell::test {

inline LWSsvpDesc smallSsvp(LWVisibility visibility, std::uint32_t bounces, std::uint32_t shadowed) {
    LWSsvpDesc desc;
    lwDefaultSsvp(&desc);
    desc.vpls = 64;
    desc.clusters = 8;
    desc.secondVpls = 16;
    desc.mapSize = 64;
    desc.visibility = visibility;
    desc.bounces = bounces;
    desc.shadowedBounces = shadowed;
    return desc;
}

}  // namespace lightwell::test
