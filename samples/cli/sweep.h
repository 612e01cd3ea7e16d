// What a chart varies: each technique declares it with its parameters (LWParameter::sweep, LWSetting),
// so that a new technique is charted by its registration alone.
#pragma once

#include <string>
#include <vector>

#include "parameters.h"

namespace cli {

struct SweepPoint {
    Parameters parameters;
    std::string label;  // "default", "Dachsbacher 2005"; "": one of the grid
};

// Every combination of the parameters' sweeps; then the defaults and the named settings, which label
// their twin of the grid where it has one. `quick`: the defaults, the settings, and each parameter alone
// moved through its sweep. UsageError for a setting that the technique refuses.
std::vector<SweepPoint> sweepOf(const std::string& technique, bool quick);

// One point alone, of a technique with parameters ("ssvp,clusters=16", as parseVariant); labelled as the
// defaults or a named setting where it is one of these.
SweepPoint pointOf(const std::string& variant);

// Indirect bounces that a set of parameters models; 0: all.
int modelledBounces(const Parameters& parameters);

// Whether a technique, and all that it joins, takes its light from the view's own picture alone, so that
// the light of what the view shows is the most that it can know.
bool knowsPictureOnly(const Parameters& parameters);

// "vpls=256 interleave=4": what differs from the defaults; "defaults" when nothing does.
std::string describeDifference(const Parameters& parameters);
std::string valueText(const ParameterValue& value);

}  // namespace cli
