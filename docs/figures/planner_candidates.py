"""What the planner chooses among (planner_measure.py measures it, planner.py makes the table)."""

# What could be on the front of error and time somewhere, from the sweeps in docs/accuracy.md and by trial. All are measured in every
# view; planner.py says which of them are the table.
CANDIDATES = """
rsm vpls=64 resolution=quarter
rsm vpls=64 resolution=half
rsm resolution=quarter
rsm resolution=half
rsm
rsm visibility=voxel resolution=quarter
rsm visibility=voxel resolution=half
ssvp vpls=64 clusters=2 map_size=64 bounces=1 resolution=quarter
ssvp vpls=128 clusters=4 map_size=64 bounces=1 resolution=quarter
ssvp clusters=4 map_size=64 resolution=quarter
ssvp resolution=quarter
ssvp visibility=strict resolution=quarter
ssvp bounces=4 resolution=quarter
ssvp visibility=strict bounces=4 resolution=quarter
ssvp visibility=careful bounces=4 resolution=quarter
ssvp clusters=16 resolution=quarter
ssvp clusters=16 visibility=strict resolution=quarter
ssvp clusters=16 bounces=4 resolution=quarter
ssvp clusters=16 visibility=strict bounces=4 resolution=quarter
ssvp clusters=16 visibility=careful bounces=4 resolution=quarter
ssvp clusters=16 bounces=4 shadowed_bounces=1 resolution=quarter
ssvp clusters=16 visibility=strict bounces=4 shadowed_bounces=1 resolution=quarter
ssvp vpls=512 clusters=16 bounces=4 resolution=quarter
ssvp vpls=512 clusters=16 visibility=strict bounces=4 resolution=quarter
ssvp vpls=512 clusters=16 visibility=careful bounces=4 resolution=quarter
ssvp vpls=512 clusters=16 bounces=4 shadowed_bounces=3 resolution=quarter
ssvp vpls=512 clusters=16 visibility=strict bounces=4 shadowed_bounces=3 resolution=quarter
ssvp vpls=512 clusters=16 visibility=careful bounces=4 shadowed_bounces=3 resolution=quarter
ssvp vpls=512 clusters=32 bounces=4 resolution=quarter
ssvp vpls=512 clusters=32 visibility=strict bounces=4 resolution=quarter
ssvp vpls=512 clusters=32 visibility=careful bounces=4 resolution=quarter
ssvp vpls=1024 clusters=16 visibility=strict bounces=4 resolution=quarter
ssvp vpls=1024 clusters=16 visibility=careful bounces=4 resolution=quarter
ssvp vpls=1024 clusters=32 bounces=4 resolution=quarter
ssvp vpls=1024 clusters=32 second_vpls=8 visibility=careful bounces=4 resolution=quarter
ssvp vpls=1024 clusters=32 second_vpls=16 visibility=careful bounces=4 resolution=quarter
ssvp vpls=1024 clusters=32 visibility=strict bounces=4 resolution=quarter
ssvp vpls=1024 clusters=32 visibility=careful bounces=4 resolution=quarter
ssvp vpls=1024 clusters=64 resolution=quarter
ssvp vpls=1024 clusters=64 visibility=strict resolution=quarter
ssvp vpls=1024 clusters=64 bounces=4 resolution=quarter
ssvp vpls=1024 clusters=64 second_vpls=8 visibility=careful bounces=4 resolution=quarter
ssvp vpls=1024 clusters=64 second_vpls=16 visibility=careful bounces=4 resolution=quarter
ssvp vpls=1024 clusters=64 visibility=strict bounces=4 resolution=quarter
ssvp vpls=1024 clusters=64 visibility=careful bounces=4 resolution=quarter
ssvp vpls=1024 clusters=64 bounces=4 shadowed_bounces=3 resolution=quarter
ssvp vpls=1024 clusters=64 visibility=strict bounces=4 shadowed_bounces=3 resolution=quarter
ssvp vpls=1024 clusters=64 visibility=careful bounces=4 shadowed_bounces=3 resolution=quarter
ssvp vpls=1024 clusters=64 map_size=256 bounces=4 resolution=quarter
ssvp vpls=128 clusters=4 map_size=64 bounces=1 resolution=half
ssvp vpls=64 clusters=4 map_size=64 second_vpls=16 resolution=half
ssvp resolution=half
ssvp bounces=4 resolution=half
ssvp clusters=16 resolution=half
ssvp clusters=16 bounces=4 resolution=half
ssvp clusters=16 visibility=strict bounces=4 resolution=half
ssvp clusters=16 visibility=careful bounces=4 resolution=half
ssvp vpls=512 clusters=16 bounces=4 resolution=half
ssvp vpls=512 clusters=16 visibility=strict bounces=4 resolution=half
ssvp vpls=512 clusters=16 visibility=careful bounces=4 resolution=half
ssvp clusters=32 resolution=half
ssvp clusters=32 bounces=4 resolution=half
ssvp clusters=32 visibility=strict bounces=4 resolution=half
ssvp clusters=32 visibility=careful bounces=4 resolution=half
ssvp vpls=1024 clusters=32 bounces=4 resolution=half
ssvp vpls=1024 clusters=32 visibility=strict bounces=4 resolution=half
ssvp vpls=1024 clusters=32 visibility=careful bounces=4 resolution=half
ssvp vpls=1024 clusters=32 bounces=4 interleave=8 resolution=half
ssvp vpls=1024 clusters=32 visibility=strict bounces=4 interleave=8 resolution=half
ssvp vpls=1024 clusters=32 visibility=careful bounces=4 interleave=8 resolution=half
ssvp vpls=1024 clusters=64 resolution=half
ssvp vpls=1024 clusters=64 visibility=strict resolution=half
ssvp vpls=1024 clusters=64 bounces=4 resolution=half
ssvp vpls=1024 clusters=64 visibility=strict bounces=4 resolution=half
ssvp vpls=1024 clusters=64 visibility=careful bounces=4 resolution=half
ssvp vpls=1024 clusters=64 bounces=4 interleave=8 resolution=half
ssvp vpls=1024 clusters=64 visibility=strict bounces=4 interleave=8 resolution=half
ssvp vpls=1024 clusters=64 visibility=careful bounces=4 interleave=8 resolution=half
ssvp vpls=1024 clusters=64 bounces=4 shadowed_bounces=3 resolution=half
ssvp vpls=1024 clusters=64 visibility=strict bounces=4 shadowed_bounces=3 resolution=half
ssvp vpls=1024 clusters=64 visibility=careful bounces=4 shadowed_bounces=3 resolution=half
ssvp vpls=1024 clusters=64 map_size=256 bounces=4 resolution=half
ssvp
ssvp clusters=16 bounces=4
ssvp vpls=1024 clusters=32 bounces=4
ssvp vpls=1024 clusters=32 visibility=strict bounces=4
ssvp vpls=1024 clusters=32 visibility=careful bounces=4
ssvp vpls=1024 clusters=64 bounces=4
ssvp vpls=1024 clusters=64 visibility=strict bounces=4
ssvp vpls=1024 clusters=64 visibility=careful bounces=4
ssvp vpls=512 sampling=view clusters=16 visibility=strict resolution=quarter
ssvp vpls=512 sampling=view clusters=32 visibility=strict resolution=quarter
ssvp vpls=512 sampling=view clusters=16 visibility=careful bounces=4 resolution=quarter
ssvp vpls=512 sampling=view clusters=16 visibility=strict bounces=4 shadowed_bounces=3 resolution=quarter
ssvp vpls=512 sampling=view clusters=16 visibility=careful bounces=4 shadowed_bounces=3 resolution=quarter
ssvp vpls=512 sampling=view clusters=32 visibility=careful bounces=4 resolution=quarter
ssvp vpls=1024 sampling=view clusters=32 visibility=strict resolution=quarter
ssvp vpls=1024 sampling=view clusters=32 visibility=strict bounces=4 resolution=quarter
ssvp vpls=1024 sampling=view clusters=32 visibility=careful bounces=4 resolution=quarter
ssvp vpls=1024 sampling=view clusters=64 visibility=strict resolution=quarter
ssvp vpls=1024 sampling=view clusters=64 visibility=strict bounces=4 resolution=quarter
ssvp vpls=1024 sampling=view clusters=64 visibility=careful bounces=4 resolution=quarter
ssvp vpls=1024 sampling=view clusters=64 visibility=strict bounces=4 shadowed_bounces=3 resolution=quarter
ssvp vpls=1024 sampling=view clusters=64 visibility=careful bounces=4 shadowed_bounces=3 resolution=quarter
ssvp vpls=1024 sampling=view clusters=64 visibility=strict resolution=half
ssvp vpls=1024 sampling=view clusters=64 visibility=strict bounces=4 shadowed_bounces=3 resolution=half
ssvp vpls=1024 sampling=view clusters=64 visibility=careful bounces=4 shadowed_bounces=3 resolution=half
lpv transport=sweep size=16 directions=96 resolution=half
lpv transport=sweep size=16 directions=96 bounces=4 resolution=half
cone_tracing size=32 cones=6 bounces=0 resolution=quarter
cone_tracing size=32 cones=9 bounces=0 resolution=quarter
cone_tracing size=64 cones=6 bounces=0 resolution=quarter
screen_space samples=16
screen_space
horizon directions=8
horizon
ao samples=8 resolution=half
fallback first=screen_space second=ssvp first.samples=16 second.clusters=16 second.bounces=4 second.resolution=half
fallback first=horizon second=ssvp first.reach=0.25 first.directions=8 second.clusters=16 second.bounces=4 second.resolution=half
fallback first=horizon second=ssvp first.directions=8 second.bounces=3 second.resolution=half
fallback first=screen_space second=cone_tracing first.samples=16 second.size=32 second.cones=6 second.bounces=0 second.resolution=quarter
fallback first=screen_space second=rsm first.samples=16 second.visibility=voxel second.resolution=half
""".strip().splitlines()
# A point alone needs a parameter: one at its default.
ALONE = {"rsm": "vpls=256", "ssvp": "vpls=256", "screen_space": "samples=64", "horizon": "steps=2"}


def parted(candidate):
    technique, _, settings = candidate.partition(" ")
    return technique, settings


def variant(candidate):
    technique, settings = parted(candidate)
    return ",".join([technique, *(settings or ALONE[technique]).split()])


def barred(names):
    """Candidates that never come into the table (planner.py, rows_of_table)."""
    doubted = {name.replace(" visibility=strict", "") for name in names if "visibility=strict" in name}
    return {name for name in names if name in doubted or "map_size=256" in name}


def is_drawn(candidate):
    return parted(candidate)[0] in ("rsm", "ssvp")
