# SPDX-License-Identifier: GPL-3.0-or-later
#
# What the scripts that render in Cycles share. One Blender unit is 1 mm. Needs no NumPy: Debian's
# Blender only recommends it.
import array

import bpy


def empty_scene():
    scene = bpy.context.scene
    for unwanted in list(scene.objects):
        bpy.data.objects.remove(unwanted)
    scene.world = None
    return scene


def new_object(name, data):
    made = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(made)
    return made


def mesh_of(name, vertices, corners, per_face, is_smooth=True):
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
    mesh.polygons.foreach_set("use_smooth", array.array("b", [1 if is_smooth else 0]) * faces)
    mesh.update(calc_edges=True)
    return mesh


def read_mesh(name, path, is_smooth=True):
    """The first mesh of a raw file: numbers of vertices and triangles, vertices, triangles."""
    with open(path, "rb") as raw:
        counts = array.array("i")
        counts.fromfile(raw, 2)
        vertices = array.array("f")
        vertices.fromfile(raw, 3 * counts[0])
        corners = array.array("i")
        corners.fromfile(raw, 3 * counts[1])
    return mesh_of(name, vertices, corners, 3, is_smooth)


def new_material(name):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    return material, tree, tree.nodes.new("ShaderNodeOutputMaterial")


def place_camera(scene, focal_px, width_px, place_mm):
    """Looks along -z, y upwards."""
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit = "HORIZONTAL"
    camera.sensor_width = 36.0
    camera.lens = 36.0 * focal_px / width_px
    camera.clip_start, camera.clip_end = 1.0, 1e5
    scene.camera = new_object("camera", camera)
    scene.camera.location = place_mm


def set_up_cycles(scene, width_px, height_px, bounces):
    """CPU, one thread, nothing that trades errors of another kind for noise."""
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False  # on by default, and Debian's Blender has no OIDN
    cycles.max_bounces = cycles.glossy_bounces = bounces
    cycles.diffuse_bounces = cycles.transmission_bounces = cycles.volume_bounces = 0
    cycles.blur_glossy = 0.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 1.0
    render = scene.render
    render.use_persistent_data = True
    render.threads_mode, render.threads = "FIXED", 1
    render.resolution_x, render.resolution_y = width_px, height_px
    render.resolution_percentage = 100
    render.use_compositing = render.use_sequencer = False
    image = render.image_settings
    image.file_format, image.color_mode, image.color_depth = "OPEN_EXR", "RGB", "32"
    image.exr_codec = "NONE"
