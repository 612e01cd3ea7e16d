// Technique "lpv": light propagation volumes (Kaplanyan and Dachsbacher 2010). docs/techniques/lpv.md.
#pragma once

#include "techniques/technique.h"

namespace lightwell {

const TechniqueEntry& lpvEntry();

}  // namespace lightwell
