"""What ten Brug 2017 (appendix A.3) publishes of voxel cone tracing, row by row, and the command line that stands for each row. Used by
cone_tracing_thesis.py. Three entries of its Table 6.2 are others than the appendix has: cascaded 128 with VAO in the overview (6.5 for 7.53),
with SH and VAO there (6.5 for 6.63), and 32 with VAO before the cloth (7.0 for 7.07)."""

# As the source: nine cones of 60 degrees at every pixel, steps of a diameter, opacity as it is in the voxels, no cure of leaks; it counts
# voxels by their diagonals, sqrt(3) of our edges, so its nudge of 1 in the basic scene is 1.73 of ours, and its 0.5 in Sponza 0.87.
NUDGE = {"basic": "nudge=1.73", "sponza": "nudge=0.87"}
SOURCE = ["cones=9", "resolution=full", "step=1", "opacity_correction=off", "normal_aware=off", NUDGE]
# Four grids, the finest 10 m wide (ours is this Sponza's unit; the source does not say what its own is), so the largest 80.
NESTED = ["cascades=4", "extent=80"]
# The source's follows cones for all of their light's way.
VAO = ["occlusion=all", "occlusion_distance=2"]
NEAR = ["occlusion=near"]
MODES = {"isotropic": "isotropic", "SH": "sh2"}


def source_rows():
    """Row: technique, settings, whether its light is multiplied by SSAO."""
    rows = {}
    for nested in ("", "cascaded "):
        for size in (32, 128):
            for title, mode in MODES.items():
                settings = [f"size={size}", f"mode={mode}", *SOURCE, *(NESTED if nested else [])]
                name = f"{nested}{title} {size}"
                rows[name] = ("cone_tracing", settings, False)
                rows[f"{name}, SSAO"] = ("cone_tracing", settings, True)
                rows[f"{name}, VAO"] = ("cone_tracing", [*settings, *VAO], False)
    return rows


ROWS = source_rows()

# Not in the source.
NORMAL_AWARE = ["cones=9", "resolution=full", "mode=anisotropic", "normal_aware=on"]
OURS = {
    "direct light only": ("none", [], False),
    "SH 32, near": ("cone_tracing", [*ROWS["SH 32"][1], *NEAR], False),
    "SH 128, near": ("cone_tracing", [*ROWS["SH 128"][1], *NEAR], False),
    "normal-aware 32": ("cone_tracing", ["size=32", *NORMAL_AWARE], False),
    "normal-aware 128": ("cone_tracing", ["size=128", *NORMAL_AWARE], False)}

PUBLISHED = {
    ("basic", "overview"): {
        "isotropic 32": 6.725, "isotropic 32, SSAO": 6.83063, "isotropic 32, VAO": 6.90634,
        "SH 32": 7.94017, "SH 32, SSAO": 8.02049, "SH 32, VAO": 8.14196,
        "isotropic 128": 7.72177, "isotropic 128, SSAO": 7.80809, "isotropic 128, VAO": 7.82198,
        "SH 128": 8.1662, "SH 128, SSAO": 8.21534, "SH 128, VAO": 8.19092},
    ("basic", "bleeding"): {
        "isotropic 32": 5.68233, "isotropic 32, SSAO": 5.73776, "isotropic 32, VAO": 6.17783,
        "SH 32": 8.04488, "SH 32, SSAO": 8.11504, "SH 32, VAO": 8.80377,
        "isotropic 128": 8.12149, "isotropic 128, SSAO": 8.19119, "isotropic 128, VAO": 8.40112,
        "SH 128": 8.16055, "SH 128, SSAO": 8.18867, "SH 128, VAO": 8.18941},
    ("sponza", "overview"): {
        "isotropic 32": 6.04972, "isotropic 32, SSAO": 6.32192, "isotropic 32, VAO": 7.3811,
        "SH 32": 7.47038, "SH 32, SSAO": 7.45351, "SH 32, VAO": 6.65364,
        "cascaded isotropic 32": 6.50038, "cascaded isotropic 32, SSAO": 6.63723, "cascaded isotropic 32, VAO": 7.49734,
        "cascaded SH 32": 7.56519, "cascaded SH 32, SSAO": 7.53097, "cascaded SH 32, VAO": 7.03117,
        "isotropic 128": 6.7757, "isotropic 128, SSAO": 6.94764, "isotropic 128, VAO": 7.44524,
        "SH 128": 7.33576, "SH 128, SSAO": 7.28739, "SH 128, VAO": 7.01389,
        "cascaded isotropic 128": 7.5559, "cascaded isotropic 128, SSAO": 7.56632, "cascaded isotropic 128, VAO": 7.52922,
        "cascaded SH 128": 6.88213, "cascaded SH 128, SSAO": 6.83252, "cascaded SH 128, VAO": 6.62664},
    ("sponza", "cloth"): {
        "isotropic 32": 5.72353, "isotropic 32, SSAO": 6.2168, "isotropic 32, VAO": 7.07407,
        "SH 32": 7.27794, "SH 32, SSAO": 7.18962, "SH 32, VAO": 7.20493,
        "cascaded isotropic 32": 6.11409, "cascaded isotropic 32, SSAO": 6.49928, "cascaded isotropic 32, VAO": 7.43055,
        "cascaded SH 32": 7.37627, "cascaded SH 32, SSAO": 7.2963, "cascaded SH 32, VAO": 7.37576,
        "isotropic 128": 6.35485, "isotropic 128, SSAO": 6.55574, "isotropic 128, VAO": 6.9726,
        "SH 128": 7.38036, "SH 128, SSAO": 7.26363, "SH 128, VAO": 7.26962,
        "cascaded isotropic 128": 6.7976, "cascaded isotropic 128, SSAO": 6.83765, "cascaded isotropic 128, VAO": 7.08996,
        "cascaded SH 128": 7.36901, "cascaded SH 128, SSAO": 7.2539, "cascaded SH 128, VAO": 7.208}}
