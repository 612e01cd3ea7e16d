"""Renders the scenes of room.py with Blender's Cycles, for docs/hosts.md. Nothing here knows Lightwell.

    blender -b --factory-startup -P docs/hosts/blender.py -- --out DIR [--scene spot|empty|sun|sphere] [--size 384x256] [--rsm 256] [--spp 1024] [--half]

Writes SCENE.exr (what Lightwell is given: Position, Normal, Depth, DiffCol, DiffDir), SCENE_rsm*.exr (the same from the lamp), SCENE_one_a.exr,
SCENE_one_b.exr, SCENE_all_a.exr and SCENE_all_b.exr (pass DiffInd of one indirect bounce and of all, the truth, in two halves by which its noise is
known), and the camera and light files, from Blender's own matrices.
"""
import json
import math
import pathlib
import sys

import bpy
import mathutils

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import room  # noqa: E402

ALL_BOUNCES = 64


def material(colour):
    """Principled is not purely diffuse; a Diffuse BSDF of roughness 0 is Lambert's."""
    result = bpy.data.materials.new("diffuse")
    result.use_nodes = True
    nodes = result.node_tree.nodes
    nodes.clear()
    diffuse, output = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
    diffuse.inputs["Color"].default_value = (*colour, 1.0)
    result.node_tree.links.new(diffuse.outputs[0], output.inputs[0])
    return result


def add_surfaces(surfaces):
    for corners, colour in surfaces:
        mesh = bpy.data.meshes.new("quad")
        mesh.from_pydata(corners, [], [range(len(corners))])
        mesh.materials.append(material(colour))
        bpy.context.scene.collection.objects.link(bpy.data.objects.new("quad", mesh))


def add_sphere():
    bpy.ops.mesh.primitive_uv_sphere_add(radius=room.SPHERE["radius"], segments=512, ring_count=256)
    sphere = bpy.context.object
    bpy.ops.object.shade_smooth()
    sphere.data.materials.append(material((room.SPHERE["reflectance"],) * 3))


def looking(eye, ahead, up):
    """Blender's cameras and lamps look down their -z, +y is up."""
    back = -mathutils.Vector(ahead).normalized()
    right = mathutils.Vector(up).cross(back).normalized()
    matrix = mathutils.Matrix((right, back.cross(right), back)).transposed().to_4x4()
    matrix.translation = eye
    return matrix


def add_camera(eye, ahead, up, fov_degrees=None, extent=None):
    data = bpy.data.cameras.new("camera")
    camera = bpy.data.objects.new("camera", data)
    bpy.context.scene.collection.objects.link(camera)
    camera.matrix_world = looking(eye, ahead, up)
    data.clip_start, data.clip_end = 0.001, 100.0
    data.sensor_fit = "VERTICAL"
    if extent is None:
        data.angle = math.radians(fov_degrees)
    else:
        data.type, data.ortho_scale = "ORTHO", extent
    return camera


def add_lamp(kind, matrix):
    data = bpy.data.lights.new("lamp", kind)
    lamp = bpy.data.objects.new("lamp", data)
    bpy.context.scene.collection.objects.link(lamp)
    lamp.matrix_world = matrix
    return data


def camera_json(camera):
    """The camera as Lightwell's camera file, from what Blender holds."""
    result = {"to_world": [value for row in camera.matrix_world for value in row], "axes": "blender", "depth": "axial"}
    if camera.data.type == "ORTHO":
        result["orthographic_height"] = camera.data.ortho_scale
    else:
        result["vertical_fov_degrees"] = math.degrees(camera.data.angle)
    return result


def write_json(path, what, content):
    content = {"format": "lightwell-" + what, "version": 1, **content}
    path.write_text("{" + ",\n ".join(f"{json.dumps(key)}: {json.dumps(value)}" for key, value in content.items()) + "}\n")


def render(path, camera, size, passes, samples=1, bounces=0, half=False, seed=1):
    scene = bpy.context.scene
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.seed = "CPU", samples, seed
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", 0.01  # every path through the pixel's centre
    cycles.max_bounces = cycles.diffuse_bounces = bounces
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0  # clamping would take light away
    cycles.light_sampling_threshold = 0.0
    layer = bpy.context.view_layer
    layer.use_pass_combined = False
    for name in ("position", "normal", "z", "diffuse_color", "diffuse_direct", "diffuse_indirect"):
        setattr(layer, "use_pass_" + name, name in passes)
    image = scene.render.image_settings
    image.file_format, image.color_depth, image.exr_codec = "OPEN_EXR_MULTILAYER", "16" if half else "32", "ZIP"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


SEEN = ("position", "normal", "z", "diffuse_color", "diffuse_direct")
SEEN_BY_LAMP = ("position", "normal", "diffuse_color")


def spot_profile(lamp, steps=360):
    """How a spot of Blender 3.4 falls off from its axis, at even steps from 0 to 180 degrees: with the cosine, as measured
    (docs/hosts.md), and smoothly towards the cone's edge where spot_blend is above 0."""
    edge, factors = math.cos(0.5 * lamp.spot_size), []
    for i in range(steps + 1):
        cosine = math.cos(math.pi * i / steps)
        ramp = min(max((cosine - edge) / max((1.0 - edge) * lamp.spot_blend, 1e-9), 0.0), 1.0) if lamp.spot_blend > 0.0 else 1.0
        factors.append(round(max(cosine, 0.0) * ramp * ramp * (3.0 - 2.0 * ramp), 6))
    return factors


def build_spot():
    spot = room.SPOT
    ahead = room.minus(spot["target"], spot["position"])
    lamp = add_lamp("SPOT", looking(spot["position"], ahead, spot["up"]))
    lamp.energy = 4.0 * math.pi * spot["intensity"][0]  # W as though it shone all around
    lamp.spot_size, lamp.spot_blend = math.radians(2.0 * spot["outer_cone_degrees"]), 0.0
    lamp.shadow_soft_size = 0.0  # a point, as an RSM takes it to be
    camera = add_camera(spot["position"], ahead, spot["up"], 2.0 * spot["outer_cone_degrees"])
    half_angle = 0.5 * math.degrees(lamp.spot_size)
    light = {"kind": "spot", "position": list(spot["position"]), "direction": list(ahead), "power": lamp.energy,
             "inner_cone_degrees": half_angle, "outer_cone_degrees": half_angle, "profile": spot_profile(lamp)}
    return light, [camera]


def build_sun():
    sun = room.SUN
    lamp = add_lamp("SUN", looking((0.0, 0.0, 0.0), sun["direction"], sun["up"]))
    lamp.energy, lamp.angle = sun["irradiance"][0], 0.0
    camera = add_camera(room.sun_eye(), sun["direction"], sun["up"], extent=sun["extent"])
    return {"kind": "sun", "direction": list(sun["direction"]), "irradiance": lamp.energy}, [camera]


def build_sphere():
    lamp = add_lamp("POINT", mathutils.Matrix.Identity(4))
    lamp.energy, lamp.shadow_soft_size = 4.0 * math.pi * room.SPHERE["intensity"], 0.0
    cameras = [add_camera((0.0, 0.0, 0.0), ahead, up, 90.0) for ahead, up in room.FACES]
    return {"kind": "point", "position": [0.0, 0.0, 0.0], "power": lamp.energy}, cameras


def main():
    options = room.options(__doc__, sys.argv[sys.argv.index("--") + 1:])
    out, name = pathlib.Path(options.out).resolve(), options.scene
    out.mkdir(parents=True, exist_ok=True)
    size = tuple(int(part) for part in options.size.split("x"))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.world = bpy.data.worlds.new("black")
    bpy.context.scene.world.use_nodes = False
    bpy.context.scene.world.color = (0.0, 0.0, 0.0)
    if name == "sphere":
        add_sphere()
    else:
        add_surfaces(room.room_surfaces(blocks=name != "empty"))
    light, maps = {"spot": build_spot, "empty": build_spot, "sun": build_sun, "sphere": build_sphere}[name]()
    view = room.SPHERE_CAMERA if name == "sphere" else room.CAMERA
    camera = add_camera(view["position"], room.minus(view["target"], view["position"]), view["up"], view["vertical_fov_degrees"])
    bpy.context.view_layer.update()

    render(out / f"{name}.exr", camera, size, SEEN, half=options.half)
    for i, lamp_camera in enumerate(maps):
        number = str(i) if len(maps) > 1 else ""
        render(out / f"{name}_rsm{number}.exr", lamp_camera, (options.rsm, options.rsm), SEEN_BY_LAMP, half=options.half)
    for bounces, what in ((1, "one"), (ALL_BOUNCES, "all")):
        for seed, part in ((1, "a"), (2, "b")):
            render(out / f"{name}_{what}_{part}.exr", camera, size, ("diffuse_indirect",), options.spp // 2, bounces, options.half, seed)
    write_json(out / f"{name}_camera.json", "camera", {"camera": camera_json(camera)})
    light["cameras"] = [camera_json(each) for each in maps]
    write_json(out / f"{name}_light.json", "light", light)


main()
