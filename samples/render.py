"""Draws samples/picture.png from what tools/demo made: each product on its source and, carried, on its targets.

    tools/demo
    xvfb-run -a blender -b --python samples/render.py -- build/demo samples/picture.png

Needs Blender 3.4 or later; nothing in the build does. Targets are drawn turned back into the source's position.
"""
import json
import math
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

DEMO, PICTURE = (Path(argument) for argument in sys.argv[sys.argv.index("--") + 1:])
WIDTH, HEIGHT = 1600, 800
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


def source_from_target(anchors_path):
    """Least-squares rotation and translation of the anchors, as a function of points."""
    pairs = json.loads(anchors_path.read_text())["pairs"]
    a = np.array([pair["a"] for pair in pairs])
    b = np.array([pair["b"] for pair in pairs])
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


def write(text, x, y, size):
    font = bpy.data.curves.new(text, "FONT")
    font.body = text
    font.size = size
    font.align_x = "CENTER"
    font.materials.append(paint("ink", INK))
    thing = bpy.data.objects.new(text, font)
    thing.location = (x, -200, y)
    thing.rotation_euler = (math.pi / 2, 0, 0)
    bpy.context.scene.collection.objects.link(thing)


def figure(x, y, scale, turn, parts):
    """Parts (vertices, faces, material) of one model, standing on height y about x, turned by degrees."""
    everything = parts[0][0]
    middle = (everything.min(0) + everything.max(0)) / 2
    lowest = min(part[0][:, 1].min() for part in parts)
    frame = (Matrix.Translation((x, 0, y)) @ Matrix.Scale(scale, 4) @ Matrix.Rotation(math.radians(turn), 4, "Z")
             @ Matrix.Rotation(math.pi / 2, 4, "X") @ Matrix.Translation((-middle[0], -lowest, -middle[2])))
    for part in parts:
        place(*part, frame)


def sample(name, products, spots, scale, y, turn, targets=("",), labels=("source", "target")):
    """`products`: name to material. The source at the first spot, then the targets."""
    folder = DEMO / "samples" / name
    body = paint("body", BODY)
    model = [(*read_obj(folder / "source.obj"), body)]
    model += [(*read_obj(folder / f"{product}.obj"), material) for product, material in products.items()]
    figure(spots[0], y, scale, turn, model)
    for spot, target in zip(spots[1:], targets):
        ending = f"_{target}" if target else ""
        back = source_from_target(folder / f"anchors{ending}.json")
        model = [(*read_obj(folder / f"target{ending}.obj"), body)]
        model += [(*read_obj(DEMO / f"{name}{ending}" / f"{product}.obj"), material)
                  for product, material in products.items()]
        figure(spot, y, scale, turn, [(back(vertices), faces, material) for vertices, faces, material in model])
    for spot, label in zip(spots, labels):
        write(label, spot, y - 13, 9)


def look():
    scene = bpy.context.scene
    scene.render.engine = "BLENDER_WORKBENCH"
    scene.display.render_aa = "32"
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
    camera.ortho_scale = 900
    camera.clip_end = 3000
    eye = bpy.data.objects.new("camera", camera)
    eye.location = (0, -1000, 0)
    eye.rotation_euler = (math.pi / 2, 0, 0)
    scene.collection.objects.link(eye)
    scene.camera = eye
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.render.dither_intensity = 0
    scene.render.image_settings.color_mode = "RGB"
    scene.render.image_settings.compression = 100
    scene.render.filepath = str(PICTURE.resolve())


def save_small(path, shades=52):
    """Fewer shades of each colour compress to a fraction and look the same."""
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Non-Color"
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    image.pixels.foreach_set(np.round(pixels * (shades - 1)) / (shades - 1))
    image.file_format = "PNG"
    image.save()


bpy.ops.wm.read_factory_settings(use_empty=True)
look()
sample("dress", {"dress": paint("dress", (0.55, 0.07, 0.12))}, (-386, -262), 1.26, -4, -25)
sample("girths", {"top": paint("top", (0.80, 0.46, 0.20)), "skirt": paint("skirt", (0.08, 0.16, 0.34))},
       (-116, 6, 128, 252, 378), 1.26, -4, -25, ("94", "100", "106", "112"),
       ("source, hips 88 cm", "94 cm", "100 cm", "106 cm", "112 cm"))
sample("glasses", {"frame": paint("frame", (0.05, 0.05, 0.06)), "lenses": paint("lenses", (0.35, 0.5, 0.55), 0.4)},
       (-376, -248), 4.8, -200, -35)
sample("glove", {"glove": paint("glove", (0.42, 0.20, 0.08))}, (-96, 16), 5.6, -200, 150)
sample("shoe", {"upper": paint("upper", (0.05, 0.24, 0.20)), "sole": paint("sole", (0.12, 0.09, 0.07))},
       (190, 352), 5.8, -200, -62)
bpy.ops.render.render(write_still=True)
save_small(PICTURE.resolve())
