// Batches of rays through Embree.
#pragma once

#include "rival_batch.h"

struct RTCSceneTy;

namespace studio {

// The nearest surface on the way of each path that is alive; of the others, `mesh` says none.
void intersectPaths(RTCSceneTy* scene, PathBatch& batch, bool asPackets);

// lit: whether nothing stands within reach.
void findLit(RTCSceneTy* scene, ShadowBatch& batch, bool asPackets);

}  // namespace studio
