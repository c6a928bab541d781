# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: blender -b -t 1 -P cycles_gear.py -- JOB.json
#
# Renders the gear under a ring light in Cycles, once for each entry of the job's `pictures`
# (samples, seed, file), and writes the CPU time of each. The first picture of all, of one sample,
# carries what Cycles does once: it reads the scene and builds its BVH.
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


def ring():
    """A flat ring that shines downwards, in 128 quads; its area is that of the round one."""
    quads = 128
    half = math.pi / quads
    keep_area = math.sqrt(half / (math.sin(half) * math.cos(half)))
    vertices, corners = array.array("f"), array.array("i")
    for i in range(quads):
        angle = 2.0 * half * i
        for radius in (job["ring_inner_mm"], job["ring_outer_mm"]):
            radius *= keep_area
            vertices.extend((radius * math.cos(angle), radius * math.sin(angle), 0.0))
        a, b = 2 * i, 2 * ((i + 1) % quads)
        corners.extend((a, b, b + 1, a + 1))
    return mesh_of("ring", vertices, corners, 4, False)


def luminous():
    material, tree, output = new_material("luminous")
    emission = tree.nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value = (1, 1, 1, 1)
    emission.inputs["Strength"].default_value = job["radiance"]
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return material


def metal():
    """Wide across circles around the gear's axis when the anisotropy is > 0, as Glint's."""
    material, tree, output = new_material("metal")
    tangent = tree.nodes.new("ShaderNodeTangent")
    tangent.direction_type, tangent.axis = "RADIAL", "Z"
    shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
    shader.distribution = "GGX"
    shader.inputs["Base Color"].default_value = (*job["colour"], 1)
    shader.inputs["Metallic"].default_value = 1.0
    shader.inputs["Roughness"].default_value = job["roughness"]
    shader.inputs["Anisotropic"].default_value = job["anisotropy"]
    tree.links.new(tangent.outputs[0], shader.inputs["Tangent"])
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def build():
    scene = empty_scene()
    gear = new_object("gear", read_mesh("gear", job["mesh"], False))
    gear.rotation_euler = (job["tilt_rad"], 0, 0)
    gear.data.materials.append(metal())
    light = new_object("ring", ring())
    light.location = (0, 0, job["distance_mm"] - job["ring_ahead_mm"])
    light.data.materials.append(luminous())
    place_camera(scene, job["focal_px"], job["width_px"], (0, 0, job["distance_mm"]))
    set_up_cycles(scene, job["width_px"], job["height_px"], job["bounces"])
    return scene


def render(scene, samples, seed, path):
    """CPU seconds of the rendering; writing the file does not count."""
    scene.cycles.samples, scene.cycles.seed = samples, seed
    scene.update_tag()  # else persistent data keeps the samples of the picture before
    bpy.context.view_layer.update()
    start = time.process_time()
    bpy.ops.render.render(write_still=False)
    used = time.process_time() - start
    bpy.data.images["Render Result"].save_render(path)
    return used


def main():
    scene = build()
    first = render(scene, 1, 0, job["pictures"][0]["file"])
    times = [render(scene, p["samples"], p["seed"], p["file"]) for p in job["pictures"]]
    settings = [
        "Blender " + bpy.app.version_string + ", CPU, 1 thread, persistent data, BVH: "
        + scene.cycles.debug_bvh_layout,
        "no adaptive sampling, no denoising, no clamping; pattern "
        + scene.cycles.sampling_pattern,
        "gear: Principled BSDF, metallic 1, GGX, radial tangent about z; flat shading; max_bounces "
        + str(job["bounces"]),
        "ring: mesh emitter of 128 quads; pixel filter box of width 1",
    ]
    with open(job["times"], "w", encoding="utf-8") as out:
        json.dump({"first_s": first, "pictures_s": times, "settings": settings}, out)


main()
