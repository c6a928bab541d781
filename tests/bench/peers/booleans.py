# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: blender -b -t 1 -P booleans.py -- JOB.json
#
# Subtracts tools from a part one by one with Blender's Boolean modifier and writes the CPU time of
# the modifier's evaluations and the volume that is left. Reading files is not timed. Needs no NumPy.
import array
import json
import sys
import time

import bmesh
import bpy

with open(sys.argv[sys.argv.index("--") + 1], encoding="utf-8") as file:
    job = json.load(file)


def read_mesh(raw, name):
    counts = array.array("i")
    counts.fromfile(raw, 2)
    vertices = array.array("f")
    vertices.fromfile(raw, 3 * counts[0])
    corners = array.array("i")
    corners.fromfile(raw, 3 * counts[1])
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(counts[0])
    mesh.vertices.foreach_set("co", vertices)
    mesh.loops.add(len(corners))
    mesh.loops.foreach_set("vertex_index", corners)
    mesh.polygons.add(counts[1])
    mesh.polygons.foreach_set("loop_start", array.array("i", range(0, len(corners), 3)))
    mesh.polygons.foreach_set("loop_total", array.array("i", [3]) * counts[1])
    mesh.update(calc_edges=True)
    made = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(made)
    return made


def volume_of(mesh):
    counted = bmesh.new()
    counted.from_mesh(mesh)
    volume = counted.calc_volume()
    counted.free()
    return volume


with open(job["meshes"], "rb") as raw:
    part = read_mesh(raw, "part")
    tools = [read_mesh(raw, f"tool {i}") for i in range(job["tools"])]
before = volume_of(part.data)
cpu_s = 0.0
for tool in tools:
    modifier = part.modifiers.new("cut", "BOOLEAN")
    modifier.operation = "DIFFERENCE"
    modifier.solver = job["solver"]
    modifier.object = tool
    start = time.process_time()
    graph = bpy.context.evaluated_depsgraph_get()
    graph.update()
    cut = part.evaluated_get(graph)
    mesh = bpy.data.meshes.new_from_object(cut)
    cpu_s += time.process_time() - start
    part.modifiers.remove(modifier)
    old = part.data
    part.data = mesh
    bpy.data.meshes.remove(old)
with open(job["result"], "w", encoding="utf-8") as file:
    json.dump({"cpu_s": cpu_s, "removed_mm3": before - volume_of(part.data)}, file)
