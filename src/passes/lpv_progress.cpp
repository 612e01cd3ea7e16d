#include "passes/lpv_progress.h"

#include <algorithm>

#include "compute/device.h"
#include "passes/lpv_propagation.h"
#include "shared/lpv_types.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "lpv_propagation/lpv_progress";

std::uint64_t sumBytes(std::uint32_t size) { return std::uint64_t(LW_LPV_COLOURS) * size * sizeof(cl_float2); }

}  // namespace

LpvProgress::LpvProgress(Device& device, std::uint32_t size, std::uint32_t steps, float target, bool isBlocked)
    : device_(device),
      size_(size),
      target_(target),
      sum_(device.programs().kernel(kProgram, "lpv_progress_sum")),
      decide_(device.programs().kernel(kProgram, "lpv_progress_decide")) {
    constexpr std::uint32_t kLook = LW_LPV_LOOK;
    for (std::uint32_t taken = 0; taken < steps;) {
        const std::uint32_t most = taken == 0 && steps % 2 ? kLook - 1 : kLook;
        chunks_.push_back(std::min(most, steps - taken));
        taken += chunks_.back();
        taken_.push_back(taken);
    }
    const std::vector<double> calibrations = LpvPropagation::calibrations(size, taken_, isBlocked);
    for (const double calibration : calibrations) scales_.push_back(float(calibration / calibrations.back()));
}

void LpvProgress::begin(Executor& executor) {
    state_.reserve(device_, sizeof(LwLpvProgress), "progress of steps");
    sums_.reserve(device_, std::size_t(sumBytes(size_)), "light that still moves");
    executor.fill("lpv_propagation.look", state_, 0, 0, state_.bytes());
}

void LpvProgress::look(Executor& executor, std::size_t chunk, const Buffer& injected, const Buffer& before, const Buffer& now) {
    executor.run("lpv_propagation.look", sum_, {LW_LPV_COLOURS * std::size_t(size_), 1}, {1, 1}, injected, before, now, cl_int(size_),
                 state_, sums_);
    executor.run("lpv_propagation.look", decide_, {1, 1}, {1, 1}, sums_, cl_int(size_), cl_int(taken_[chunk]), scales_[chunk],
                 target_, state_);
}

std::uint64_t LpvProgress::estimateBytes(std::uint32_t size) { return sizeof(LwLpvProgress) + sumBytes(size); }

}  // namespace lightwell
