// How the pass pull_push lays out its pyramid.
#ifndef LW_PULL_PUSH_TYPES_H
#define LW_PULL_PUSH_TYPES_H

// Coarser levels: holes up to 2^levels texels wide are filled, wider ones stay unknown. Raised, the open between walls is
// closed by walls that are not there; lowered, the cracks between sparse surfels stay.
#define LW_FILL_LEVELS 3

// Planes of a level: point (0 where nothing is known), normal, albedo.
#define LW_FILL_POINT 0
#define LW_FILL_NORMAL 3
#define LW_FILL_ALBEDO 6
#define LW_FILL_PLANES 9

#endif
