"""Draws the paper's Figs. 1 and 3 to 10, and a penetration, from what tools/figures made. Blender runs it:

    xvfb-run -a blender -b --python samples/figures.py -- build/figures

Figs. 1 and 4 are drawn where the models stand; in the others targets are turned back into the source's position.
"""
import json
import math
import sys
from pathlib import Path

import numpy as np
from mathutils import Matrix

sys.path.insert(0, str(Path(__file__).parent))
from scene import (BODY, draw, paint, place, place_balls, read_anchors, read_obj, source_from_target, standing, start,
                   write)

HERE = Path(sys.argv[sys.argv.index("--") + 1])
SAMPLES = HERE / "samples"
ANCHOR = (0.75, 0.08, 0.05)
COLOURS = {
    "dress": (0.55, 0.07, 0.12), "top": (0.80, 0.46, 0.20), "skirt": (0.08, 0.16, 0.34), "frame": (0.05, 0.05, 0.06),
    "lenses": (0.35, 0.5, 0.55), "glove": (0.42, 0.20, 0.08), "upper": (0.05, 0.24, 0.20), "sole": (0.12, 0.09, 0.07)}
ALPHA = {"lenses": 0.4}


def product_paint(name):
    return paint(name, COLOURS[name], ALPHA.get(name, 1.0))


def carried(folder, products, back=lambda points: points):
    """(vertices, faces, material) of each product in the folder."""
    parts = []
    for name in products:
        vertices, faces = read_obj(folder / f"{name}.obj")
        parts.append((back(vertices), faces, product_paint(name)))
    return parts


class Pair:
    """A sample's source and one of its targets, the latter in the source's frame."""

    def __init__(self, sample, ending=""):
        self.sample, self.ending = sample, ending
        anchors = SAMPLES / sample / f"anchors{ending}.json"
        self.back = source_from_target(anchors)
        self.a, b = read_anchors(anchors)
        self.b = self.back(b)

    def source(self):
        return (*read_obj(SAMPLES / self.sample / "source.obj"), paint("body", BODY))

    def target(self):
        vertices, faces = read_obj(SAMPLES / self.sample / f"target{self.ending}.obj")
        return self.back(vertices), faces, paint("body", BODY)

    def on_source(self, products):
        return [self.source()] + carried(SAMPLES / self.sample, products)

    def on_target(self, products):
        return [self.target()] + carried(HERE / f"{self.sample}{self.ending}", products, self.back)


def stand(parts, x, y, scale, turn, anchors=None, ball=0.0):
    frame = standing([part[0] for part in parts], x, y, scale, turn)
    for part in parts:
        place(*part, frame)
    if anchors is not None:
        place_balls(anchors, ball, paint("anchor", ANCHOR), frame)


def row_of_views(name, pair, products, scale, turns, ball, height, step):
    """Both models with their anchors, then the product on each from two sides."""
    start(6 * step, height, 6 * step)
    base = -height / 2 + 60
    spots = [(k - 2.5) * step for k in range(6)]
    stand([pair.source()], spots[0], base, scale, turns[0], pair.a, ball)
    stand([pair.target()], spots[1], base, scale, turns[0], pair.b, ball)
    for k, turn in enumerate(turns):
        stand(pair.on_source(products), spots[2 + 2 * k], base, scale, turn)
        stand(pair.on_target(products), spots[3 + 2 * k], base, scale, turn)
    for spot, label in zip(spots, ["source, anchors", "target, anchors", "designed", "carried", "designed", "carried"]):
        write(label, spot, base - 40, 22)
    draw(HERE / f"{name}.png")


def flat_pieces(path):
    """(vertices, faces, outline) of each piece on its sheet, centimetres, and the sheet's size."""
    pieces = []
    for piece in json.loads(path.read_text())["pieces"]:
        places = (np.array(piece["vertices"]) + piece["on_sheet"]) / 10
        pieces.append((np.column_stack([places, np.zeros(len(places))]), piece["faces"], piece["outline"]))
    everywhere = np.concatenate([piece[0] for piece in pieces])
    return pieces, everywhere.min(0), everywhere.max(0)


def ribbon(points, width):
    """A closed line in the plane as quadrilaterals in front of it."""
    along = np.roll(points, -1, 0) - np.roll(points, 1, 0)
    across = np.column_stack([-along[:, 1], along[:, 0], 0 * along[:, 0]])
    across *= width / 2 / np.linalg.norm(across, axis=1)[:, None]
    count, lift = len(points), np.array([0, 0, 0.5])
    return (np.concatenate([points - across, points + across]) + lift,
            [(k, (k + 1) % count, (k + 1) % count + count, k + count) for k in range(count)])


def sheet(path, x, y, scale, material, line):
    """The pieces of a pattern, their lower left corner at x and y."""
    pieces, low, _ = flat_pieces(path)
    frame = (Matrix.Translation((x, 0, y)) @ Matrix.Scale(scale, 4) @ Matrix.Rotation(math.pi / 2, 4, "X")
             @ Matrix.Translation((-low[0], -low[1], 0)))
    for vertices, faces, outline in pieces:
        place(vertices, faces, material, frame)
        place(*ribbon(vertices[outline], 1.2 / scale), line, frame)


def from_model_to_pieces(name, pair, product):
    """Fig. 3: both models with their anchors, the product on each, and the pieces of both."""
    width, height, row_height = 1700, 1250, 700
    start(width, height, width)
    base, step = height / 2 - row_height + 50, width / 4
    spots = [(k - 1.5) * step for k in range(4)]
    stand([pair.source()], spots[0], base, 3.2, -25, pair.a, 1.6)
    stand([pair.target()], spots[1], base, 3.2, -25, pair.b, 1.6)
    stand(pair.on_source((product,)), spots[2], base, 3.2, -25)
    stand(pair.on_target((product,)), spots[3], base, 3.2, -25)
    for spot, label in zip(spots, ["source, anchors", "target, anchors", "the garment M", "carried: M_new"]):
        write(label, spot, base - 40, 22)
    files = [HERE / pair.sample / "pieces.json", HERE / pair.sample / "pieces_carried.json"]
    sizes = np.array([high - low for _, low, high in map(flat_pieces, files)])[:, :2]
    space = np.array([width / 2 - 80, height - row_height - 110])
    scale = (space / sizes.max(0)).min()
    line = paint("line", (0.16, 0.17, 0.19))
    for k, (file, label) in enumerate(zip(files, ["pieces of M", "pieces of M_new"])):
        middle = (k - 0.5) * width / 2
        sheet(file, middle - scale * sizes[k][0] / 2, 70 - height / 2, scale, product_paint(product), line)
        write(label, middle, 25 - height / 2, 22)
    draw(HERE / f"{name}.png")


def penetration(name, pair):
    """A tight suit as designed, as carried, and kept clear: where it is inside of the body, the skin shows."""
    width, height, scale = 1700, 660, 3.0
    start(width, height, width)
    suit = paint("suit", (0.08, 0.16, 0.34))
    found = json.loads((HERE / "suit" / "kept.json").read_text())["products"][0]["clearance"]
    rows = [("designed", [pair.source(), (*read_obj(HERE / "suit" / "suit.obj"), suit)])]
    for which, label, key in (("carried", "carried", "missed_before"), ("kept", "--clearance keep", "missed_after")):
        vertices, faces = read_obj(HERE / "suit" / which / "suit.obj")
        places = f"{found[key]['inside']} of {found['samples']} places inside"
        rows.append((f"{label}: {places}", [pair.target(), (pair.back(vertices), faces, suit)]))
    for k, (label, parts) in enumerate(rows):
        x = (k - 1) * width / 3
        stand(parts, x - 130, 60 - height / 2, scale, -25)
        stand(parts, x + 130, 60 - height / 2, scale, 155)
        write(label, x, 22 - height / 2, 20)
    draw(HERE / f"{name}.png")


def trail(name, rows):
    """One row per order of the motion, (label, folder): body and dress from the source to the turned target."""
    width, row_height, scale = 1700, 430, 1.9
    height = row_height * len(rows)
    start(width, height, width)
    for row, (label, folder) in enumerate(rows):
        top = height / 2 - row_height * row
        frame = (Matrix.Translation((130 - width / 2, 0, top - row_height + 20)) @ Matrix.Scale(scale, 4)
                 @ Matrix.Rotation(math.pi / 2, 4, "X"))
        for k in range(5):
            for part in ("source", "dress"):
                vertices, faces = read_obj(HERE / "turned" / folder / f"{part}_{k:03d}.obj")
                place(vertices, faces, paint("body", BODY) if part == "source" else product_paint("dress"), frame)
        write(label, 30 - width / 2, top - 40, 26, "LEFT")
    draw(HERE / f"{name}.png")


def series(name):
    """The grades from 88 to 112 cm, from the front and from the back."""
    products = ("top", "skirt")
    width, height, scale = 1700, 1300, 3.2
    start(width, height, width)
    pairs = [Pair("girths", f"_{girth}") for girth in (94, 100, 106, 112)]
    models = [pairs[0].on_source(products)] + [pair.on_target(products) for pair in pairs]
    labels = ["source, hips 88 cm", "94 cm", "100 cm", "106 cm", "112 cm"]
    for k, (model, label) in enumerate(zip(models, labels)):
        x = (k - 2) * width / 5
        stand(model, x, 40, scale, -25)
        stand(model, x, 70 - height / 2, scale, 155)
        write(label, x, 25 - height / 2, 26)
    draw(HERE / f"{name}.png")


def space(name, panels):
    """The same plane of space, carried by maps that differ in the anchors off the surface."""
    width, height, scale = 1700, 620, 10.2
    start(width, height, width)
    step = width / len(panels)
    for k, (label, folder) in enumerate(panels):
        frame = (Matrix.Translation(((k - (len(panels) - 1) / 2) * step, 0, 20)) @ Matrix.Scale(scale, 4)
                 @ Matrix.Rotation(math.pi / 2, 4, "X"))
        anchors = HERE / "space" / f"anchors_{folder}.json" if folder != "source" else HERE / "space" / "anchors_pulled.json"
        a, b = read_anchors(anchors)
        back = source_from_target(SAMPLES / "glasses" / "anchors.json")
        if folder == "source":
            model, grid, dots = SAMPLES / "glasses" / "source.obj", HERE / "space" / "grid.obj", a
            back = lambda points: points
        else:
            model, grid = SAMPLES / "glasses" / "target.obj", HERE / "space" / folder / "grid.obj"
            dots = back(b)
        vertices, faces = read_obj(model)
        place(back(vertices), faces, paint("body", BODY, 0.5), frame)
        vertices, faces = read_obj(grid)
        place(back(vertices), faces, paint("grid", (0.10, 0.22, 0.42)), frame)
        place_balls(dots, 0.45, paint("anchor", ANCHOR), frame)
        write(label, (k - (len(panels) - 1) / 2) * step, 25 - height / 2, 22)
    draw(HERE / f"{name}.png")


def main():
    trail("fig01", [("linear blending, (1-t) x + t Psi(1)(x)", "linear"),
                    ("rigid and elastic part apart, Eq. 1", "elastic-first")])
    trail("fig04", [("elastic part first, Eq. 1", "elastic-first"), ("rigid part first, elastic change read at x", "rigid-first"),
                    ("rigid part first, E at the moving point, Eq. 19", "moving-point")])
    space("fig05", [("a plane of space around the source", "source"), ("anchors on the surfaces", "surface"),
                    ("and the corners of the boxes", "corners"), ("and four pulled outwards", "pulled")])
    from_model_to_pieces("fig03", Pair("dress"), "dress")
    penetration("clearance", Pair("dress"))
    row_of_views("fig06a", Pair("dress"), ("dress",), 3.2, (-25, 155), 1.6, 700, 340)
    row_of_views("fig06b", Pair("girths", "_106"), ("top", "skirt"), 3.2, (-25, 155), 1.6, 700, 340)
    series("fig07")
    row_of_views("fig08", Pair("glasses"), ("frame", "lenses"), 12.5, (-10, -65), 0.35, 560, 330)
    row_of_views("fig09", Pair("glove"), ("glove",), 17.0, (150, -30), 0.3, 600, 330)
    row_of_views("fig10", Pair("shoe"), ("upper", "sole"), 14.0, (-62, 118), 0.3, 480, 380)


if __name__ == "__main__":
    main()
