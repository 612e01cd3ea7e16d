// The host's own surfels on the device.
#pragma once

#include <array>
#include <cstdint>

#include "compute/executor.h"
#include "compute/report.h"
#include "inputs/surfel_set.h"
#include "lightwell/lightwell.h"

namespace lightwell {

class SurfelInput {
public:
    // Throws what import() would say of this geometry (null: none) when it is new.
    static void check(Device& device, const LWGeometry* geometry, bool withEmission = false);

    // Brings the surfels to the device (passes "surfel_input.*") when the geometry's version, an image, the count or the
    // executor's origin differs from the last. Surfels without a normal are none; those with a position out of reach, a normal that cannot be
    // normalised, an area that is not above 0 or an albedo beyond 0 .. 1 are left out and counted. withEmission: what they
    // emit too, if the host says so; those whose emission is below 0, above LW_LARGEST_EMISSION or no number are left out.
    void import(Executor& executor, const LWGeometry* geometry, bool withEmission = false);
    void forget() { key_ = Key{}; }  // the next import() brings all again, whatever its key

    SurfelSet surfels() const { return memory_.set(); }
    void report(Report& report) const;  // surfels, rejected_surfels
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(std::uint32_t surfelCount, bool uploads, bool withEmission = false);

private:
    struct Key {
        std::array<const void*, 5> images{};
        std::uint32_t count = 0;
        std::uint64_t version = 0;
        bool operator==(const Key& other) const {
            return images == other.images && count == other.count && version == other.version;
        }
    };
    static Key keyOf(const LWGeometry* geometry, bool withEmission);

    SurfelMemory memory_;
    std::array<Buffer, 5> staging_;  // uploads
    Key key_;
    WorldOrigin origin_{};  // of the last import
    Device* device_ = nullptr;  // of the last import that had surfels
};

}  // namespace lightwell
