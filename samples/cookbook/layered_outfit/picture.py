"""Draws picture.png from what the recipe made: the outfit on the body that it was designed around, and on the
customer as carried and as kept clear, faces the darker the more they were moved.

    xvfb-run -a blender -b --python samples/cookbook/layered_outfit/picture.py -- models/girths carried fitted picture.png
"""
import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))
from scene import BODY, draw, paint, place, read_obj, source_from_target, standing, start, write

MODELS, CARRIED, FITTED, PICTURE = (Path(argument) for argument in sys.argv[sys.argv.index("--") + 1:])
COLOURS = {"skirt": (0.12, 0.22, 0.45), "top": (0.75, 0.72, 0.66)}
FEET = -80  # where they stand in the picture
MOVED = [(0.95, 0.75, 0.3), (0.9, 0.5, 0.15), (0.75, 0.2, 0.08)]  # from a tenth, a third, two thirds of the largest move


def shades(name, before, after, faces):
    """The faces of one product as (vertices, faces, material), a material for each band of moves."""
    moves = np.linalg.norm(after - before, axis=1)
    largest = max(moves.max(), 1e-9)
    amounts = [moves[list(face)].mean() / largest for face in faces]
    bands = np.digitize(amounts, [0.1, 1 / 3, 2 / 3])
    for band, colour in enumerate([COLOURS[name], *MOVED]):
        chosen = [face for face, its in zip(faces, bands) if its == band]
        if chosen:
            yield after, chosen, paint(f"{name}{band}", colour)


def figure(x, parts, label):
    frame = standing([part[0] for part in parts], x, FEET, 1, -25)
    for part in parts:
        place(*part, frame)
    write(label, x, FEET - 12, 8)


start(1200, 800, 310)
bpy.context.scene.display.render_aa = "32"
body = paint("body", BODY)
source = [(*read_obj(MODELS / "source.obj"), body)]
source += [(*read_obj(MODELS / f"{name}.obj"), paint(name, colour)) for name, colour in COLOURS.items()]
figure(-100, source, "designed")
back = source_from_target(MODELS / "anchors_112.json")
customer, faces = read_obj(MODELS / "target_112.obj")
for x, folder, label in ((0, CARRIED, "carried"), (100, FITTED, "kept clear")):
    parts = [(back(customer), faces, body)]
    for name in COLOURS:
        before, outline = read_obj(CARRIED / f"{name}.obj")
        after, _ = read_obj(folder / f"{name}.obj")
        parts += list(shades(name, back(before), back(after), outline))
    figure(x, parts, label)
bpy.context.scene.render.image_settings.compression = 100
draw(PICTURE)
