"""Renders the scenes of room.py with Mitsuba 3, for docs/hosts.md. Nothing here knows Lightwell.

    python3 -m venv build/mitsuba && build/mitsuba/bin/pip install mitsuba
    build/mitsuba/bin/python docs/hosts/mitsuba3.py --out DIR [--scene spot|empty|sun|sphere] [--size 384x256] [--rsm 256] [--spp 1024] [--half]

Writes SCENE.exr (integrator `aov` around `path` of depth 2: position, sh_normal, albedo, depth and direct radiance), SCENE_rsm*.exr (the same from
the lamp), SCENE_one_a.exr, SCENE_one_b.exr, SCENE_all_a.exr and SCENE_all_b.exr (irradiance of one indirect bounce and of all, W/m^2, the truth in
two halves by which its noise is known: paths of one length less those of direct light, times pi over albedo), and the camera and light files. Y is up here, and the camera looks down +z.
"""
import json
import pathlib
import sys

import drjit as dr
import mitsuba as mi

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import room  # noqa: E402

mi.set_variant("llvm_ad_rgb")
DIRECT, ONE_BOUNCE, ALL_BOUNCES = 2, 3, 65  # `max_depth`: 1 is what glows, 2 lit surfaces, 3 one indirect bounce
NEAR = 0.05
AOVS = "position:position,normal:sh_normal,albedo:albedo,depth:depth"


def y_up(v):
    return [v[0], v[2], -v[1]]


def surface(corners, colour):
    a, b, c, d = (y_up(corner) for corner in corners)
    mesh = mi.Mesh("quad", 4, 2, has_vertex_normals=False, has_vertex_texcoords=False)
    params = mi.traverse(mesh)
    params["vertex_positions"] = mi.Float([*a, *b, *c, *d])
    params["faces"] = mi.UInt32([0, 1, 2, 0, 2, 3])
    params.update()
    path = pathlib.Path(surface.folder) / f"quad{surface.count}.ply"
    surface.count += 1
    mesh.write_ply(str(path))
    return {"type": "ply", "filename": str(path), "face_normals": True,
            "bsdf": {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": list(colour)}}}}


def looking(eye, ahead, up):
    return mi.ScalarTransform4f().look_at(origin=y_up(eye), target=y_up(room.plus(eye, ahead)), up=y_up(up))


def sensor(to_world, size, half, fov_degrees=None):
    lens = {"type": "perspective", "fov": fov_degrees, "fov_axis": "y"} if fov_degrees else {"type": "orthographic"}
    return mi.load_dict({**lens, "to_world": to_world, "near_clip": NEAR, "far_clip": 100.0,
                         "film": {"type": "hdrfilm", "width": size[0], "height": size[1], "rfilter": {"type": "box"},
                                  "component_format": "float16" if half else "float32"},
                         "sampler": {"type": "stratified", "sample_count": 1, "jitter": False}})  # the pixel's centre


def camera_json(to_world, fov_degrees=None):
    matrix = [float(to_world.matrix[row, column]) for row in range(4) for column in range(4)]
    lens = {"vertical_fov_degrees": fov_degrees} if fov_degrees else {"orthographic_height": 2.0}
    # `depth` of the integrator is the ray's length, which begins at the near plane.
    depth = {"depth": "radial", "depth_from_near": NEAR} if fov_degrees else {"depth": "axial", "depth_from_near": NEAR}
    return {"to_world": matrix, "axes": "mitsuba", **lens, **depth}


def write_json(path, what, content):
    content = {"format": "lightwell-" + what, "version": 1, **content}
    path.write_text("{" + ",\n ".join(f"{json.dumps(key)}: {json.dumps(value)}" for key, value in content.items()) + "}\n")


def render_aovs(path, scene, view):
    inner = {"type": "path", "max_depth": DIRECT, "hide_emitters": True}
    integrator = mi.load_dict({"type": "aov", "aovs": AOVS, "direct": inner})
    mi.render(scene, sensor=view, integrator=integrator, spp=1)
    view.film().bitmap().write(str(path))


def radiance(scene, view, size, depth, spp, seed=1):
    """Mean radiance of Mitsuba's own path tracer along the rays of the pixels' centres."""
    width, height = size
    index = dr.arange(mi.UInt32, width * height)
    x, y = index % width, index // width
    film = mi.Vector2f((mi.Float(x) + 0.5) / width, (mi.Float(y) + 0.5) / height)
    integrator = mi.load_dict({"type": "path", "max_depth": depth, "rr_depth": 8, "hide_emitters": True})
    total = dr.zeros(mi.Color3f, width * height)
    at_once = max(1, min(spp, (1 << 22) // (width * height)))  # as many as memory likes
    done = 0
    while done < spp:
        count = min(at_once, spp - done)
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(100000 * seed + done, width * height * count)
        which = dr.arange(mi.UInt32, width * height * count) // count
        place = mi.Vector2f(dr.gather(mi.Float, film.x, which), dr.gather(mi.Float, film.y, which))
        ray, _ = view.sample_ray_differential(0.0, 0.5, place, mi.Vector2f(0.5))
        colour, _, _ = integrator.sample(scene, sampler, ray)
        for channel in range(3):
            total[channel] += dr.block_sum(colour[channel], count)
        dr.eval(total)
        done += count
    return total / spp, film


def write_truth(path, scene, view, size, depth, spp, half, seed):
    width, height = size
    more, film = radiance(scene, view, size, depth, spp, seed)
    direct, _ = radiance(scene, view, size, DIRECT, 1)  # from a point: without noise
    ray, _ = view.sample_ray_differential(0.0, 0.5, film, mi.Vector2f(0.5))
    hit = scene.ray_intersect(ray)
    albedo = hit.bsdf(ray).eval_diffuse_reflectance(hit, hit.is_valid())
    irradiance = [dr.select(hit.is_valid() & (albedo[c] > 0.0), dr.pi * (more[c] - direct[c]) / albedo[c], 0.0) for c in range(3)]
    flat = dr.ravel(mi.Color3f(*irradiance))
    picture = mi.Bitmap(mi.TensorXf(flat, shape=(height, width, 3)), pixel_format=mi.Bitmap.PixelFormat.RGB)
    kind = mi.Struct.Type.Float16 if half else mi.Struct.Type.Float32
    picture.convert(pixel_format=mi.Bitmap.PixelFormat.RGB, component_format=kind, srgb_gamma=False).write(str(path))


def build(name, folder):
    surface.folder, surface.count = folder, 0
    if name == "sphere":
        sphere = {"type": "sphere", "radius": room.SPHERE["radius"], "flip_normals": True,
                  "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": room.SPHERE["reflectance"]}}}
        shapes = {"sphere": sphere}
    else:
        shapes = {f"quad{i}": surface(*each) for i, each in enumerate(room.room_surfaces(blocks=name != "empty"))}
    return shapes


def spot():
    of = room.SPOT
    ahead, cone = room.minus(of["target"], of["position"]), of["outer_cone_degrees"]
    to_world = looking(of["position"], ahead, of["up"])
    lamp = {"type": "spot", "to_world": to_world, "intensity": {"type": "rgb", "value": list(of["intensity"])},
            "cutoff_angle": cone, "beam_width": cone}
    light = {"kind": "spot", "position": y_up(of["position"]), "direction": y_up(ahead), "intensity": list(of["intensity"]),
             "inner_cone_degrees": cone, "outer_cone_degrees": cone}
    return lamp, light, [(to_world, 2.0 * cone)]


def sun():
    of = room.SUN
    lamp = {"type": "directional", "direction": y_up(of["direction"]), "irradiance": {"type": "rgb", "value": list(of["irradiance"])}}
    light = {"kind": "sun", "direction": y_up(of["direction"]), "irradiance": list(of["irradiance"])}
    half = of["extent"] / 2
    return lamp, light, [(looking(room.sun_eye(), of["direction"], of["up"]) @ mi.ScalarTransform4f().scale([half, half, 1.0]), None)]


def point():
    value = room.SPHERE["intensity"]
    lamp = {"type": "point", "position": [0, 0, 0], "intensity": {"type": "rgb", "value": value}}
    light = {"kind": "point", "position": [0, 0, 0], "intensity": value}
    return lamp, light, [(looking((0, 0, 0), ahead, up), 90.0) for ahead, up in room.FACES]


def main():
    options = room.options(__doc__, sys.argv[1:])
    out, name = pathlib.Path(options.out).resolve(), options.scene
    out.mkdir(parents=True, exist_ok=True)
    size = tuple(int(part) for part in options.size.split("x"))
    lamp, light, maps = {"spot": spot, "empty": spot, "sun": sun, "sphere": point}[name]()
    scene = mi.load_dict({"type": "scene", "lamp": lamp, **build(name, out)})
    of = room.SPHERE_CAMERA if name == "sphere" else room.CAMERA
    to_world, fov = looking(of["position"], room.minus(of["target"], of["position"]), of["up"]), of["vertical_fov_degrees"]
    view = sensor(to_world, size, options.half, fov)

    render_aovs(out / f"{name}.exr", scene, view)
    for i, (place, angle) in enumerate(maps):
        number = str(i) if len(maps) > 1 else ""
        render_aovs(out / f"{name}_rsm{number}.exr", scene, sensor(place, (options.rsm, options.rsm), options.half, angle))
    for depth, what in ((ONE_BOUNCE, "one"), (ALL_BOUNCES, "all")):
        for seed, part in ((1, "a"), (2, "b")):
            write_truth(out / f"{name}_{what}_{part}.exr", scene, view, size, depth, options.spp // 2, options.half, seed)
    write_json(out / f"{name}_camera.json", "camera", {"camera": camera_json(to_world, fov)})
    light["cameras"] = [camera_json(*each) for each in maps]
    write_json(out / f"{name}_light.json", "light", light)
    for path in out.glob("quad*.ply"):
        path.unlink()


main()
