#include "passes/light_list.h"

#include <algorithm>

#include "compute/device.h"
#include "passes/vpl_list.h"
#include "shared/vpl_types.h"

namespace lightwell {
namespace {

constexpr Range kGroup{64, 1};
// Of 1 / diagonal^2: times the square of the largest distance it is still a float, or no light would be
// a VPL's nearest.
constexpr double kMostScale = 1e18;
constexpr const char* kMerge = "light_list/light_list_merge";

std::size_t listBytes(lw_subset_order order) {
    return std::size_t(order.subsets) * std::size_t(order.capacity) * sizeof(lw_vpl);
}
std::size_t keptBytes(std::uint32_t places) {
    return std::max(places, 1u) * sizeof(cl_int);
}

}  // namespace

LightList::LightList(Device& device, const LightListOptions& options)
    : device_(device),
      options_(options),
      cull_(device.programs().kernel("light_list/light_list", "light_list_cull")),
      sites_(device.programs().kernel("light_list/light_list_sites", "light_list_sites")),
      assign_(device.programs().kernel(kMerge, "light_list_assign")),
      begin_(device.programs().kernel(kMerge, "light_list_begin")),
      sum_(device.programs().kernel(kMerge, "light_list_sum")) {}

lw_subset_order LightList::orderOf(const LightListOptions& options, std::uint32_t places,
                                   std::uint32_t others) {
    return subsetOrder(places + others, options.subsets);
}

void LightList::reserve(std::uint32_t places, std::uint32_t others, std::uint32_t lists) {
    const lw_subset_order order = orderOf(options_, places, others);
    vpls_.reserve(device_, listBytes(order), "VPLs");
    if (lists > 1) baked_.reserve(device_, listBytes(order), "VPLs for receivers with baked light");
    kept_.reserve(device_, keptBytes(places), "states of static VPLs");
    if (places_ != places) centresKnown_ = false;
    order_ = order;
    lists_ = lists;
}

void LightList::recordCull(Executor& executor, const Buffer& inputs, const lw_static_frame& frame,
                           const Buffer& lit, bool restart) {
    if (restart || places_ != std::uint32_t(frame.count)) {
        // As if all had been kept: a VPL between the two thresholds is then seen from the first frame
        // on.
        executor.fill("light_list.restart", kept_, 1, 0, keptBytes(std::uint32_t(frame.count)));
        centresKnown_ = false;
    }
    places_ = std::uint32_t(frame.count);
    executor.run("light_list.cull", cull_,
                 gridOver(std::size_t(order_.subsets) * std::size_t(order_.capacity)), kGroup, inputs,
                 frame, lit, options_.threshold, cl_int(options_.relative), options_.hysteresis, kept_,
                 order_, cl_int(lists_), vpls_, baked());
}

void LightList::recordSites(Executor& executor, std::uint32_t count, float lift, const Buffer& sites) {
    if (count == 0) return;
    executor.run("light_list.sites", sites_, gridOver(count), kGroup, vpls_, baked(), cl_int(lists_),
                 cl_int(count), lift, sites);
}

void LightList::recordLights(Executor& executor, double diagonal) {
    const std::uint32_t most = options_.lights;
    const std::size_t count = std::size_t(std::max(order_.count, 1));
    centres_.reserve(device_, most * sizeof(lw_listed_centre), "places of listed lights");
    listed_.reserve(device_, most * sizeof(lw_listed_light), "listed lights");
    assignment_.reserve(device_, count * sizeof(cl_int), "lights of VPLs");
    losses_.reserve(device_, count * sizeof(float), "losses of VPLs");
    if (!centresKnown_)
        executor.fill("light_list.restart", centres_, 0, 0, most * sizeof(lw_listed_centre));
    else if (follows_.moves(executor))
        follows_.move(executor, centres_, {most, 0, sizeof(lw_listed_centre) / sizeof(float)});
    follows_.arrive(executor);
    const cl_int lists = cl_int(lists_), alone = order_.count <= cl_int(most) ? 1 : 0;
    const float scale = diagonal > 0.0 ? float(std::min(1.0 / (diagonal * diagonal), kMostScale)) : 0.0f;
    const auto assign = [&] {
        if (order_.count > 0)
            executor.run("light_list.assign", assign_, gridOver(count), kGroup, vpls_, baked(), lists,
                         order_, scale, alone, centres_, cl_int(most), assignment_, losses_);
    };
    assign();
    if (!alone) {
        executor.run("light_list.begin", begin_, {1, 1}, {1, 1}, vpls_, baked(), lists, order_, scale,
                     centres_, cl_int(most), assignment_, losses_);
        assign();
    }
    executor.run("light_list.sum", sum_, {most, 1}, {4, 1}, vpls_, baked(), lists, order_, assignment_,
                 centres_, cl_int(most), listed_);
    centresKnown_ = true;
}

std::uint64_t LightList::bytes() const {
    return kept_.bytes() + vpls_.bytes() + baked_.bytes() + centres_.bytes() + assignment_.bytes() +
           losses_.bytes() + listed_.bytes();
}

std::uint64_t LightList::estimateBytes(const LightListOptions& options, std::uint32_t places,
                                       std::uint32_t others, std::uint32_t lists) {
    return keptBytes(places) + lists * listBytes(orderOf(options, places, others));
}

}  // namespace lightwell
