"""Draws samples/picture.png from what tools/demo made: each product on its source and, carried, on its targets.

    tools/demo
    tools/setup --figures
    xvfb-run -a blender -b --python samples/render.py -- build/demo samples/picture.png

Needs Blender 3.4 or later; nothing in the build does. Targets are drawn turned back into the source's position.
"""
import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from scene import BODY, draw, paint, place, read_obj, source_from_target, standing, start, write

DEMO, PICTURE = (Path(argument) for argument in sys.argv[sys.argv.index("--") + 1:])


def figure(x, y, scale, turn, parts):
    """Parts (vertices, faces, material) of one model."""
    frame = standing([part[0] for part in parts], x, y, scale, turn)
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


def save_small(path, shades=52):
    """Fewer shades of each colour compress to a fraction and look the same."""
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Non-Color"
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    image.pixels.foreach_set(np.round(pixels * (shades - 1)) / (shades - 1))
    image.file_format = "PNG"
    image.save()


start(1600, 800, 900)
bpy.context.scene.display.render_aa = "32"
bpy.context.scene.render.image_settings.compression = 100
sample("dress", {"dress": paint("dress", (0.55, 0.07, 0.12))}, (-386, -262), 1.26, -4, -25)
sample("girths", {"top": paint("top", (0.80, 0.46, 0.20)), "skirt": paint("skirt", (0.08, 0.16, 0.34))},
       (-116, 6, 128, 252, 378), 1.26, -4, -25, ("94", "100", "106", "112"),
       ("source, hips 88 cm", "94 cm", "100 cm", "106 cm", "112 cm"))
sample("glasses", {"frame": paint("frame", (0.05, 0.05, 0.06)), "lenses": paint("lenses", (0.35, 0.5, 0.55), 0.4)},
       (-376, -248), 4.8, -200, -35)
sample("glove", {"glove": paint("glove", (0.42, 0.20, 0.08))}, (-96, 16), 5.6, -200, 150)
sample("shoe", {"upper": paint("upper", (0.05, 0.24, 0.20)), "sole": paint("sole", (0.12, 0.09, 0.07))},
       (190, 352), 5.8, -200, -62)
draw(PICTURE)
save_small(PICTURE.resolve())
