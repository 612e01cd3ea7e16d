// See photon_gather.h.
#include "photon_gather.h"

#include <cmath>

#include "simd_clones.h"

namespace studio {
namespace {

// Rays end short of the VPL by this share of their length, beyond the offset off its surface.
constexpr float kShort = 1e-5f;

struct Row {
    const float *px, *py, *pz, *nx, *ny, *nz;
    int count;
};

// Plain arrays and no calls but a square root: vector code.
STUDIO_SIMD bool weighRow(const Row& row, const VplRecord& vpl, float* weight) {
    const float x = vpl.position.x, y = vpl.position.y, z = vpl.position.z;
    const float a = vpl.normal.x, b = vpl.normal.y, c = vpl.normal.z;
    const float area = 0.25f * vpl.area;
    unsigned any = 0;  // a maximum would not be vector code
    for (int i = 0; i < row.count; ++i) {
        const float dx = x - row.px[i], dy = y - row.py[i], dz = z - row.pz[i];
        const float d2 = dx * dx + dy * dy + dz * dz;
        const float facing = row.nx[i] * dx + row.ny[i] * dy + row.nz[i] * dz;
        const float sending = -(a * dx + b * dy + c * dz);
        // c_p c = sending facing / d^2; at the VPL itself both are 0 and so is the weight.
        const float inverse = d2 > 0.0f ? 1.0f / d2 : 0.0f;
        const float cosines = facing > 0.0f && sending > 0.0f ? facing * sending * inverse : 0.0f;
        const float bound = kPi * d2 + area * (1.0f + 3.0f * sending * sending * inverse);
        const float w = cosines > 0.0f ? cosines / bound : 0.0f;
        weight[i] = w;
        any |= w > 0.0f ? 1u : 0u;
    }
    return any != 0;
}

STUDIO_SIMD void addRow(const float* weight, int count, float r, float g, float b, float* red, float* green,
                        float* blue) {
    for (int i = 0; i < count; ++i) {
        red[i] += r * weight[i];
        green[i] += g * weight[i];
        blue[i] += b * weight[i];
    }
}

}  // namespace

void PhotonGather::begin(const GBuffer& gbuffer, int y) {
    count_ = gbuffer.width;
    weight_.assign(std::size_t(count_), 0.0f);
    for (int c = 0; c < 3; ++c) {
        position_[c] = gbuffer.position.row(c, y);
        normal_[c] = gbuffer.normal.row(c, y);
        sum_[c].assign(std::size_t(count_), 0.0f);
    }
}

bool PhotonGather::weigh(const VplRecord& vpl) {
    const Row row{position_[0], position_[1], position_[2], normal_[0], normal_[1], normal_[2], count_};
    return weighRow(row, vpl, weight_.data());
}

std::uint64_t PhotonGather::shadow(const RayScene& scene, const VplRecord& vpl) {
    const glm::vec3 end = scene.offset(vpl.position, vpl.normal);
    std::uint64_t rays = 0;
    for (int i = 0; i < count_; ++i) {
        if (weight_[std::size_t(i)] <= 0.0f) continue;
        // The G-buffer knows no face: off along the shading normal, from where a face that hides the VPL
        // stands in the ray's way like any other.
        const glm::vec3 origin = scene.offset({position_[0][i], position_[1][i], position_[2][i]},
                                              {normal_[0][i], normal_[1][i], normal_[2][i]});
        const glm::vec3 way = end - origin;
        const float distance = glm::length(way);
        if (!(distance > 0.0f)) continue;
        ++rays;
        if (scene.occluded(origin, way / distance, 0.0f, distance * (1.0f - kShort)))
            weight_[std::size_t(i)] = 0.0f;
    }
    return rays;
}

void PhotonGather::add(const VplRecord& vpl) {
    addRow(weight_.data(), count_, vpl.flux.x, vpl.flux.y, vpl.flux.z, sum_[0].data(), sum_[1].data(),
           sum_[2].data());
}

void PhotonGather::end(PlanarBuffer& irradiance, PlanarBuffer& validity, int y) const {
    for (int i = 0; i < count_; ++i) {
        const bool isSurface = normal_[0][i] != 0.0f || normal_[1][i] != 0.0f || normal_[2][i] != 0.0f;
        validity.row(0, y)[i] = isSurface ? 1.0f : 0.0f;
        for (int c = 0; c < 3; ++c)
            irradiance.row(c, y)[i] = isSurface ? sum_[c][std::size_t(i)] : 0.0f;
    }
}

std::uint64_t PhotonGather::bytes() const {
    return (weight_.capacity() + sum_[0].capacity() + sum_[1].capacity() + sum_[2].capacity()) *
           sizeof(float);
}

}  // namespace studio
