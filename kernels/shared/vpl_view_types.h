// Sizes that kernels and host of vpl_view_sampling share.
#ifndef LW_VPL_VIEW_TYPES_H
#define LW_VPL_VIEW_TYPES_H

// Pixels at which the views are asked, all together. More: a smoother choice that changes less from frame to frame, and time.
#define LW_VIEW_POINTS 256

#endif
