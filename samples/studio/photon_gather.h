// A row of pixels before one VPL after another, on the host's vector units.
#pragma once

#include <vector>

#include "gbuffer.h"
#include "path_tracer.h"

namespace studio {

class PhotonGather {
public:
    void begin(const GBuffer& gbuffer, int y);
    // Weights of the row's pixels by the bounded geometry term of docs/techniques/rsm.md:
    //     c_p c / (pi d^2 + (1 + 3 c_p^2)/4 A).
    // False where all are zero.
    bool weigh(const VplRecord& vpl);
    // Takes the weights of pixels that do not see the VPL; returns how many rays that took.
    std::uint64_t shadow(const RayScene& scene, const VplRecord& vpl);
    void add(const VplRecord& vpl);
    void end(PlanarBuffer& irradiance, PlanarBuffer& validity, int y) const;
    std::uint64_t bytes() const;

private:
    int count_ = 0;
    const float* position_[3] = {};
    const float* normal_[3] = {};
    std::vector<float> weight_, sum_[3];
};

}  // namespace studio
