// Lists of VPLs that kernels write, one work-item to a slot.
#ifndef LW_VPL_LIST_H
#define LW_VPL_LIST_H

#include "vpl_types.h"

// This work-item's place in a list that src/passes/vpl_list.cpp folds into rows of work-items: drivers may
// compile a kernel anew for more than 65,535 groups along an axis, which no frame shall do. (The host sees to
// it that the rounded-up grid stays below 2^31.)
LW_FN int lw_list_index(void) { return (int)get_global_id(1) * (int)get_global_size(0) + (int)get_global_id(0); }

LW_FN lw_vpl no_vpl(void) {
    lw_vpl vpl;
    vpl.positionArea = (float4)(0.0f);
    vpl.normal = (float4)(0.0f);
    vpl.flux = (float4)(0.0f);
    return vpl;
}

// What the gather's bounded term needs beside the VPL as the host knows it.
LW_FN lw_vpl bounded(lw_vpl vpl) {
    vpl.normal.w = vpl.positionArea.w * (0.25f * M_1_PI_F);
    return vpl;
}

#endif
