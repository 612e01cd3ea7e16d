"""What ten Brug 2017 (appendix A.3) publishes of LPV, row by row, and the command line that stands for each row. Used by lpv_thesis.py."""

# Its geometry volume is made of the shadow map and the camera's depth. Cascades: four grids, the finest 10 m wide (ours is this Sponza's
# unit; the source does not say what its own is), so the largest 80.
PLAIN, NESTED = ["geometry_volume=screen"], ["geometry_volume=screen", "cascades=4", "extent=80"]
# Row: technique, settings, whether its light is multiplied by SSAO.
ROWS = {
    "LPV 32": ("lpv", ["size=32", *PLAIN], False), "LPV 32, SSAO": ("lpv", ["size=32", *PLAIN], True),
    "LPV 64": ("lpv", ["size=64", *PLAIN], False), "LPV 64, SSAO": ("lpv", ["size=64", *PLAIN], True),
    "cascaded LPV 32": ("lpv", ["size=32", *NESTED], False), "cascaded LPV 32, SSAO": ("lpv", ["size=32", *NESTED], True),
    "cascaded LPV 64": ("lpv", ["size=64", *NESTED], False), "cascaded LPV 64, SSAO": ("lpv", ["size=64", *NESTED], True)}
CASCADED = [row for row in ROWS if row.startswith("cascaded")]

# Not in the source.
OURS = {
    "direct light only": ("none", [], False),
    "propagate 32, blocked by triangles": ("lpv", ["size=32", "geometry_volume=triangles"], False),
    "propagate 32, nothing blocks": ("lpv", ["size=32", "geometry_volume=off"], False),
    "sweep 16": ("lpv", ["size=16", "transport=sweep"], False), "sweep 32": ("lpv", ["size=32", "transport=sweep"], False),
    "sweep 32, SSAO": ("lpv", ["size=32", "transport=sweep"], True),
    "sweep 16, 3 bounces": ("lpv", ["size=16", "transport=sweep", "bounces=3"], False),
    "sweep 32, 3 bounces": ("lpv", ["size=32", "transport=sweep", "bounces=3"], False),
    "sweep 32, 3 bounces, SSAO": ("lpv", ["size=32", "transport=sweep", "bounces=3"], True)}

PUBLISHED = {
    ("basic", "overview"): {"LPV 32": 7.35972, "LPV 32, SSAO": 7.41518, "LPV 64": 7.52197, "LPV 64, SSAO": 7.57575},
    ("basic", "bleeding"): {"LPV 32": 7.46911, "LPV 32, SSAO": 7.50752, "LPV 64": 7.34371, "LPV 64, SSAO": 7.0},
    ("sponza", "overview"): {"LPV 32": 6.92271, "LPV 32, SSAO": 7.1096, "cascaded LPV 32": 7.15292, "cascaded LPV 32, SSAO": 7.25342,
                             "LPV 64": 7.10905, "LPV 64, SSAO": 7.13586, "cascaded LPV 64": 6.80618, "cascaded LPV 64, SSAO": 6.80623},
    ("sponza", "cloth"): {"LPV 32": 7.20196, "LPV 32, SSAO": 7.12059, "cascaded LPV 32": 7.10172, "cascaded LPV 32, SSAO": 7.08763,
                          "LPV 64": 7.23175, "LPV 64, SSAO": 7.16263, "cascaded LPV 64": 7.14802, "cascaded LPV 64, SSAO": 7.07308}}
