"""Flicker of static VPLs, of phantoms and of instant radiosity, by `lightwell stability`. Used by static_vpl.py."""
import json

from program import ROOT
from static_vpl_bench import beam_area, run_in, spheres

# Sequences of the catalogue, and the scene that their places are placed in.
SEQUENCES = {"light_sweep_slow": "cornell", "light_sweep_quick": "rooms", "moving_object": "rooms"}
TRACED = {"traced 1": "instant_radiosity,vpls=1", "traced 20": "instant_radiosity,vpls=20", "traced 200": "instant_radiosity,vpls=200",
          "traced 200, shadows": "instant_radiosity,vpls=200,shadows=on"}
INDICES = ("flicker", "drift", "spike")


def box_of_the_sequence():
    """Of `moving_object`, in its own coordinates: five faces, and a sphere that dims what passes it."""
    low, high, back, front, top = -1.5, -0.9, -0.3, 0.3, 0.9
    faces = [([low, top / 2, 0], [-1, 0, 0]), ([high, top / 2, 0], [1, 0, 0]), ([(low + high) / 2, top / 2, back], [0, 0, -1]),
             ([(low + high) / 2, top / 2, front], [0, 0, 1]), ([(low + high) / 2, top, 0], [0, 1, 0])]
    vpls = [{"object": "box", "position": p, "normal": n, "reflectance": [0.15, 0.25, 0.6], "weight": 0.36 if n[1] else 0.54} for p, n in faces]
    return vpls, spheres([[(low + high) / 2, top / 2, 0]], 0.5, object="box")


def variants(bench, sequence, scene):
    """By name, what `stability --techniques` takes; files lie in the working folder, since results are named after them."""
    files = {}
    for cap in (20, 200):
        # The lamp turns, so that no place is nearer to where it shines; the door is shut at 4 s.
        vpls = bench.place(scene, f"{scene}_still{cap}", "--cap", cap, "--light-paths", 0, "--time", 4)
        if sequence == "moving_object":
            more, blockers = box_of_the_sequence()
            vpls["vpls"] += more
            vpls["blockers"] = blockers
        files[cap] = bench.write(f"{sequence}_{cap}", vpls).name
    still = bench.work / f"static_vpl_{scene}_still200.json"  # the box of `moving_object` is not in the scene's file
    area = beam_area(bench, ROOT / f"samples/scenes/{scene}.json", f"{scene}_still_area", still, ["--time", 4])
    static = {f"static {cap}": f"static_vpl,vpls_file={file}" for cap, file in files.items()}
    return {"phantom": f"static_vpl,variant=phantom,unit_area={area:.4g},vpls_file={files[200]}", **static, **TRACED}


def flicker(bench):
    """By sequence and variant: the indices with their floors, and the errors."""
    found = bench.kept("flicker")
    for sequence, scene in SEQUENCES.items():
        rows = found.setdefault(sequence, {})
        due = {name: technique for name, technique in variants(bench, sequence, scene).items() if name not in rows}
        if not due:
            continue
        folder = bench.work / "static_vpl_stability"
        run_in(bench.work, bench.options.lightwell, "stability", "--out", folder.resolve(), "--no-report", "--sequences", sequence,
               "--techniques", *due.values())
        results = json.loads((folder / "stability.json").read_text(encoding="utf-8"))["results"]
        for name, technique in due.items():
            r = next(r for r in results if r["technique"] == technique and r["sequence"] == sequence)
            rows[name] = {**{i: [r["indices"][i], r["floors"][i]] for i in INDICES}, "relMSE": r["errors"]["relMSE"], "bias": r["errors"]["bias"],
                          "frames": [f["flicker"] for f in r["frames"]]}
        bench.keep("flicker", found)
    return found
