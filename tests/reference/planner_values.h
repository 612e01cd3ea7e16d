// Written by docs/figures/planner.py: what its own arithmetic predicts and chooses, from the unrounded fit.
#pragma once

struct PlannerValue {
    float probes[8], coverage;
    double triangles;
    const char* row;  // technique and settings
    double milliseconds, error;
    const char* chosen[5];  // of budgets of 4, 8, 16, 33, 66 ms
};

constexpr PlannerValue kPlannerValues[] = {
    {{0.43738845f, 0.514496446f, 0.000938608136f, 0.0697868764f, 1.08312559f, 0.570496261f, 0.631454408f, 0.440771341f}, 0.504340f, 30.0, "rsm vpls=64 resolution=quarter", 3.28242, 1.12031,
     {"ssvp clusters=4 map_size=64 resolution=quarter", "ssvp vpls=1024 clusters=32 second_vpls=16 visibility=careful bounces=4 resolution=quarter", "ssvp vpls=1024 clusters=64 visibility=careful bounces=4 shadowed_bounces=3 resolution=quarter", "ssvp vpls=1024 clusters=64 visibility=careful bounces=4 shadowed_bounces=3 resolution=quarter", "ssvp vpls=1024 clusters=64 visibility=careful bounces=4 shadowed_bounces=3 resolution=half"}},
    {{0.127302185f, 0.144086242f, 0.000448621984f, 0.0448541567f, 0.412275285f, 0.528423846f, 0.232166097f, 0.0887850448f}, 0.792101f, 3982.0, "rsm resolution=half", 4.35186, 0.901922,
     {"ssvp vpls=128 clusters=4 map_size=64 bounces=1 resolution=quarter", "ssvp vpls=1024 clusters=32 visibility=careful bounces=4 resolution=quarter", "ssvp vpls=1024 sampling=view clusters=64 visibility=careful bounces=4 resolution=quarter", "ssvp vpls=1024 sampling=view clusters=64 visibility=careful bounces=4 resolution=quarter", "ssvp vpls=1024 sampling=view clusters=64 visibility=careful bounces=4 resolution=quarter"}},
    {{0.407195687f, 0.516685247f, 0.000937022211f, 0.0405092575f, 1.1008426f, 0.577649117f, 0.631673157f, 0.467484653f}, 0.562500f, 36.0, "ssvp vpls=128 clusters=4 map_size=64 bounces=1 resolution=quarter", 3.66629, 0.446083,
     {"ssvp clusters=4 map_size=64 resolution=quarter", "ssvp vpls=1024 clusters=32 second_vpls=16 visibility=careful bounces=4 resolution=quarter", "ssvp vpls=1024 clusters=64 visibility=careful bounces=4 shadowed_bounces=3 resolution=quarter", "ssvp vpls=1024 clusters=64 visibility=careful bounces=4 shadowed_bounces=3 resolution=quarter", "ssvp vpls=1024 clusters=64 visibility=careful bounces=4 shadowed_bounces=3 resolution=quarter"}},
    {{0.202449322f, 0.0882230625f, 0.000384883868f, 0.132653058f, 0.474601269f, 0.307528704f, 0.0907524973f, 0.0854271352f}, 1.000000f, 246638.0, "ssvp visibility=strict bounces=4 resolution=quarter", 5.22579, 0.637449,
     {"rsm resolution=quarter", "ssvp vpls=1024 clusters=64 second_vpls=8 visibility=careful bounces=4 resolution=quarter", "ssvp vpls=1024 sampling=view clusters=64 visibility=strict resolution=quarter", "ssvp vpls=1024 sampling=view clusters=64 visibility=strict resolution=half", "ssvp vpls=1024 sampling=view clusters=64 visibility=strict resolution=half"}},
    {{0.754287779f, 0.0472536497f, 0.000369523827f, 0.114226133f, 0.956070423f, 0.443419367f, 0.100946859f, 0.246636778f}, 0.941840f, 130991.0, "ssvp clusters=16 visibility=strict bounces=4 resolution=quarter", 5.88853, 0.56811,
     {"rsm vpls=64 resolution=quarter", "ssvp vpls=1024 clusters=64 second_vpls=8 visibility=careful bounces=4 resolution=quarter", "ssvp vpls=1024 sampling=view clusters=64 visibility=careful bounces=4 shadowed_bounces=3 resolution=quarter", "ssvp vpls=1024 sampling=view clusters=64 visibility=careful bounces=4 shadowed_bounces=3 resolution=quarter", "ssvp vpls=1024 sampling=view clusters=64 visibility=careful bounces=4 shadowed_bounces=3 resolution=half"}},
    {{0.385425568f, 0.0150604201f, 0.000393115828f, 0.0832408443f, 0.315444201f, 0.307390332f, 0.0971176326f, 0.280701756f}, 0.997830f, 70691.0, "ssvp vpls=512 clusters=16 visibility=strict bounces=4 resolution=quarter", 6.1257, 1.07991,
     {"ssvp vpls=64 clusters=2 map_size=64 bounces=1 resolution=quarter", "ssvp vpls=512 sampling=view clusters=32 visibility=strict resolution=quarter", "ssvp vpls=1024 sampling=view clusters=64 visibility=strict resolution=quarter", "ssvp vpls=1024 sampling=view clusters=64 visibility=strict resolution=half", "ssvp vpls=1024 sampling=view clusters=64 visibility=strict resolution=half"}},
};
