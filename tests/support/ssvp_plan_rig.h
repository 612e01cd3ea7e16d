// What tests of pass `ssvp_plan` ask of a plan, and how much of it they ask on slow drivers.
#pragma once

#include <string>
#include <vector>

#include "passes/ssvp_plan.h"
#include "support/kernel_rig.h"

namespace lightwell::test {

// Oclgrind takes thousands of times as long: fewer clusters, VPLs, frames and targets there.
inline bool isSlow() {
    return testSize({1024, 1}).first < 1024;
}
inline std::uint32_t mostClusters() {
    return isSlow() ? 6 : 32;
}
inline std::size_t someVpls() {
    return isSlow() ? 48 : 256;
}
inline int someFrames(int frames, int few) {
    return isSlow() ? few : frames;
}
inline std::vector<float> targets() {
    return isSlow() ? std::vector<float>{0.4f} : std::vector<float>{0.05f, 0.1f, 0.2f, 0.4f, 0.8f};
}

struct Used {
    std::uint32_t vpls = 0, clusters = 0, bounces = 0;
    std::string whyVpls, whyClusters, whyBounces;
};

inline Used usedBy(KernelRig& rig, const SsvpPlan& plan) {
    Report report;
    plan.report(report);
    rig.device().finish();
    report.resolve();
    Used used;
    for (const LWCount& count : report.counts) {
        if (std::string(count.name) == "vpls_used") used.vpls = std::uint32_t(count.value);
        if (std::string(count.name) == "clusters_used") used.clusters = std::uint32_t(count.value);
        if (std::string(count.name) == "bounces_used") used.bounces = std::uint32_t(count.value);
    }
    for (const LWChoice& choice : report.choices) {
        if (std::string(choice.name) == "vpls_used") used.whyVpls = choice.reason;
        if (std::string(choice.name) == "clusters_used") used.whyClusters = choice.reason;
        if (std::string(choice.name) == "bounces_used") used.whyBounces = choice.reason;
    }
    return used;
}

inline SsvpPlanOptions optionsOf(float error) {
    SsvpPlanOptions options;
    options.error = error;
    options.vpls = 256;
    options.clusters = mostClusters();
    options.bounces = 4;
    return options;
}

}  // namespace lightwell::test
