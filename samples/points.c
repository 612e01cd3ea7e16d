/* Light at points without a view: probes above a square of floor that shines with 1 W/m^2, read as two bands of spherical
 * harmonics, which a forward renderer keeps and evaluates for every normal; and particles, which take the same at their places. */
#include <lightwell/lightwell.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SIDE = 32, PROBES = 5 };
static LWVpl vpls[SIDE * SIDE];
static float positions[PROBES][3], harmonics[4][PROBES][3], validity[PROBES];

static void check(LWStatus status, LWDevice device) {
    const char* message;
    if (status == LW_SUCCESS) return;
    lwGetLastError(device, &message);
    fprintf(stderr, "%s: %s\n", lwStatusName(status), message);
    exit(1);
}

/* Irradiance of a surface of normal n at probe i, of one colour: what a shader does with the four numbers. */
static float irradiance(int i, int colour, const float n[3]) {
    const float pi = 3.14159265f, y0 = 0.28209479f, y1 = 0.48860251f;
    float e = pi * y0 * harmonics[0][i][colour];
    for (int a = 0; a < 3; ++a) e += 2.0f * pi / 3.0f * y1 * harmonics[1 + a][i][colour] * n[a];
    return e > 0.0f ? e : 0.0f;
}

/* The truth: a square of side 1 seen from height h above its middle (Lambert). */
static double truth(double h) {
    const double a = 0.5 / sqrt(0.25 + h * h);
    return 4.0 / 3.14159265358979 * a * atan(a);
}

int main(void) {
    LWDevice device;
    LWTechnique technique;
    LWLpvDesc desc;
    check(lwCreateDevice(NULL, &device), NULL);
    lwDefaultLpv(&desc);
    desc.transport = LW_LPV_TRANSPORT_SWEEP;
    check(lwCreateLpv(device, &desc, &technique), device);

    for (int i = 0; i < SIDE * SIDE; ++i) { /* the host's own lights; RSMs do as well */
        LWVpl* vpl = &vpls[i];
        vpl->position[0] = ((float)(i % SIDE) + 0.5f) / SIDE - 0.5f;
        vpl->position[2] = ((float)(i / SIDE) + 0.5f) / SIDE - 0.5f;
        vpl->normal[1] = 1;
        vpl->area = vpl->flux[0] = vpl->flux[1] = vpl->flux[2] = 1.0f / (SIDE * SIDE);
    }
    for (int i = 0; i < PROBES; ++i) positions[i][1] = 0.1f * (float)(i + 1);

    LWFrame frame = {.structSize = sizeof frame, .vpls = vpls, .vplCount = SIDE * SIDE};
    LWImage places = {.host = positions, .format = LW_FORMAT_FLOAT3, .width = PROBES, .height = 1};
    LWPointOutput output = {.structSize = sizeof output};
    output.harmonics = (LWImage){.host = harmonics, .format = LW_FORMAT_FLOAT3, .width = PROBES, .height = 4};
    output.validity = (LWImage){.host = validity, .format = LW_FORMAT_FLOAT1, .width = PROBES, .height = 1};
    check(lwUpdate(technique, &frame), device);                                    /* once per frame */
    check(lwRenderPoints(technique, &places, NULL, PROBES, &output), device);      /* no normals: both bands only */
    check(lwFinish(device), device);

    int isRight = 1;
    for (int i = 0; i < PROBES; ++i) {
        const float down[3] = {0, -1, 0}, h = positions[i][1];
        const float e = irradiance(i, 0, down), mean = 0.28209479f * harmonics[0][i][0]; /* radiance, over all directions */
        printf("%.1f m above: facing the floor %.3f W/m^2 (truth %.3f), mean radiance %.3f W/(sr m^2)\n", h, e, truth(h), mean);
        isRight = isRight && validity[i] == 1.0f && fabs(e - truth(h)) < 0.16; /* two bands know a light's shape roughly */
    }
    lwReleaseTechnique(technique), lwReleaseDevice(device);
    return isRight ? 0 : 1;
}
