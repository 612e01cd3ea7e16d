/* A whole host without a renderer: a sun lights a white wall; how much light reaches the floor at its
 * foot? Both are unit squares, so the truth is their form factor: 0.2000 W/m^2 on average. */
#include <lightwell/lightwell.h>
#include <stdio.h>
#include <stdlib.h>

enum { N = 64 }; /* pixels, and texels, on a side */
static float floorPosition[N * N][3], floorNormal[N * N][3], irradiance[N * N][3];
static float wallPosition[N * N][3], wallNormal[N * N][3], wallFlux[N * N][3];

static void check(LWStatus status, LWDevice device) {
    const char* message;
    if (status == LW_SUCCESS) return;
    lwGetLastError(device, &message);
    fprintf(stderr, "%s: %s\n", lwStatusName(status), message);
    exit(1);
}

static LWImage image(float (*pixels)[3]) {
    return (LWImage){.host = pixels, .format = LW_FORMAT_FLOAT3, .width = N, .height = N};
}

int main(void) {
    LWDevice device;
    LWView view;
    LWTechnique technique;
    LWRsmDesc desc;
    LWViewDesc size = {.structSize = sizeof size, .maxWidth = N, .maxHeight = N};
    check(lwCreateDevice(NULL, &device), NULL); /* the best OpenCL device */
    check(lwCreateView(device, &size, &view), device);
    lwDefaultRsm(&desc);
    desc.vpls = 0, desc.interleave = 1; /* every texel lights every pixel */
    check(lwCreateRsm(device, &desc, &technique), device);

    for (int i = 0; i < N * N; ++i) { /* what a renderer draws: the view, and what the sun sees */
        const float u = ((float)(i % N) + 0.5f) / N, v = ((float)(i / N) + 0.5f) / N;
        floorPosition[i][0] = u, floorPosition[i][2] = v, floorNormal[i][1] = 1;
        wallPosition[i][1] = 1 - v, wallPosition[i][2] = 1 - u, wallNormal[i][0] = 1;
        for (int c = 0; c < 3; ++c) wallFlux[i][c] = 1.0f / (N * N); /* W: albedo 1, 1 W/m^2, area */
    }
    LWRsm rsm = {.structSize = sizeof rsm, .position = image(wallPosition)};
    rsm.normal = image(wallNormal), rsm.flux = image(wallFlux);
    rsm.camera = (LWCamera){.view = {0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, -2, 0, 0, 0, 1}, /* row-major */
                            .projection = {2, 0, 0, 1, 0, 2, 0, -1, 0, 0, -.25f, 0, 0, 0, 0, 1}};
    LWLight sun = {.structSize = sizeof sun, .kind = LW_LIGHT_DIRECTIONAL, .rsmCount = 1, .rsms = &rsm};
    sun.direction[0] = -1, sun.irradiance[0] = sun.irradiance[1] = sun.irradiance[2] = 1;
    LWFrame frame = {.structSize = sizeof frame, .lightCount = 1, .lights = &sun};
    LWGBuffer gbuffer = {.structSize = sizeof gbuffer, .position = image(floorPosition)};
    gbuffer.normal = image(floorNormal);
    LWOutput output = {.structSize = sizeof output, .irradiance = image(irradiance)};
    check(lwUpdate(technique, &frame), device);                  /* once per frame */
    check(lwRender(technique, view, &gbuffer, &output), device); /* once per view */
    check(lwFinish(device), device);
    double mean = 0;
    for (int i = 0; i < N * N; ++i) mean += irradiance[i][0] / (N * N);
    printf("the floor receives %.4f W/m^2\n", mean);
    lwReleaseTechnique(technique), lwReleaseView(view), lwReleaseDevice(device);
    return mean > 0.199 && mean < 0.201 ? 0 : 1;
}
