# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: blender -b -t 1 -P cycles.py -- JOB.json
#
# Renders the first frames of a fringe tunnel's scan in Cycles and writes the CPU time of each. One
# Blender unit is 1 mm. The stripes move in the tunnel's material, so that no geometry changes
# between frames. Needs no NumPy: Debian's Blender only recommends it.
import array
import json
import math
import sys
import time

import bpy

with open(sys.argv[sys.argv.index("--") + 1], encoding="utf-8") as file:
    job = json.load(file)


def new_object(name, data):
    made = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(made)
    return made


def mesh_of(name, vertices, corners, per_face):
    """A mesh from flat arrays: coordinates, and vertex numbers of faces of equal size."""
    mesh = bpy.data.meshes.new(name)
    faces = len(corners) // per_face
    mesh.vertices.add(len(vertices) // 3)
    mesh.vertices.foreach_set("co", vertices)
    mesh.loops.add(len(corners))
    mesh.loops.foreach_set("vertex_index", corners)
    mesh.polygons.add(faces)
    mesh.polygons.foreach_set("loop_start", array.array("i", range(0, len(corners), per_face)))
    mesh.polygons.foreach_set("loop_total", array.array("i", [per_face]) * faces)
    mesh.polygons.foreach_set("use_smooth", array.array("b", [1]) * faces)
    mesh.update(calc_edges=True)
    return mesh


def read_part():
    with open(job["mesh"], "rb") as raw:
        counts = array.array("i")
        counts.fromfile(raw, 2)
        vertices = array.array("f")
        vertices.fromfile(raw, 3 * counts[0])
        corners = array.array("i")
        corners.fromfile(raw, 3 * counts[1])
    return mesh_of("part", vertices, corners, 3)


def tunnel_walls():
    """The semicylinder in strips of 0.1 degrees or less, the slot along the top left out."""
    radius, half_length = job["radius_mm"], 0.5 * job["length_mm"]
    slot = math.asin(0.5 * job["slot_mm"] / radius)
    strips = 900
    vertices, corners = array.array("f"), array.array("i")
    for side in (-1, 1):
        first = len(vertices) // 3
        for i in range(strips + 1):
            angle = slot + (0.5 * math.pi - slot) * i / strips
            y, z = side * radius * math.sin(angle), radius * math.cos(angle)
            vertices.extend((-half_length, y, z, half_length, y, z))
        for i in range(strips):
            a = first + 2 * i
            corners.extend((a, a + 1, a + 3, a + 2))
    return mesh_of("tunnel", vertices, corners, 4)


def new_material(name):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    return material, tree, tree.nodes.new("ShaderNodeOutputMaterial")


def mirror():
    material, tree, output = new_material("mirror")
    glossy = tree.nodes.new("ShaderNodeBsdfGlossy")
    glossy.distribution = "SHARP"
    glossy.inputs["Color"].default_value = (1, 1, 1, 1)
    tree.links.new(glossy.outputs[0], output.inputs["Surface"])
    return material


def math_node(tree, operation, first, second=None):
    node = tree.nodes.new("ShaderNodeMath")
    node.operation = operation
    tree.links.new(first, node.inputs[0])
    if second is not None:
        node.inputs[1].default_value = second
    return node


def stripes():
    """The luminous wall, and one node a colour whose second input is the stripes' shift."""
    material, tree, output = new_material("stripes")
    material.cycles.sample_as_light = False
    position = tree.nodes.new("ShaderNodeSeparateXYZ")
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    tree.links.new(geometry.outputs["Position"], position.inputs[0])
    shifts, lit = [], []
    for _ in range(3 if job["is_packed"] else 1):
        shift = math_node(tree, "SUBTRACT", position.outputs["X"], 0.0)
        periods = math_node(tree, "DIVIDE", shift.outputs[0], job["period_mm"])
        phase = math_node(tree, "FRACT", periods.outputs[0])
        lit.append(math_node(tree, "LESS_THAN", phase.outputs[0], job["duty"]).outputs[0])
        shifts.append(shift.inputs[1])
    emission = tree.nodes.new("ShaderNodeEmission")
    if job["is_packed"]:
        colour = tree.nodes.new("ShaderNodeCombineColor")
        for channel, value in zip(colour.inputs, lit):
            tree.links.new(value, channel)
        tree.links.new(colour.outputs[0], emission.inputs["Color"])
    else:
        emission.inputs["Color"].default_value = (1, 1, 1, 1)
        tree.links.new(lit[0], emission.inputs["Strength"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return material, shifts


def place_camera(scene):
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit = "HORIZONTAL"
    camera.sensor_width = 36.0
    camera.lens = 36.0 * job["focal_px"] / job["width_px"]
    camera.clip_start, camera.clip_end = 1.0, 1e5
    scene.camera = new_object("camera", camera)
    scene.camera.location = job["camera_mm"]


def set_up_renderer(scene):
    """Returns the settings in words, for the table's notes."""
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = job["samples_per_pixel"]
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False  # on by default, and Debian's Blender has no OIDN
    cycles.max_bounces = 1
    cycles.glossy_bounces = 1
    cycles.diffuse_bounces = cycles.transmission_bounces = cycles.volume_bounces = 0
    cycles.blur_glossy = 0.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 1.0
    render = scene.render
    render.use_persistent_data = True
    render.threads_mode, render.threads = "FIXED", 1
    render.resolution_x, render.resolution_y = job["width_px"], job["height_px"]
    render.resolution_percentage = 100
    render.use_compositing = render.use_sequencer = False
    image = render.image_settings
    image.file_format, image.color_mode, image.color_depth = "OPEN_EXR", "RGB", "32"
    image.exr_codec = "NONE"
    render.filepath = job["image"]
    return [
        "Blender " + bpy.app.version_string + ", CPU, 1 thread, persistent data",
        "no adaptive sampling, no denoising, no clamping",
        "part: glossy BSDF, distribution SHARP, smooth shading; max_bounces 1",
        "tunnel: emission, 1800 strips, sample_as_light off; stripes move in the material",
        "pixel filter box of width 1; EXR uncompressed, written for the first frame only",
    ]


def render_frames(scene, shifts):
    times = []
    for frame in range(job["frames"]):
        start = time.process_time()
        for channel, shift in enumerate(shifts):
            shift.default_value = (frame * len(shifts) + channel) * job["step_mm"]
        bpy.ops.render.render(write_still=frame == 0)
        times.append(time.process_time() - start)
    return times


def main():
    scene = bpy.context.scene
    for unwanted in list(scene.objects):
        bpy.data.objects.remove(unwanted)
    scene.world = None
    part = new_object("part", read_part())
    part.data.materials.append(mirror())
    tunnel = new_object("tunnel", tunnel_walls())
    material, shifts = stripes()
    tunnel.data.materials.append(material)
    place_camera(scene)
    settings = set_up_renderer(scene)
    times = render_frames(scene, shifts)
    with open(job["times"], "w", encoding="utf-8") as out:
        json.dump({"frames_s": times, "settings": settings}, out)


main()
