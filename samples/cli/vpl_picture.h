// Static VPLs drawn on the surfaces that a view shows.
#pragma once

#include "gbuffer.h"
#include "image.h"
#include "static_vpls.h"

namespace cli {

// The view in grey by its reflectances, and on it each VPL as a disc in its own, a third of the radius of the
// surface that it stands for, with a dark rim; blockers as red rings where their spheres cut surfaces. `vpls`: of
// posedVpls. Display values.
studio::Image drawVpls(const studio::GBuffer& gbuffer, const studio::StaticVpls& vpls);

}  // namespace cli
