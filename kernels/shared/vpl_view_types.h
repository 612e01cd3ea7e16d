// Sizes that kernels and host of vpl_view_sampling share.
#ifndef LW_VPL_VIEW_TYPES_H
#define LW_VPL_VIEW_TYPES_H

#ifndef LW_VIEW_POINTS
#define LW_VIEW_POINTS 256
#endif
#define LW_VIEW_BLOCK 256  // candidates summed up by one work-item

#endif
