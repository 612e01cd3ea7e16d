// From where VPLs look for what their light reaches.
#include "shared/static_vpl_types.h"
#include "shared/subset_order.h"
#include "shared/vpl_list.h"

LW_FN int has_flux(const lw_vpl vpl) { return vpl.flux.x > 0.0f || vpl.flux.y > 0.0f || vpl.flux.z > 0.0f; }

// One work-item = one VPL of `count`, of lists that are not dealt out: its place and normal in whichever list it has flux
// in, raised along the normal by `lift` times the radius of a disc of its area. A place that was set by hand or
// is a mean of several lies a little inside of what it stands for as easily as off it, and sees nothing from there.
// Without flux in any list: none.
__kernel void light_list_sites(__global const lw_vpl* vpls, __global const lw_vpl* baked, int lists, int count, float lift,
                               __global lw_vpl* sites) {
    const int k = lw_list_index();
    if (k >= count) return;
    lw_vpl site = vpls[k];
    if (!has_flux(site) && lists > 1) site = baked[k];
    if (has_flux(site)) {
        const float raised = lift * sqrt(site.positionArea.w * M_1_PI_F);
        site.positionArea.xyz += raised * site.normal.xyz;
    } else {
        site = no_vpl();
    }
    sites[k] = site;
}
