"""Draws the frames of a motion in a row: a model and a product, each turned back onto the first by its rigid motion.

    bespoke apply MAP.vdb MODEL.obj PRODUCT.obj --frames 4 --out-dir FOLDER
    xvfb-run -a blender -b --python samples/render_frames.py -- FOLDER MODEL PRODUCT PICTURE.png [TURN]

MODEL and PRODUCT are the files' names without ending; y points up; TURN is in degrees.
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from scene import BODY, draw, paint, place, read_obj, standing, start, write

arguments = sys.argv[sys.argv.index("--") + 1:]
FOLDER, MODEL, PRODUCT, PICTURE = Path(arguments[0]), arguments[1], arguments[2], Path(arguments[3])
TURN = float(arguments[4]) if len(arguments) > 4 else -20
WIDTH, HEIGHT, TALL, GROUND = 1600, 430, 350, -165


def back(points, first):
    """Rotation and translation that bring points nearest to `first`, as a function of points."""
    u, _, vt = np.linalg.svd((points - points.mean(0)).T @ (first - first.mean(0)))
    rotation = u @ np.diag([1, 1, np.sign(np.linalg.det(u @ vt))]) @ vt
    return lambda other: (other - points.mean(0)) @ rotation + first.mean(0)


frames = sorted(FOLDER.glob(f"{MODEL}_*.obj"))
first = read_obj(frames[0])[0]
scale = TALL / np.ptp(first[:, 1])
start(WIDTH, HEIGHT, WIDTH)
body, cloth = paint("body", BODY), paint("cloth", (0.10, 0.20, 0.38))
for k, path in enumerate(frames):
    vertices, faces = read_obj(path)
    upright = back(vertices, first)
    parts = [(upright(vertices), faces, body)]
    dressed, dress_faces = read_obj(FOLDER / path.name.replace(MODEL, PRODUCT, 1))
    parts.append((upright(dressed), dress_faces, cloth))
    spot = (k - (len(frames) - 1) / 2) * WIDTH / len(frames)
    frame = standing([part[0] for part in parts], spot, GROUND, scale, TURN)
    for part in parts:
        place(*part, frame)
    write(f"t = {k / (len(frames) - 1):g}", spot, GROUND - 40, 18)
draw(PICTURE)
