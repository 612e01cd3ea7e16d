// The tables that the planner reads (plan_tables.h), which docs/figures/planner.py writes from measurements.
#pragma once

#include <cstddef>
#include <cstdint>

namespace lightwell {

// What a frame must bring for a technique with these settings to be possible, or to be what its figures say: bits.
enum PlanNeeds : std::uint32_t {
    kPlanNeedsRsms = 1,        // RSMs, or VPLs of the host's
    kPlanNeedsRadiance = 2,    // LWGBuffer::directRadiance
    kPlanNeedsCamera = 4,      // LWGBuffer::camera
    kPlanNeedsGeometry = 8,    // triangles or surfels
    kPlanNeedsStaticVpls = 16, // places of the host's
    kPlanNeedsMotion = 32,     // LWGBuffer::motion: of what keeps a history
    kPlanNeedsViews = 64       // LWFrame::sourceViews
};

constexpr std::size_t kPlanProbes = 8;  // in the order of LWPlanProbes' fields

// A technique with settings that were measured.
//
//     ms = launches * (here) + computeScale * (cost[0] - launches * (there) + (cost[1] + cost[4] * facing) * views * lit
//                                              + cost[2] * Mtriangles)
//          + memoryScale * cost[3] * Mtexels
//
// at rest, where the host tells so, less computeScale * rest[0], with rest[1] * cost[3] in the place of cost[3], and no more than that;
// and, in a frame whose lights or geometry moved, computeScale * maps * (fixed + perMtriangles * Mtriangles) of kPlanMaps.
//
// with lit = Mpixels * (cost[5] + (1 - cost[5]) * coverage), and (here) and (there) the milliseconds of a launch on this device and on the one that was measured, scales of 1 there;
// triangles: and surfels, texels: of all RSMs; the probes facing, of pairs that a gather has work with, and coverage, of pixels that show a
// surface. All of `cost` are 0 or more.
//
//     log10 relMSE = errorMean + sum over probes of errorSlopes * z,   with a standard deviation of errorSigma
struct PlanRow {
    const char* technique;
    const char* settings;  // as lwCreateTechniqueFromText takes them
    std::uint32_t needs;
    double launches;  // of kernels in a frame; 0: not known
    double maps;      // of 128 x 128 texels that it draws where lights or geometry moved, and keeps where not
    // ms; ms per million pixels with a surface, per million triangles, per million texels, per million such pixels with facing = 1; and what a
    // pixel without a surface takes, as a share of what one with takes.
    double cost[6];
    double rest[2];  // at rest: ms that are saved beyond cost[3] (less than 0: by so much it is too large), and the share of cost[3] that is not
    double errorMean;
    double errorSlopes[kPlanProbes];
    double errorSigma;
};

// z = (log10(max(probe, floor)) - mean) / deviation, not below `lowest`, not above `highest`; 0 for a probe that is NaN.
struct PlanProbeScale {
    const char* name;  // LWPlanProbes' field
    double floor, mean, deviation, lowest, highest;
};

// ms of a map of 128 x 128 texels, and what a million triangles and surfels add to it.
struct PlanMaps {
    double fixed, perMtriangles;
};

// Of the device that the costs were measured on, as `lightwell devices --probe` has them; and the probes `facing` and `coverage` of a frame
// that does not tell them: the means of the views that were measured.
struct PlanReference {
    const char* device;
    double multiplyAddGflops, bandwidthGBps, launchMicroseconds, usualFacing, usualCoverage;
};

}  // namespace lightwell
