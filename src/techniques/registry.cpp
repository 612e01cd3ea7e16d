// One line per technique.
#include "techniques/ao.h"
#include "techniques/auto.h"
#include "techniques/cone_tracing.h"
#include "techniques/fallback.h"
#include "techniques/horizon.h"
#include "techniques/lpv.h"
#include "techniques/rsm.h"
#include "techniques/screen_space.h"
#include "techniques/ssvp.h"
#include "techniques/static_vpl.h"
#include "techniques/technique.h"

namespace lightwell {

const std::vector<TechniqueEntry>& techniqueEntries() {
    static const std::vector<TechniqueEntry> entries = {
        rsmEntry(),
        ssvpEntry(),
        screenSpaceEntry(),
        horizonEntry(),
        aoEntry(),
        lpvEntry(),
        coneTracingEntry(),
        staticVplEntry(),
        fallbackEntry(),
        autoEntry(),
    };
    return entries;
}

}  // namespace lightwell
