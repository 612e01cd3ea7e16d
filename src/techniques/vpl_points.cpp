#include "techniques/vpl_points.h"

#include "compute/device.h"

namespace lightwell {

VplPoints::VplPoints(Device& device) : device_(device), light_(device), gather_(device, 1), harmonics_(device) {}

void VplPoints::render(Executor& executor, const Points& points, const Buffer& vpls, lw_subset_order order) {
    vpls_ = &vpls;
    order_ = wholeOrder(order);
    light_.render(executor, points, *this);
}

void VplPoints::recordIrradiance(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                                 const Planes&, const Buffer& counts) {
    if (!irradiance) return;
    tiles_.reserve(device_, position.width, position.height, order_, 1);
    gather_.recordCull(executor, position, normal, *vpls_, order_, tiles_);
    gather_.recordGather(executor, position, normal, *vpls_, order_, tiles_.masks(), irradiance, counts);
}

void VplPoints::recordHarmonics(Executor& executor, const Planes& position, const Planes& normal, const Harmonics& harmonics,
                                const Planes&, const Buffer& counts) {
    if (harmonics) harmonics_.record(executor, position, normal, *vpls_, order_, harmonics, counts);
}

}  // namespace lightwell
