// Batches of rays through Embree.
#pragma once

#include "rival_batch.h"

struct RTCSceneTy;

namespace studio {

// The nearest surface on the way of each path that is alive; of the others, `mesh` says none.
void intersectPaths(RTCSceneTy* scene, PathBatch& batch, bool asPackets);

// lit: whether nothing stands within reach.
void findLit(RTCSceneTy* scene, ShadowBatch& batch, bool asPackets);
// lit: whether the triangle that glows is what the ray meets first. No tolerance at its end; holes of
// an alpha mask are holes; of surfaces in the same place one counts, as it does for a path's own ray.
void findGlowing(RTCSceneTy* scene, ShadowBatch& batch, bool asPackets);

}  // namespace studio
