// One line per technique.
#include "techniques/fallback.h"
#include "techniques/rsm.h"
#include "techniques/screen_space.h"
#include "techniques/ssvp.h"
#include "techniques/technique.h"

namespace lightwell {

const std::vector<TechniqueEntry>& techniqueEntries() {
    static const std::vector<TechniqueEntry> entries = {
        rsmEntry(),
        ssvpEntry(),
        screenSpaceEntry(),
        fallbackEntry(),
    };
    return entries;
}

}  // namespace lightwell
