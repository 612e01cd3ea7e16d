#include "techniques/point_light.h"

#include <algorithm>

#include "compute/device.h"

namespace lightwell {
namespace {

constexpr std::uint32_t kBands = 4;
constexpr std::size_t kCountBytes = 4 * sizeof(cl_int);  // as many as any gather has

struct Output {
    const LWImage LWPointOutput::*image;
    Planes PointOutputs::*planes;
    const char* name;
    std::uint32_t height, channels;
};
const Output kOutputs[] = {
    {&LWPointOutput::irradiance, &PointOutputs::irradiance, "output.irradiance", 1, 3},
    {&LWPointOutput::harmonics, &PointOutputs::harmonics, "output.harmonics", kBands, 3},
    {&LWPointOutput::validity, &PointOutputs::validity, "output.validity", 1, 1},
};

}  // namespace

void checkPoints(Device& device, const Points& points) {
    PointsInput::check(device, points.positions, points.normals, points.count);
    for (const Output& output : kOutputs)
        OutputTarget::check(device, View(points.count, output.height), points.output.*output.image, output.channels, output.name);
}

// ----------------------------------------------------------------------------------------- outputs

void PointOutputs::begin(Executor& executor, const Points& points) {
    capacity_ = std::max(capacity_, points.count);
    for (std::size_t i = 0; i < targets_.size(); ++i) {
        const Output& output = kOutputs[i];
        View view(capacity_, output.height);
        view.width = points.count;
        this->*output.planes = targets_[i].begin(executor, view, points.output.*output.image, output.channels, output.name);
    }
}

void PointOutputs::end(Executor& executor) {
    for (OutputTarget& target : targets_) target.end(executor);
}

void PointOutputs::report(Report& report) const {
    for (const OutputTarget& target : targets_) target.report(report);
}

std::uint64_t PointOutputs::bytes() const {
    std::uint64_t total = 0;
    for (const OutputTarget& target : targets_) total += target.bytes();
    return total;
}

Harmonics harmonicsOf(const PointRows& rows, const Planes& harmonics) {
    return {rows.of(harmonics), harmonics ? cl_int(harmonics.rowStride) : 0};
}

// ------------------------------------------------------------------------------------------ light

PointLight::PointLight(Device& device)
    : counts_(device, kCountBytes, "counts of points"),
      harmonicsCounts_(device, kCountBytes, "counts of points"),
      rejected_(device, sizeof(cl_int), "counts of points") {}

void PointLight::render(Executor& executor, const Points& points, PointGather& gather) {
    checkPoints(executor.device(), points);
    if (isFresh_) {
        for (const Buffer* counts : {&counts_, &harmonicsCounts_, &rejected_})
            executor.fill("points_input.counts", *counts, 0, 0, counts->bytes());
        count_ = 0;
        isFresh_ = false;
    }
    points_.import(executor, points.positions, points.normals, points.count);
    outputs_.begin(executor, points);
    points_.recordCheck(executor, outputs_.validity, rejected_);
    light(executor, gather);
    outputs_.end(executor);
    count_ += points.count;
}

// Validity comes with the first of the two gathers.
void PointLight::light(Executor& executor, PointGather& gather) {
    const bool irradiance = bool(outputs_.irradiance), harmonics = bool(outputs_.harmonics), validity = bool(outputs_.validity);
    const bool asSurfaces = irradiance || (validity && !harmonics && points_.normal);
    const bool asPlaces = harmonics || (validity && !asSurfaces);
    eachPointRows(points_.position.width, [&](const PointRows& rows) {
        const Planes position = rows.of(points_.position), normal = rows.of(points_.normal), valid = rows.of(outputs_.validity);
        if (asSurfaces) gather.recordIrradiance(executor, position, normal, rows.of(outputs_.irradiance), valid, counts_);
        if (asPlaces)
            gather.recordHarmonics(executor, position, normal, harmonicsOf(rows, outputs_.harmonics), asSurfaces ? Planes{} : valid,
                                   asSurfaces ? harmonicsCounts_ : counts_);
    });
}

void PointLight::report(Device& device, Report& report, const Counts& counts) const {
    report.counts.push_back({"points", isFresh_ ? 0 : count_});
    for (const char* name : {"rejected_points", "saturated_points"}) report.counts.push_back({name, 0});
    if (counts.outside) report.counts.push_back({"points_outside", 0});
    if (isFresh_) return;
    points_.report(report);
    outputs_.report(report);
    report.read(device, "rejected_points", rejected_, 0);
    report.read(device, "saturated_points", counts_, counts.saturated * sizeof(cl_int));
    report.read(device, "saturated_points", harmonicsCounts_, counts.saturated * sizeof(cl_int));
    if (counts.outside) report.read(device, "points_outside", counts_, *counts.outside * sizeof(cl_int));
}

std::uint64_t PointLight::bytes() const {
    return points_.bytes() + outputs_.bytes() + counts_.bytes() + harmonicsCounts_.bytes() + rejected_.bytes();
}

}  // namespace lightwell
