// Technique static_vpl's spot lights that have phantoms: which, and where their axes meet the scene.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compute/report.h"
#include "inputs/rsm_input.h"
#include "shared/static_vpl_types.h"
#include "techniques/technique.h"

namespace lightwell {

class StaticVplPhantoms {
public:
    explicit StaticVplPhantoms(bool wanted) : wanted_(wanted) {}

    // Throws what import() would say of this frame.
    void check(Device& device, const LWFrame& frame) const;
    // Records the unpacking of the middle texels of these lights' maps.
    void import(Executor& executor, const LWFrame& frame);

    const std::vector<lw_phantom>& phantoms() const { return phantoms_; }
    // They are other lights' than those of the import before.
    bool changed() const { return changed_; }
    Planes texels() const { return phantoms_.empty() || !fromMaps_ ? Planes{} : rsms_.texels; }
    std::vector<LWChoice> choices(const LWFrame& frame) const;
    std::uint64_t bytes() const { return rsms_.bytes(); }
    static std::uint64_t estimateBytes(const FrameShape& shape);

private:
    bool wanted_, fromMaps_ = false, changed_ = false;
    RsmInput rsms_;
    std::vector<lw_phantom> phantoms_;
};

}  // namespace lightwell
