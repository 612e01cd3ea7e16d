/* The frame of tests/python/test_light.py by the C API: same_frame TECHNIQUE SETTINGS N GIVEN MADE. GIVEN holds six N x N float3
 * images (position, normal, direct radiance; RSM position, normal, flux) and four matrices; MADE gets the irradiance. */
#include <lightwell/lightwell.h>
#include <stdio.h>
#include <stdlib.h>

static void check(LWStatus status, LWDevice device) {
    const char* message;
    if (status == LW_SUCCESS) return;
    lwGetLastError(device, &message);
    fprintf(stderr, "%s: %s\n", lwStatusName(status), message);
    exit(1);
}

static LWImage image(float* pixels, uint32_t n) {
    return (LWImage){.host = pixels, .format = LW_FORMAT_FLOAT3, .width = n, .height = n};
}

int main(int argc, char** argv) {
    if (argc != 6) return 2;
    const uint32_t n = (uint32_t)atoi(argv[3]);
    const size_t count = (size_t)n * n * 3;
    float *given = malloc(6 * count * sizeof(float)), *made = calloc(count, sizeof(float));
    LWCamera cameras[2]; /* of the view and of the RSM */
    FILE* file = fopen(argv[4], "rb");
    if (!given || !made || !file || fread(given, sizeof(float), 6 * count, file) != 6 * count || fread(cameras, sizeof cameras, 1, file) != 1)
        return 2;
    fclose(file);

    LWDevice device;
    LWView view;
    LWTechnique technique;
    LWViewDesc size = {.structSize = sizeof size, .maxWidth = n, .maxHeight = n};
    check(lwCreateDevice(NULL, &device), NULL);
    check(lwCreateView(device, &size, &view), device);
    check(lwCreateTechniqueFromText(device, argv[1], argv[2], &technique), device);
    LWGBuffer gbuffer = {.structSize = sizeof gbuffer, .position = image(given, n), .normal = image(given + count, n)};
    gbuffer.directRadiance = image(given + 2 * count, n);
    gbuffer.camera = gbuffer.previousCamera = cameras[0];
    LWRsm rsm = {.structSize = sizeof rsm, .position = image(given + 3 * count, n), .normal = image(given + 4 * count, n)};
    rsm.flux = image(given + 5 * count, n), rsm.camera = cameras[1];
    LWLight sun = {.structSize = sizeof sun, .kind = LW_LIGHT_DIRECTIONAL, .rsmCount = 1, .rsms = &rsm};
    sun.direction[0] = -1, sun.irradiance[0] = sun.irradiance[1] = sun.irradiance[2] = 1;
    LWSourceView source = {.view = view, .gbuffer = &gbuffer};
    LWFrame frame = {.structSize = sizeof frame, .lightCount = 1, .lights = &sun, .sourceViewCount = 1, .sourceViews = &source};
    LWOutput output = {.structSize = sizeof output, .irradiance = image(made, n)};
    check(lwUpdate(technique, &frame), device);
    check(lwRender(technique, view, &gbuffer, &output), device);
    check(lwFinish(device), device);
    lwReleaseTechnique(technique), lwReleaseView(view), lwReleaseDevice(device);
    file = fopen(argv[5], "wb");
    const int written = file && fwrite(made, sizeof(float), count, file) == count && fclose(file) == 0;
    free(given), free(made);
    return written ? 0 : 1;
}
