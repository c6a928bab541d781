# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: blender -b -t 1 -P cycles.py -- JOB.json
#
# Renders the first frames of a fringe tunnel's scan in Cycles and writes the CPU time of each. The
# stripes move in the tunnel's material, so that no geometry changes between frames.
import array
import json
import math
import os
import sys
import time

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from blender_scene import (
    empty_scene,
    mesh_of,
    new_material,
    new_object,
    place_camera,
    read_mesh,
    set_up_cycles,
)

with open(sys.argv[sys.argv.index("--") + 1], encoding="utf-8") as file:
    job = json.load(file)


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


def set_up_renderer(scene):
    """Returns the settings in words, for the table's notes."""
    set_up_cycles(scene, job["width_px"], job["height_px"], 1)
    scene.cycles.samples = job["samples_per_pixel"]
    scene.render.filepath = job["image"]
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
    scene = empty_scene()
    part = new_object("part", read_mesh("part", job["mesh"]))
    part.data.materials.append(mirror())
    tunnel = new_object("tunnel", tunnel_walls())
    material, shifts = stripes()
    tunnel.data.materials.append(material)
    place_camera(scene, job["focal_px"], job["width_px"], job["camera_mm"])
    settings = set_up_renderer(scene)
    times = render_frames(scene, shifts)
    with open(job["times"], "w", encoding="utf-8") as out:
        json.dump({"frames_s": times, "settings": settings}, out)


main()
