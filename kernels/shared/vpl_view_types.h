// Sizes that kernels and host of vpl_view_sampling share.
#ifndef LW_VPL_VIEW_TYPES_H
#define LW_VPL_VIEW_TYPES_H

#define LW_VIEW_POINTS 256  // a multiple of 16
#define LW_VIEW_PARTS 16    // sums of which a point's light is made, the same at every width

#endif
