"""What samples/render.py and samples/figures.py share: meshes, paint, text and light for Blender's workbench renderer."""
import json
import math

import bpy
import numpy as np
from mathutils import Matrix

BODY = (0.80, 0.74, 0.68)
INK = (0.16, 0.17, 0.19)


def read_obj(path):
    vertices, faces = [], []
    for line in path.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            faces.append([int(word.split("/")[0]) - 1 for word in words[1:]])
    return np.array(vertices), faces


def read_anchors(path):
    """Two arrays, n×3: the points on the source and those on the target."""
    pairs = json.loads(path.read_text())["pairs"]
    return np.array([pair["a"] for pair in pairs]), np.array([pair["b"] for pair in pairs])


def source_from_target(anchors_path):
    """Least-squares rotation and translation of the anchors, as a function of points."""
    a, b = read_anchors(anchors_path)
    u, _, vt = np.linalg.svd((b - b.mean(0)).T @ (a - a.mean(0)))
    flip = np.diag([1, 1, np.sign(np.linalg.det(u @ vt))])
    rotation = u @ flip @ vt
    return lambda points: (points - b.mean(0)) @ rotation + a.mean(0)


def paint(name, colour, alpha=1.0):
    material = bpy.data.materials.new(name)
    material.diffuse_color = (*colour, alpha)
    material.roughness = 0.6
    return material


def place(vertices, faces, material, frame):
    mesh = bpy.data.meshes.new(material.name)
    mesh.from_pydata(vertices.tolist(), [], faces)
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.materials.append(material)
    thing = bpy.data.objects.new(material.name, mesh)
    thing.matrix_world = frame
    bpy.context.scene.collection.objects.link(thing)


def place_balls(points, radius, material, frame):
    """One ball at each point (n×3)."""
    rings, sides = 8, 12
    polar = np.linspace(0, math.pi, rings + 1)
    around = 2 * math.pi * np.arange(sides) / sides
    ball = np.array([(math.sin(p) * math.cos(a), math.cos(p), math.sin(p) * math.sin(a)) for p in polar for a in around])
    quads = [(r * sides + s, r * sides + (s + 1) % sides, (r + 1) * sides + (s + 1) % sides, (r + 1) * sides + s)
             for r in range(rings) for s in range(sides)]
    for point in points:
        place(point + radius * ball, quads, material, frame)


def write(text, x, y, size, align="CENTER"):
    font = bpy.data.curves.new(text, "FONT")
    font.body = text
    font.size = size
    font.align_x = align
    font.materials.append(paint("ink", INK))
    thing = bpy.data.objects.new(text, font)
    thing.location = (x, -200, y)
    thing.rotation_euler = (math.pi / 2, 0, 0)
    bpy.context.scene.collection.objects.link(thing)


def standing(shapes, x, y, scale, turn):
    """Frame that puts shapes (n×3, y up) on height y, the middle of the first at x, turned by degrees."""
    middle = (shapes[0].min(0) + shapes[0].max(0)) / 2
    lowest = min(shape[:, 1].min() for shape in shapes)
    return (Matrix.Translation((x, 0, y)) @ Matrix.Scale(scale, 4) @ Matrix.Rotation(math.radians(turn), 4, "Z")
            @ Matrix.Rotation(math.pi / 2, 4, "X") @ Matrix.Translation((-middle[0], -lowest, -middle[2])))


def start(width, height, span):
    """An empty scene of a picture of width×height pixels, seen along +y; its longer edge is `span` long."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "BLENDER_WORKBENCH"
    scene.display.render_aa = "16"
    shading = scene.display.shading
    shading.light = "STUDIO"
    shading.studio_light = "paint.sl"
    shading.color_type = "MATERIAL"
    shading.show_cavity = True
    shading.cavity_type = "WORLD"
    shading.cavity_ridge_factor = 0.3
    shading.cavity_valley_factor = 0.9
    shading.show_specular_highlight = True
    scene.view_settings.view_transform = "Standard"
    world = bpy.data.worlds.new("paper")
    world.color = (0.93, 0.93, 0.92)
    scene.world = world
    camera = bpy.data.cameras.new("camera")
    camera.type = "ORTHO"
    camera.ortho_scale = span
    camera.clip_end = 5000
    eye = bpy.data.objects.new("camera", camera)
    eye.location = (0, -2000, 0)
    eye.rotation_euler = (math.pi / 2, 0, 0)
    scene.collection.objects.link(eye)
    scene.camera = eye
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.dither_intensity = 0
    scene.render.image_settings.color_mode = "RGB"


def draw(path):
    bpy.context.scene.render.filepath = str(path.resolve())
    bpy.ops.render.render(write_still=True)
