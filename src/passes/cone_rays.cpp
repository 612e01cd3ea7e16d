#include "passes/cone_rays.h"

#include <cmath>

#include "compute/device.h"

namespace lightwell {
namespace {

constexpr const char* kRays = "cone_gather/cone_rays";
constexpr double kDegree = 3.14159265358979323846 / 180.0;

Range groupOf(const Kernel& kernel) {
    return kernel.width() == 1 ? Range{64, 1} : Range{4, 1};
}

// Where a cone begins is up to each pixel: steps are counted from there.
ConeSchedule rayScheduleOf(const ConeGatherOptions& options) {
    ConeSchedule schedule = coneSchedule(options);
    schedule.nudge = 0.0;
    schedule.apertureOffset = schedule.near = false;
    return schedule;
}

// In a cone's weight, where its class ends: 1 - cos of the angle halfway to the next, by ratio.
ConeTable rayTable(const ConeGatherOptions& options) {
    ConeTable table;
    for (int k = 0; k < LW_CONE_APERTURES; ++k) {
        const double end = std::sqrt(coneAperture(k) * coneAperture(k + 1));
        table.add({{0.0, 0.0, 1.0}, 1.0 - std::cos(end), coneAperture(k)}, 1.0, rayScheduleOf(options));
    }
    return table;
}

ConeTable shadowTable(const ConeGatherOptions& options, double fullAngle) {
    ConeTable table;
    table.add({{0.0, 0.0, 1.0}, 1.0, 0.5 * fullAngle}, 1.0, rayScheduleOf(options));
    return table;
}

std::uint64_t bytesOf(const ConeTable& table) {
    return table.cones.size() * sizeof table.cones[0] + table.steps.size() * sizeof table.steps[0];
}

LwConeView viewOf(const ConeWorld& world, const ConeGatherOptions& options, lw_float4 eye, double rough,
                  double index) {
    LwConeView view = coneView(world, options);
    view.eye = eye;
    view.rough = float4(rough, index, options.nudge, 0.0);
    return view;
}

}  // namespace

lw_float4 coneEye(const Camera& camera) {
    const glm::dvec3 from = camera.perspective() ? camera.eye() : camera.axis();
    return float4(from.x, from.y, from.z, camera.perspective() ? 1.0 : 0.0);
}

double coneAperture(int k) {
    return 0.5 * kDegree * std::pow(80.0, double(k) / (LW_CONE_APERTURES - 1));
}

ConeRays::ConeRays(Device& device, const ConeGatherOptions& options)
    : device_(device), options_(options) {}

void ConeRays::recordRays(Executor& executor, const char* pass, const Planes& position,
                          const Planes& normal, const Planes& roughness, bool refracts,
                          const LwConeView& view, const ConeWorld& world, const Planes& radiance,
                          const Buffer& counts) {
    if (!isUploaded_) uploadCones(executor, rayTable(options_), cones_, steps_);
    isUploaded_ = true;
    Kernel& kernel =
        device_.programs().kernel(kRays, "cone_gather_rays", coneDefines(options_, true, false));
    // A kernel's argument must be some memory, also where it is not touched.
    executor.run(pass, kernel, {(position.width + kernel.width() - 1) / kernel.width(), position.height},
                 groupOf(kernel), position, normal, roughness ? roughness : position,
                 cl_int(roughness ? 1 : 0), cl_int(refracts ? 1 : 0), cl_int(position.width),
                 cl_int(position.height), world.places, coneGrids(world.volume), world.volume.table,
                 world.volume.base, world.volume.mips, world.volume.state, cones_, steps_, view,
                 radiance, counts);
}

void ConeRays::recordSpecular(Executor& executor, const Planes& position, const Planes& normal,
                              const Planes& roughness, double rough, lw_float4 eye,
                              const ConeWorld& world, const Planes& radiance, const Buffer& counts) {
    recordRays(executor, "cone_gather.specular", position, normal, roughness, false,
               viewOf(world, options_, eye, rough, 1.0), world, radiance, counts);
}

void ConeRays::recordRefraction(Executor& executor, const Planes& position, const Planes& normal,
                                const Planes& roughness, double rough, double index, lw_float4 eye,
                                const ConeWorld& world, const Planes& radiance, const Buffer& counts) {
    recordRays(executor, "cone_gather.refraction", position, normal, roughness, true,
               viewOf(world, options_, eye, rough, index), world, radiance, counts);
}

void ConeRays::recordShadow(Executor& executor, const Planes& position, const Planes& normal,
                            const ConeLightSource& light, const ConeWorld& world, const Planes& shadow) {
    if (shadowAngle_ != light.fullAngle)
        uploadCones(executor, shadowTable(options_, light.fullAngle), shadowCones_, shadowSteps_);
    shadowAngle_ = light.fullAngle;
    LwConeView view = coneView(world, options_);
    view.light = float4(double(light.at[0]), double(light.at[1]), double(light.at[2]),
                        light.isDirectional ? 0.0 : 1.0);
    Kernel& kernel =
        device_.programs().kernel(kRays, "cone_gather_shadow", coneDefines(options_, false, false));
    executor.run("cone_gather.shadow", kernel,
                 {(position.width + kernel.width() - 1) / kernel.width(), position.height},
                 groupOf(kernel), position, normal, cl_int(position.width), cl_int(position.height),
                 world.places, coneGrids(world.volume), world.volume.table, world.volume.base,
                 world.volume.mips, world.volume.state, shadowCones_, shadowSteps_, view, shadow);
}

std::uint64_t ConeRays::estimateBytes(const ConeGatherOptions& options, bool hasRays,
                                      double shadowAngle) {
    return (hasRays ? bytesOf(rayTable(options)) : 0) +
           (shadowAngle > 0.0 ? bytesOf(shadowTable(options, shadowAngle)) : 0);
}

}  // namespace lightwell
