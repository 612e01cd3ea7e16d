// The path tracer's estimate of extended lights (area_lights.cpp), averaged for the direct term of a
// G-buffer: a point on an emitter and a cosine-distributed ray for each sample.
#include "emitters.h"

namespace studio {
namespace {

constexpr std::uint64_t kSeed = 0x656d697474657273u;  // any; not the path tracer's

}  // namespace

glm::vec3 EmitterSet::irradiance(const glm::vec3& position, const glm::vec3& geometricNormal,
                                 const glm::vec3& normal, std::uint32_t pixel) const {
    glm::vec3 sum(0.0f);
    for (int i = 0; i < kSamples; ++i) {
        Sampler sampler(kSeed, pixel, std::uint32_t(i));
        sum += extendedIrradiance(scene_, lights_, {position, geometricNormal, normal}, sampler);
    }
    return sum / float(kSamples);
}

}  // namespace studio
