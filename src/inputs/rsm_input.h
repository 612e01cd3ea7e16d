// All RSMs of a frame's lights as one set of texel planes with flux and area, in the units of the
// library: what VPLs are drawn from.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "compute/report.h"
#include "inputs/frame_shape.h"
#include "lightwell/lightwell.h"
#include "shared/rsm_types.h"

namespace lightwell {

// One RSM's place in the set.
struct RsmSpan {
    std::uint32_t light;       // index in LWFrame::lights
    std::uint32_t firstTexel;  // in the planes, a multiple of 16
    std::uint32_t firstRow;    // in the table of rows
    std::uint32_t width, height;
};

// Throws INVALID_ARGUMENT naming `name`.kind or `name`.rsmCount: more maps than a light of this kind can have.
void checkLightKind(const LWLight& light, const std::string& name);

class RsmInput {
public:
    // Planes of `texels`: consecutive rows of all RSMs, each row padded to 16 texels with zero flux.
    enum Plane {
        kPositionX,
        kPositionY,
        kPositionZ,
        kNormalX,
        kNormalY,
        kNormalZ,
        kFluxR,
        kFluxG,
        kFluxB,
        kArea,
        kPlaneCount
    };

    RsmInput();
    ~RsmInput();

    // Throws what import() would say of this frame.
    static void check(Device& device, const LWFrame& frame);
    // Records the unpacking of every RSM (passes "rsm_input.*"): flux 0 and normal 0 where the host gave
    // none, gave something not finite, negative or beyond LW_LARGEST_FLUX (counted as rejected), or where
    // a finer cascade of the same directional light covers the texel; area A_p as lightwell.h's lights define it. Of maps that
    // LWRsm::version says have not changed since the last import() the texels stay.
    void import(Executor& executor, const LWFrame& frame);

    Planes texels;  // kPlaneCount planes, height 1, width = all texels with padding
    Buffer rows;    // int4 per row: first texel, width, span index, 0
    std::uint32_t rowCount = 0;
    std::uint64_t generation = 0;  // of the texels: another number after an import() that may have changed some; 0: not known
    std::uint32_t texelCount = 0;  // valid texels, padding left out (covered cascade texels included)
    std::vector<RsmSpan> spans;
    std::vector<LwRsmSpan> shapes;  // of each span, as kernels take it

    void report(Report& report) const;  // rejected_texels, covered_texels, choices
    std::uint64_t bytes() const;
    // What bytes() becomes for such a frame, and the refusal of more texels than a frame may have.
    static std::uint64_t estimateBytes(const FrameShape& shape);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace lightwell
