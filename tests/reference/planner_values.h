// Written by docs/figures/planner.py: what its own arithmetic predicts and chooses, from the unrounded fit.
#pragma once

struct PlannerValue {
    float probes[8];
    double triangles;
    const char* row;  // technique and settings
    double milliseconds, error;
    const char* chosen[5];  // of budgets of 4, 8, 16, 33, 66 ms
};

constexpr PlannerValue kPlannerValues[] = {
    {{0.437388f, 0.514496f, 0.000938608f, 0.0697869f, 1.08313f, 0.570496f, 0.631454f, 0.431601f}, 30.0, "rsm vpls=64 resolution=half", 8.08543, 0.332111,
     {"rsm resolution=half", "rsm resolution=half", "ssvp clusters=16 bounces=4 resolution=half", "ssvp vpls=1024 clusters=64 bounces=4 interleave=8 resolution=half", "ssvp vpls=1024 clusters=64 bounces=4 resolution=half"}},
    {{0.127302f, 0.144086f, 0.000448622f, 0.0448542f, 0.412275f, 0.528424f, 0.232166f, 0.0928074f}, 3982.0, "rsm visibility=voxel resolution=half", 10.2491, 0.385163,
     {"ssvp clusters=4 resolution=half", "ssvp clusters=4 resolution=half", "ssvp vpls=512 clusters=16 bounces=4 resolution=half", "ssvp vpls=1024 clusters=64 bounces=4 resolution=half", "ssvp vpls=1024 clusters=64 bounces=4 resolution=half"}},
    {{0.513754f, 0.640968f, 0.000492076f, 0.151643f, 1.43136f, 0.559233f, 0.624044f, 0.284375f}, 73553.0, "ssvp vpls=64 clusters=4 map_size=64 second_vpls=16 resolution=half", 9.70228, 0.472726,
     {"rsm resolution=half", "rsm resolution=half", "ssvp clusters=16 bounces=4 resolution=half", "ssvp vpls=1024 clusters=32 bounces=4 resolution=half", "ssvp vpls=1024 clusters=64 bounces=4 resolution=half"}},
    {{0.981753f, 0.000858021f, 0.00037879f, 0.0516859f, 0.392244f, 0.281584f, 0.138502f, 0.670846f}, 246638.0, "ssvp clusters=4 resolution=half", 8.95079, 1.39627,
     {"ssvp vpls=64 clusters=2 map_size=64 bounces=1 resolution=half", "rsm vpls=64 resolution=half", "horizon directions=8", "ssvp vpls=1024 clusters=64 resolution=half", "ssvp vpls=1024 clusters=64"}},
    {{0.140894f, 0.240825f, 0.0003782f, 0.0964951f, 2.00712f, 0.522913f, 0.563148f, 0.195046f}, 249788.0, "ssvp shadowed_bounces=1 resolution=half", 10.6397, 0.149565,
     {"rsm resolution=half", "rsm resolution=half", "ssvp clusters=16 bounces=4 shadowed_bounces=1 resolution=half", "ssvp vpls=1024 clusters=32 bounces=4 resolution=half", "ssvp vpls=1024 clusters=64 bounces=4 resolution=half"}},
    {{0.110057f, 0.151209f, 0.000371112f, 0.109133f, 0.683434f, 0.311586f, 0.0800854f, 0.416168f}, 269538.0, "ssvp clusters=16 resolution=half", 10.3519, 0.315983,
     {"ssvp clusters=32 bounces=1 resolution=half", "rsm vpls=64 resolution=half", "ssvp vpls=512 clusters=16 bounces=4 resolution=half", "ssvp vpls=1024 clusters=64 bounces=4 resolution=half", "ssvp vpls=1024 clusters=64 bounces=4 resolution=half"}},
};
