// Static VPLs as kernels and host share them: what a frame brings lies in one array of floats, so that it goes to the
// device in one copy (at a few microseconds a command, several would cost more than all of the light).
#ifndef LW_STATIC_VPL_TYPES_H
#define LW_STATIC_VPL_TYPES_H

#include "portable.h"

// Planes of the places, each padded to 16.
#define LW_PLACE_POSITION 0
#define LW_PLACE_NORMAL 3       // unit
#define LW_PLACE_REFLECTANCE 6
#define LW_PLACE_AREA 9         // m^2; 0: by the distance to the nearest other place
#define LW_PLACE_LIGHTS 10      // as an int: which lights, LWStaticVpl::lightMask; all bits for all
#define LW_PLACE_RECEIVERS 11   // as an int: LWReceivers, 3 for all
#define LW_PLACE_PLANES 12

// What lights make of them, planes of the same length.
#define LW_LIT_FLUX 0    // rgb, W: for receivers without baked light
#define LW_LIT_BAKED 3   // rgb, W: for receivers with baked light
#define LW_LIT_AREA 6    // m^2
#define LW_LIT_PLANES 7

#define LW_RECEIVER_UNBAKED 1
#define LW_RECEIVER_BAKED 2

// Words that begin the array; the host writes zeros.
#define LW_FRAME_STRONGEST 0  // bits of the strongest place's intensity, W/sr, past no blocker
#define LW_FRAME_KEPT 1       // places that are not culled
#define LW_FRAME_WORDS 16

// Where the parts of the array begin, in floats.
typedef struct {
    lw_int count, stride;        // places; padded
    lw_int places;
    lw_int lights, lightCount;   // lw_static_light each
    lw_int blockers, blockerCount;  // centre and 1 / radius^2 each
    lw_int profiles;
    lw_int phantoms, phantomCount;  // lw_phantom each
    lw_int automatic;            // 1: every place goes by its distance to the nearest other one
    lw_int unused;
} lw_static_frame;
LW_SIZE_CHECK(lw_static_frame, 48);

#define LW_STATIC_DIRECTIONAL 0
#define LW_STATIC_PUNCTUAL 1

typedef struct {
    lw_float4 emitted;   // E_perp (W/m^2) or intensity (W/sr), rgb; w unused
    // w: scale of the cone. A light's share of its intensity is clamp(scale * cosine + offset, 0, 1)^2.
    lw_float4 position;
    lw_float4 axis;      // unit, the way the light travels; w: offset of the cone
    lw_int kind;         // LW_STATIC_DIRECTIONAL, LW_STATIC_PUNCTUAL
    lw_int profile, profileCount;  // first float among the profiles, 0 floats: none
    lw_int mask;         // of places' lights; 0: lights none of them (it has a phantom instead)
    lw_int receivers;
    lw_int unused[3];
} lw_static_light;
LW_SIZE_CHECK(lw_static_light, 80);
#define LW_STATIC_LIGHT_FLOATS 20

// A spot light that lights a phantom.
typedef struct {
    lw_float4 hit;    // where the host says its axis meets the scene; w: 1, or 0: the texel knows
    lw_int light;     // number in the frame
    lw_int texel;     // among the RSMs' texels
    lw_int unused[2];
} lw_phantom;
LW_SIZE_CHECK(lw_phantom, 32);
#define LW_PHANTOM_FLOATS 8

// What a phantom was in the frame before.
typedef struct {
    lw_float4 position;     // w: 1, or 0: it was not
    lw_float4 normal;       // unit; w: area
    lw_float4 reflectance;  // w unused
} lw_phantom_state;
LW_SIZE_CHECK(lw_phantom_state, 48);

// What phantoms and second bounces take of the technique's parameters.
typedef struct {
    lw_float eps;        // m^2: squared distance within which a place's look prevails
    lw_float smoothing;  // share of the last frame's
    lw_float reflectance, area;  // of what lies opposite; m^2, 0: it catches all
    lw_float distance;   // m: of what lies opposite the static VPLs
    lw_int opposite;     // 1: there is a second bounce
    lw_int lists;        // 2: receivers with baked light have a list of their own
    lw_int keep;         // 1: states of the last frame are whole
} lw_phantom_options;
LW_SIZE_CHECK(lw_phantom_options, 32);

// A place of the list of lights from frame to frame.
typedef struct {
    lw_float4 position;  // w: 1, or 0: it stands for nothing
    lw_float4 normal;
} lw_listed_centre;
LW_SIZE_CHECK(lw_listed_centre, 32);

// LWListedLight of the public header.
typedef struct {
    lw_float4 positionArea;
    lw_float axis[3];
    lw_uint id;
    lw_float flux[3];
    lw_uint vpls;
    lw_float4 bakedFluxCone;  // w: half angle of the spot light
    lw_float4 spotIntensity;  // w unused
} lw_listed_light;
LW_SIZE_CHECK(lw_listed_light, 80);

#define LW_MOST_LISTED 64

#endif
