"""What it costs when lpv's grids move on by cells: passes that make what blocks light. Used by lpv_crossing.py."""
import json

from program import caller

FILE = "lpv_crossing_cost.json"  # what is measured, kept row by row: a call that was ended goes on from there
CELLS, CASCADES, EXTENT = 32, 3, 40
CELL = EXTENT / 2 ** (CASCADES - 1) / CELLS  # m, of the finest grid: cells of the middle one begin at every second, those of the largest at every fourth
LAST, FRAMES, WARMUP = 36, 7, 3
# From which cell of the finest grid to which the eye goes, and back in the next frame.
MOVES = {"nothing": ([0, 8, 0], [0, 8, 0]), "a cell along x": ([0, 8, 0], [1, 8, 0]), "a cell along x, the middle grid's too": ([1, 8, 0], [2, 8, 0]),
         "a cell along x, every grid's": ([3, 8, 0], [4, 8, 0]), "a cell along x, y and z, the middle grid's too": ([1, 9, 1], [2, 10, 2]),
         "4 cells along x": ([3, 8, 0], [7, 8, 0]), "16 cells along x": ([-9, 8, 0], [7, 8, 0]), "64 cells along x": ([-29, 8, 0], [35, 8, 0])}
# What makes blockers, and settings that keep short what is not looked at.
TRANSPORTS = {"sweep": (["transport=sweep", "directions=96"], ["lpv_sweep.cover"]),
              "propagate": (["transport=propagate", "steps=8"], ["lpv_blocking.inject", "lpv_blocking.merge", "lpv_blocking.faces"])}
RESOLVE = "lpv_sweep.resolve"


def measure(options, scene):
    """scene(camera, name): a scene file. Builds take turns, so that all of a row are of one time."""
    path = options.work / FILE
    found = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    builds = {"now": options.lightwell, **({"before": options.before} if options.before else {})}
    for move, places in MOVES.items():
        for transport, (settings, _) in TRANSPORTS.items():
            for build, program in builds.items():
                row = f"{move} | {transport} | {build}"
                if row not in found:
                    file = scene(camera(*places), "moving")
                    found[row] = passes(caller(program), file, settings)
                    path.write_text(json.dumps(found, indent=1), encoding="utf-8")
    return found


def camera(one, other):
    keys = []
    for second in range(LAST + 1):
        position = [CELL * (cell + 0.5) for cell in (other if second % 2 else one)]
        keys.append({"time": second, "position": position, "target": [position[0] + 16, position[1] + 1, position[2]]})
    return {"name": "view", "vertical_fov_degrees": 60, "position": keys[0]["position"], "target": keys[0]["target"], "keys": keys}


def passes(call, file, settings):
    sets = [f"size={CELLS}", f"cascades={CASCADES}", f"extent={EXTENT}", *settings]
    made = json.loads(call("render", file, "--technique", "lpv", *(part for s in sets for part in ("--set", s)), "--size", "64x36", "--rsm-size", 128,
                           "--warmup", WARMUP, "--frames", FRAMES, "--time", LAST, "--step", 1, "--json"))
    return {p["name"]: p["ms"] for p in made["passes"]}


def tables(found):
    builds = [build for build in ("before", "now") if any(row.endswith(build) for row in found)]
    heads = [f"{transport}: {build}" if len(builds) > 1 else transport for transport in TRANSPORTS for build in builds]
    lines = ["| the eye moves by | grids that move | " + " | ".join(heads) + " |", "| --- |" + " ---: |" * (1 + len(heads))]
    for move, places in MOVES.items():
        times = [blockers(found[f"{move} | {transport} | {build}"], transport) for transport in TRANSPORTS for build in builds]
        lines.append(f"| {move} | {moved(*places)} | " + " | ".join(f"{t:.2g}" if t < 10 else f"{t:.0f}" for t in times) + " |")
    at_rest = [f"{found[f'nothing | sweep | {build}'][RESOLVE]:.1f} ms {build}" for build in builds]
    return lines + ["", f"All `{RESOLVE}` of a frame of sweeps at rest: {', '.join(at_rest)}."]


def blockers(times, transport):
    return sum(times.get(name, 0) for name in TRANSPORTS[transport][1])


def moved(one, other):
    """How many grids' cells the eye leaves: each grid begins at whole cells of its own."""
    return sum(any(a // 2 ** grid != b // 2 ** grid for a, b in zip(one, other)) for grid in range(CASCADES))
