#include "techniques/fallback_points.h"

#include "compute/device.h"
#include "inputs/image_access.h"

namespace lightwell {
namespace {

constexpr std::uint32_t kBands = 4;

bool isWanted(const LWImage& image) { return !imageAbsent(image); }

// Grows only.
void reserveImage(PlanarImage& image, Device& device, std::uint32_t count, std::uint32_t height, std::uint32_t planes, const char* what) {
    const std::uint64_t bytes = std::uint64_t(paddedWidth(count)) * height * planes * sizeof(float);
    if (image.bytes() < bytes) image = PlanarImage(device, count, height, planes, what);
}

}  // namespace

LWImage imageOver(const Planes& planes, LWFormat format) {
    LWImage image{};
    image.clMem = planes.memory;
    image.format = format;
    image.width = planes.width;
    image.height = planes.height;
    image.byteRowStride = planes.rowStride * std::int64_t(sizeof(float));
    image.bytePlaneStride = format == LW_FORMAT_FLOAT1 ? 0 : planes.planeStride * std::int64_t(sizeof(float));
    return image;
}

FallbackPoints::FallbackPoints(Device& device, Kernel& join)
    : device_(device),
      join_(join),
      joinHarmonics_(device.programs().kernel("fallback/fallback", "fallback_join_harmonics")),
      saturated_(device, sizeof(cl_int), "counts of points") {}

LWPointOutput FallbackPoints::reserve(Part& part, const Points& points) {
    LWPointOutput output{};
    output.structSize = sizeof output;
    reserveImage(part.validity, device_, points.count, 1, 1, "validity of a technique's points");
    output.validity = imageOver(part.validity.planes(points.count, 1), LW_FORMAT_FLOAT1);
    if (isWanted(points.output.irradiance)) {
        reserveImage(part.irradiance, device_, points.count, 1, 3, "irradiance of a technique's points");
        output.irradiance = imageOver(part.irradiance.planes(points.count, 1), LW_FORMAT_PLANAR_FLOAT3);
    }
    if (isWanted(points.output.harmonics)) {
        reserveImage(part.harmonics, device_, points.count, kBands, 3, "harmonics of a technique's points");
        output.harmonics = imageOver(part.harmonics.planes(points.count, kBands), LW_FORMAT_PLANAR_FLOAT3);
    }
    return output;
}

void FallbackPoints::render(Executor& executor, const Points& points, Technique& first, Technique& second) {
    checkPoints(device_, points);
    if (isFresh_) executor.fill("fallback.counts", saturated_, 0, 0, saturated_.bytes());
    isFresh_ = false;
    Points part = points;
    part.output = reserve(first_, points);
    first.renderPoints(executor, part);
    part.output = reserve(second_, points);
    second.renderPoints(executor, part);
    outputs_.begin(executor, points);
    join(executor, points.count);
    outputs_.end(executor);
}

void FallbackPoints::join(Executor& executor, std::uint32_t count) {
    const Planes v1 = first_.validity.planes(count, 1), v2 = second_.validity.planes(count, 1);
    const bool irradiance = bool(outputs_.irradiance), harmonics = bool(outputs_.harmonics), validity = bool(outputs_.validity);
    // A kernel's arguments must be set: an output that is not wanted is an input that is not touched.
    const Planes e1 = irradiance ? first_.irradiance.planes(count, 1) : v1, e2 = irradiance ? second_.irradiance.planes(count, 1) : v1;
    const Planes e = irradiance ? outputs_.irradiance : v1, v = validity ? outputs_.validity : v1;
    eachPointRows(count, [&](const PointRows& rows) {
        if (irradiance || validity)
            executor.run("fallback.join", join_, rowGrid(device_, rows.width, rows.height), rowGroup(device_), rows.of(e1), rows.of(v1),
                         rows.of(e2), rows.of(v2), cl_int(rows.width), cl_int(rows.height), cl_int(irradiance ? 1 : 0),
                         cl_int(validity ? 1 : 0), rows.of(e), rows.of(v), saturated_);
        if (harmonics)
            joinHarmonics(executor, rows.of(v1), harmonicsOf(rows, first_.harmonics.planes(count, kBands)),
                          harmonicsOf(rows, second_.harmonics.planes(count, kBands)), harmonicsOf(rows, outputs_.harmonics));
    });
}

void FallbackPoints::joinHarmonics(Executor& executor, const Planes& validity, const Harmonics& first, const Harmonics& second,
                                   const Harmonics& sum) const {
    executor.run("fallback.join", joinHarmonics_, rowGrid(device_, validity.width, validity.height), rowGroup(device_), first.first,
                 first.band, validity, second.first, second.band, cl_int(validity.width), cl_int(validity.height), sum.first, sum.band);
}

void FallbackPoints::exercise(Executor& executor) const {
    const PlanarImage validity(device_, 16, 1, 1, "validity of points"), light(device_, 16, kBands, 3, "light of points");
    const Harmonics harmonics{light.planes(16, kBands), 16};
    joinHarmonics(executor, validity.planes(16, 1), harmonics, harmonics, harmonics);
    device_.finish();
}

void FallbackPoints::report(Report& report) const {
    report.counts.push_back({"saturated_points", 0});
    if (isFresh_) return;
    outputs_.report(report);
    report.read(device_, "saturated_points", saturated_, 0);
}

std::uint64_t FallbackPoints::bytes() const {
    return first_.bytes() + second_.bytes() + outputs_.bytes() + saturated_.bytes();
}

}  // namespace lightwell
