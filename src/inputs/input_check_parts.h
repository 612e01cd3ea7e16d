// The checks that lwCheckInputs is made of. Each looks at host copies and adds findings; a check that
// finds a buffer's places wrong marks it untrusted, and what rests on places is then left out: one
// fault, one finding.
#pragma once

#include <vector>

#include "inputs/input_findings.h"
#include "inputs/input_surfaces.h"

namespace lightwell {

// Another camera of the frame, in whose space a buffer may have been left.
struct NamedCamera {
    std::string name;  // "gbuffer.camera"
    const Camera* camera;
};

// input_check_values.cpp: NaN, negative values, albedo above 1, normals' length and encoding.
void checkValues(Surfaces& surfaces, Findings& findings);
// input_check_far.cpp: true where the places are too far from their origin for floats, and untrusted then. findings: null where others
// have said so.
bool checkFar(Surfaces& surfaces, Findings* findings);
// input_check_places.cpp: positions against the camera.
void checkPlaces(Surfaces& surfaces, const std::vector<NamedCamera>& others, Findings& findings);
// The same file: surfaces that were given no normal. After the other checks of a trusted buffer.
void checkMissingNormals(const Surfaces& surfaces, Findings& findings);
// input_check_normals.cpp: normals and depth against each other and the camera.
void checkNormals(Surfaces& surfaces, const std::vector<NamedCamera>& others, Findings& findings);
// input_check_motion.cpp
void checkMotion(const Surfaces& gbuffer, Findings& findings);

// A light with the maps that it has.
struct LightMaps {
    const LWLight* light;
    std::string name;  // "frame.lights[0]"
    std::vector<Surfaces> maps;
};
// input_check_spaces.cpp: the maps of a light against the G-buffer: one space, one unit, one scene.
void checkSpaces(Surfaces& gbuffer, LightMaps& light, Findings& findings);
// input_check_light.cpp: a lamp's position against the cameras of its maps.
void checkLightCamera(const LightMaps& light, Findings& findings);
// input_check_flux.cpp: flux against the light, and with a trusted G-buffer (else null) against its
// albedo.
void checkFlux(const Surfaces* gbuffer, const LightMaps& light, Findings& findings);
// input_check_direct.cpp
void checkDirect(const Surfaces& gbuffer, const LWLight* lights, std::uint32_t count,
                 Findings& findings);

// input_conventions.cpp. Signed exchanges of axes that hosts get wrong.
struct AxesChange {
    const char* what;
    glm::dmat3 matrix;  // from what the host gave to what is meant
};
const std::vector<AxesChange>& axesChanges();

// A factor between units of length that has a name, else null; within 3 %.
const char* lengthFactorName(double factor);

}  // namespace lightwell
