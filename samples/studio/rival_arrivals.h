// What punctual lights bring to a batch of vertices.
#pragma once

#include "rival_batch.h"
#include "scene.h"

namespace studio {

// What one light would bring to every vertex with nothing between.
struct Arrivals {
    alignas(64) float direction[3][PathBatch::kSize], reach[PathBatch::kSize];
    alignas(64) float strength[PathBatch::kSize];  // times Light::emitted; 0: nothing arrives
};
void findArrivals(const Light& light, const PathBatch& batch, Arrivals& to);

}  // namespace studio
