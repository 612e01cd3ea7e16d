"""The first pictures of technique static_vpl from the command line: with places alone, and with spheres that a hand set. Used by static_vpl.py."""
from static_vpl_bench import lattice, spheres


def cornell_spheres():
    """Two in the short block, four in the tall one: wide enough to dim, too narrow to reach the lit floor beside them."""
    return spheres([[0.186, 0.05, 0.169], [0.186, 0.115, 0.169]], 0.08) + spheres(lattice([0.368, 0.05, 0.351], [0.368, 0.28, 0.351], 0.077), 0.085)


def rooms_spheres():
    """Both parts of the wall between the rooms, half a radius apart, and the lintel. The door stands open."""
    wall = [p for p in lattice([0, 0, -2], [0, 2.6, 2], 0.15) if abs(p[2]) > 0.69 or p[1] > 2.24]
    return spheres(wall, 0.3)


def sponza_spheres():
    """The floors and roofs over both aisles and at both ends; the court is open to the sky."""
    sides = [p for z in (-1, 1) for p in lattice([-14, 0, z * 3.3], [13, 0, z * 8], 0.9)]
    ends = [p for x in (-1, 1) for p in lattice([x * 9.6, 0, -2.4], [x * 13.6, 0, 2.4], 0.9)]
    return spheres([[x, 10.2, z] for x, _, z in sides + ends], 1.8) + spheres([[x, 4.9, z] for x, _, z in sides], 1.8)


# A sun's strip of floor in Sponza is narrower than the spacing of 256 places, and paths of the sun itself would find places on the roof.
SCENES = {"cornell": (cornell_spheres, []), "rooms": (rooms_spheres, []),
          "sponza_crytek": (sponza_spheres, ["--cap", 2048, "--paths", 16384, "--light-paths", 0])}


def first(bench):
    """By scene and way: the errors against one bounce; and the pictures."""
    found, exrs = bench.kept("first"), {}
    for scene, (blockers, placing) in SCENES.items():
        vpls = bench.place(scene, f"{scene}_places", *placing)
        files = {"places": bench.write(f"{scene}_alone", vpls), "places and spheres": bench.write(f"{scene}_spheres", {**vpls, "blockers": blockers()})}
        truth = bench.truth(scene, f"{scene}_first_truth", 1, bench.options.spp)
        exrs[scene] = {"truth": truth}
        for way, file in files.items():
            exrs[scene][way] = bench.render(scene, f"{scene}_{way}".replace(" ", "_"), "static_vpl", [f"vpls_file={file}"])[0]
        exrs[scene]["traced, no shadows"] = bench.render(scene, f"{scene}_traced", "instant_radiosity", ["vpls=200"])[0]
        found.setdefault(scene, {way: bench.compare(exr, truth) for way, exr in exrs[scene].items() if way != "truth"})
        found[scene].update(spheres=len(blockers()), vpls=len(vpls["vpls"]))
    return bench.keep("first", found), exrs
