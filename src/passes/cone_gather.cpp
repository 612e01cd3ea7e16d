#include "passes/cone_gather.h"

#include <cmath>
#include <string>

#include "compute/device.h"
#include "inputs/camera.h"
#include "shared/filter_rows.h"

namespace lightwell {
namespace {

constexpr const char* kTrace = "cone_gather/cone_gather";
constexpr const char* kHarmonics = "cone_gather/cone_harmonics";
constexpr const char* kFilter = "cone_gather/cone_filter";

Range groupOf(const Kernel& kernel) {
    return kernel.width() == 1 ? Range{64, 1} : Range{4, 1};
}

ConeWindow windowOf(const ConeGatherOptions& options) {
    return options.interleaved ? coneWindow(options.cones) : ConeWindow{1, 1, options.cones};
}

// Sides of the largest grid in voxels of the finest.
double sideOf(const ConeGatherOptions& options) {
    return std::ldexp(double(options.size), int(options.cascades) - 1);
}

// Cones pixel by pixel of the window, `perPixel` of each: those of one pixel lie apart.
ConeTable tableOf(const ConeGatherOptions& options) {
    const ConeWindow window = windowOf(options);
    const std::vector<ConeDirection> set = coneHemisphere(options.cones);
    const ConeSchedule schedule = coneSchedule(options);
    const std::size_t pixels = window.columns * window.rows;
    ConeTable table;
    for (std::size_t pixel = 0; pixel < pixels; ++pixel)
        for (std::size_t k = 0; k < window.perPixel; ++k) {
            const ConeDirection& cone = set[pixel + k * pixels];
            table.add(cone, cone.d[2], schedule);
        }
    return table;
}

// Of a point, which has no surface that a cone could lie too near to.
ConeTable sphereOf(const ConeGatherOptions& options) {
    ConeSchedule schedule = coneSchedule(options);
    schedule.nudge = 0.0;
    schedule.apertureOffset = schedule.near = false;
    ConeTable table;
    for (const ConeDirection& cone : coneSphere(options.cones)) table.add(cone, 1.0, schedule);
    return table;
}

}  // namespace

ConeSchedule coneSchedule(const ConeGatherOptions& options) {
    ConeSchedule schedule;
    schedule.nudge = options.nudge;
    schedule.step = options.step;
    // No cone is longer than the grid's diagonal.
    schedule.reach = std::fmin(options.distance, std::sqrt(3.0)) * sideOf(options);
    schedule.openReach = options.occlusionDistance * sideOf(options);
    // The outermost grid has as many levels again above those of the finest.
    schedule.levels = std::uint32_t(voxel_levels(lw_int(options.size))) + options.cascades - 1;
    schedule.apertureOffset = options.apertureOffset;
    schedule.near = options.near;
    schedule.corrected = options.opacityCorrection;
    return schedule;
}

LwConeView coneView(const ConeWorld& world, const ConeGatherOptions& options) {
    LwConeView view{};
    view.environment = float4(double(world.environment[0]), double(world.environment[1]),
                              double(world.environment[2]), coneSchedule(options).reach);
    view.rough = float4(0.0, 1.0, options.nudge, 0.0);
    return view;
}

void uploadCones(Executor& executor, const ConeTable& table, Buffer& cones, Buffer& steps) {
    const std::size_t coneBytes = table.cones.size() * sizeof table.cones[0],
                      stepBytes = table.steps.size() * sizeof table.steps[0];
    cones.reserve(executor.device(), coneBytes, "cones");
    steps.reserve(executor.device(), stepBytes, "steps of cones");
    executor.writeCopy("cone_gather.upload", cones, 0, coneBytes, table.cones.data());
    executor.writeCopy("cone_gather.upload", steps, 0, stepBytes, table.steps.data());
}

LwConeGrids coneGrids(const VoxelVolume& volume) {
    LwConeGrids grids{};
    grids.size = lw_int(volume.size);
    grids.levels = voxel_levels(lw_int(volume.size));
    grids.cascades = lw_int(volume.cascades);
    grids.table = lw_int(volume.tableSize());
    grids.basePlane = lw_int(volume.baseSlots * LW_VOXEL_STRIDE);
    grids.mipPlane = lw_int(volume.mipSlots * LW_VOXEL_STRIDE);
    for (lw_int level = 0; level < grids.levels; ++level)
        grids.first[level] = voxel_table(grids.size, level);
    return grids;
}

Defines coneDefines(const ConeGatherOptions& options, bool light, bool open) {
    return {{"LW_CONE_MODE", std::to_string(int(options.mode))},
            {"LW_CONE_SIDES", options.sides ? "1" : "0"},
            {"LW_CONE_CASCADES", std::to_string(options.cascades)},
            {"LW_CONE_VOXELS", options.tetrahedral ? "4" : "8"},
            {"LW_CONE_PLANE", options.startPlane ? "1" : "0"},
            {"LW_CONE_CORRECT", options.opacityCorrection ? "1" : "0"},
            {"LW_CONE_LIGHT", light ? "1" : "0"},
            {"LW_CONE_OPEN", open ? "1" : "0"}};
}

ConeGather::ConeGather(Device& device, const ConeGatherOptions& options)
    : device_(device), options_(options), window_(windowOf(options)) {
    traceOf(true, false);
    if (options.interleaved) filterOf(false);
}

Kernel& ConeGather::filterOf(bool open) {
    return device_.programs().kernel(kFilter, "cone_gather_filter",
                                     {{"LW_CONE_COLUMNS", std::to_string(window_.columns)},
                                      {"LW_CONE_ROWS", std::to_string(window_.rows)},
                                      {"LW_CONE_OPEN", open ? "1" : "0"}});
}

Kernel& ConeGather::traceOf(bool light, bool open) {
    Defines defines = coneDefines(options_, light, open);
    defines.push_back({"LW_CONE_COLUMNS", std::to_string(window_.columns)});
    defines.push_back({"LW_CONE_ROWS", std::to_string(window_.rows)});
    return device_.programs().kernel(kTrace, "cone_gather_trace", defines);
}

void ConeGather::prepare(Executor& executor) {
    if (isUploaded_) return;
    uploadCones(executor, tableOf(options_), cones_, steps_);
    isUploaded_ = true;
}

void ConeGather::recordTrace(Executor& executor, const Planes& position, const Planes& normal,
                             const ConeWorld& world, const Planes& irradiance, const Planes& validity,
                             const Planes& open, const Buffer& counts, bool wantsOpen) {
    prepare(executor);
    const bool light = bool(irradiance), ambient = bool(open) || wantsOpen;
    Kernel& trace = traceOf(light, ambient);
    const LwConeView view = coneView(world, options_);
    // A kernel's argument must be some memory, also where it is not touched.
    const auto orElse = [&](const Planes& planes) { return planes ? planes : position; };
    const std::uint32_t pixels = trace.width() * window_.columns;
    executor.run(light ? "cone_gather.trace" : "cone_gather.trace_open", trace,
                 {(position.width + pixels - 1) / pixels, position.height}, groupOf(trace), position,
                 normal, cl_int(position.width), cl_int(position.height), world.places,
                 coneGrids(world.volume), world.volume.table, world.volume.base, world.volume.mips,
                 world.volume.state, cones_, cl_int(window_.perPixel), steps_, view,
                 cl_int(irradiance ? 1 : 0), cl_int(validity ? 1 : 0), cl_int(open ? 1 : 0),
                 orElse(irradiance), orElse(validity), orElse(open), counts);
}

void ConeGather::recordFilter(Executor& executor, const Planes& position, const Planes& normal,
                              const Planes& gathered, const Planes& irradiance, const Planes& validity,
                              const Planes& open) {
    const auto orElse = [&](const Planes& planes) { return planes ? planes : gathered; };
    Kernel& filter = filterOf(bool(open));
    const std::uint32_t pixels = filter.width();
    const Range items{(position.width + pixels - 1) / pixels,
                      (position.height + LW_FILTER_ROWS - 1) / LW_FILTER_ROWS};
    executor.run("cone_gather.filter", filter, items, filter.width() == 1 ? Range{64, 1} : Range{8, 1},
                 position, normal, cl_int(position.width), cl_int(position.height), gathered,
                 cl_int(irradiance ? 1 : 0), cl_int(validity ? 1 : 0), cl_int(open ? 1 : 0),
                 orElse(irradiance), orElse(validity), orElse(open));
}

void ConeGather::recordHarmonics(Executor& executor, const Planes& position, const Planes& normal,
                                 const ConeWorld& world, const Harmonics& harmonics,
                                 const Planes& validity, const Buffer& counts) {
    if (sphereCount_ == 0) {
        const ConeTable table = sphereOf(options_);
        uploadCones(executor, table, sphereCones_, sphereSteps_);
        sphereCount_ = lw_int(table.cones.size());
    }
    Kernel& kernel = device_.programs().kernel(kHarmonics, "cone_gather_harmonics",
                                               coneDefines(options_, true, false));
    const auto orElse = [&](const Planes& planes) { return planes ? planes : position; };
    executor.run("cone_gather.harmonics", kernel,
                 {(position.width + kernel.width() - 1) / kernel.width(), position.height},
                 groupOf(kernel), position, orElse(normal), cl_int(normal ? 1 : 0),
                 cl_int(position.width), cl_int(position.height), world.places, coneGrids(world.volume),
                 world.volume.table, world.volume.base, world.volume.mips, world.volume.state,
                 sphereCones_, cl_int(sphereCount_), sphereSteps_, coneView(world, options_),
                 cl_int(harmonics ? 1 : 0), cl_int(validity ? 1 : 0), orElse(harmonics.first),
                 harmonics.band, orElse(validity), counts);
}

std::uint64_t ConeGather::estimateBytes(const ConeGatherOptions& options) {
    const ConeTable table = tableOf(options), sphere = sphereOf(options);
    return (table.cones.size() + sphere.cones.size()) * sizeof table.cones[0] +
           (table.steps.size() + sphere.steps.size()) * sizeof table.steps[0];
}

}  // namespace lightwell
