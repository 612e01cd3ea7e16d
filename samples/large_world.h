/* Positions relative to a point near the camera, for worlds that are larger than floats are fine (docs/integration.md). C99. */
#include <lightwell/lightwell.h>
#include <math.h>

/* The origin for this frame (LWFrame::worldOrigin): stays until the eye has left it far behind. */
static inline void chooseOrigin(const double eye[3], double origin[3]) {
    for (int a = 0; a < 3; ++a)
        if (fabs(eye[a] - origin[a]) > 1024.0) origin[a] = 1024.0 * floor(eye[a] / 1024.0 + 0.5);
}

/* A camera that was relative to `from`, relative to `to`: the last frame's, as LWGBuffer::previousCamera. */
static inline void moveCamera(LWCamera* camera, const double from[3], const double to[3]) {
    for (int row = 0; row < 3; ++row) {
        float* r = camera->view + 4 * row;
        double t = (double)r[3];
        for (int a = 0; a < 3; ++a) t += (double)r[a] * (to[a] - from[a]);
        r[3] = (float)t;
    }
}
