#!/usr/bin/python3
"""Flattens real garments and panels with `bespoke flatten`, and measures what comes out.

    tests/accuracy/patterns.py BESPOKE --panels --clones DIR      # GarmentCode's panels, rolled onto cylinders and cones
    tests/accuracy/patterns.py BESPOKE --garments --clones DIR    # MakeHuman's and cloth-fit's garments
    tests/accuracy/patterns.py BESPOKE --samples                  # the samples, as designed and as carried

DIR holds clones of maria-korosteleva/GarmentCode, makehumancommunity/makehuman-assets and Huangzizhou/cloth-fit. Prints a
Markdown table; --json writes the rows. Everything is measured on the JSON of the pieces: flips by the sign of the area of
every flat triangle, overlaps by what the program says, seams by the lengths of their flat sides.
"""
import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from scipy.spatial import Delaunay

import public_pairs
from public_pairs import Clone, Missing

public_pairs.DATA_SETS.update({
    "makehuman-assets": ("makehumancommunity/makehuman-assets", "garments"),
    "cloth-fit": ("Huangzizhou/cloth-fit", "garments"),
})
SPECIFICATIONS = ("dress_pencil", "hoody_mean", "js_mean_all", "shirt_mean")
SPACING = 2.0  # cm, between vertices of a panel
APART = 300.0  # cm, between panels: those at one place would be one
MAKEHUMAN = ("female_casualsuit01", "female_elegantsuit01", "female_sportsuit01", "male_casualsuit02", "male_worksuit01")
CLOTH_FIT = ("LCL_Skirt_DressEvening_003", "Puffer_dense", "jumpsuit_dense")
SAMPLES = {"dress": ("dress",), "girths": ("top", "skirt"), "glove": ("glove",), "shoe": ("upper",)}


# ---- panels

def curve_of(start, end, curvature, count):
    """Points of an edge of a panel, without its end; control points are relative to the edge."""
    along = end - start
    across = np.array([-along[1], along[0]])
    t = np.arange(count)[:, None] / count
    if curvature is None:
        return start + t * along
    if curvature["type"] == "circle":
        radius, large, grows = curvature["params"]
        half = np.linalg.norm(along) / 2
        height = np.sqrt(max(radius * radius - half * half, 0))
        centre = (start + end) / 2 + (across / (2 * half)) * height * (1 if bool(large) != bool(grows) else -1)
        first = np.arctan2(*(start - centre)[::-1])
        turn = (np.arctan2(*(end - centre)[::-1]) - first) % (2 * np.pi)
        angles = first + t[:, 0] * (turn if grows else turn - 2 * np.pi)
        return centre + radius * np.column_stack([np.cos(angles), np.sin(angles)])
    points = [start, *(start + a * along + b * across for a, b in curvature["params"]), end]
    while len(points) > 1:  # de Casteljau
        points = [(1 - t) * p + t * q for p, q in zip(points, points[1:])]
    return points[0]


def outline_of(panel):
    """Places in order, and which of them are corners of the panel."""
    vertices = np.array(panel["vertices"], float)
    points, corners = [], []
    for edge in panel["edges"]:
        start, end = vertices[edge["endpoints"]]
        count = int(np.ceil(2 * np.linalg.norm(end - start) / SPACING))
        points.append(curve_of(start, end, edge.get("curvature"), count))
        corners += [True] + [False] * (count - 1)
    points, corners = np.concatenate(points), np.array(corners)
    if area_of(points) < 0:
        points, corners = points[::-1], corners[::-1]
    return points, corners


def area_of(outline):
    x, y = outline.T
    return (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2


def inside(points, outline):
    """By the parity of crossings of a ray to the right."""
    a, b = outline, np.roll(outline, -1, 0)
    x, y = points[:, :1], points[:, 1:]
    crosses = (a[:, 1] > y) != (b[:, 1] > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return (crosses & (x < at)).sum(1) % 2 == 1


class Cylinder:
    """Panels are folded along x = k · width, into a prism of that many sides around y."""
    name = "cylinder"
    radius = 20.0  # cm, of the corners of the prism

    def __init__(self, outline):
        self.width, self.first = SPACING, outline[:, 0].min()
        self.turn = 2 * np.arcsin(self.width / 2 / self.radius)

    def coordinates(self, points):
        """In widths from line to line, and along the lines."""
        return (points[:, 0] - self.first) / self.width, points[:, 1]

    def points(self, across, along):
        return np.column_stack([self.first + self.width * across, along])

    def folded(self, points):
        across, along = self.coordinates(points)
        line = np.floor(across)
        corner = lambda k: self.radius * np.column_stack([np.sin(self.turn * k), np.cos(self.turn * k)])
        at = corner(line) + (across - line)[:, None] * (corner(line + 1) - corner(line))
        return np.column_stack([at[:, 0], along, at[:, 1]])


class Cone:
    """Panels are folded along rays from a place below them, into a pyramid of that many sides."""
    name = "cone"
    below, opening = 60.0, np.radians(30)  # cm; between axis and edges

    def __init__(self, outline):
        low, high = outline.min(0), outline.max(0)
        self.tip = np.array([(low[0] + high[0]) / 2, low[1] - self.below])
        self.width = SPACING / (high[1] - self.tip[1])
        self.first = self.angles(outline).min()
        self.turn = np.arccos((np.cos(self.width) - np.cos(self.opening)**2) / np.sin(self.opening)**2)

    def angles(self, points):
        return -np.arctan2(*(points - self.tip).T)

    def coordinates(self, points):
        return (self.angles(points) - self.first) / self.width, np.linalg.norm(points - self.tip, axis=1)

    def points(self, across, along):
        angle = self.first + self.width * across
        return self.tip + along[:, None] * np.column_stack([-np.sin(angle), np.cos(angle)])

    def folded(self, points):
        across, along = self.coordinates(points)
        line = np.floor(across)
        rest = self.width * (across - line)
        edge = lambda k: np.column_stack([np.sin(self.opening) * np.cos(self.turn * k),
                                          np.full(len(k), np.cos(self.opening)),
                                          -np.sin(self.opening) * np.sin(self.turn * k)])
        first = (along * np.sin(self.width - rest) / np.sin(self.width))[:, None]
        second = (along * np.sin(rest) / np.sin(self.width))[:, None]
        return first * edge(line) + second * edge(line + 1)


ON_LINE = 1e-9  # widths


def with_crossings(points, corners, surface):
    """The outline with a place wherever it crosses a fold, in place of others nearby that are no corners."""
    kept = []
    for k, (a, b) in enumerate(zip(points, np.roll(points, -1, 0))):
        kept.append((a, corners[k]))
        u, w = surface.coordinates(np.array([a, b]))[0]
        low, high = sorted((u, w))
        lines = [line for line in range(int(np.ceil(low + ON_LINE)), int(np.floor(high - ON_LINE)) + 1)]
        for line in lines if u < w else reversed(lines):
            kept.append((crossing(a, b, line, surface), None))
    places = np.array([place for place, _ in kept])
    crossings = places[[kind is None for _, kind in kept]]
    chosen = []
    for place, kind in kept:
        is_near = len(crossings) > 0 and np.linalg.norm(crossings - place, axis=1).min() < SPACING / 4
        if kind is False and is_near:
            continue
        chosen.append(place)
    return np.array(chosen)


def crossing(a, b, line, surface):
    """Where the straight edge from a to b crosses a fold."""
    low, high = surface.points(np.array([line, line], float), np.array([1.0, 2.0]))
    along, edge = high - low, b - a
    across = lambda v: along[0] * v[1] - along[1] * v[0]
    return a + across(low - a) / across(edge) * edge


def panel_mesh(panel, make_surface):
    """A panel as triangles that no fold crosses: places in the plane (cm), faces, the surface to fold it into, outline."""
    points, corners = outline_of(panel)
    across = make_surface(points).coordinates(points[corners])[0]
    # Of the folds that are farthest from the corners those that leave the thickest thinnest triangle.
    phases = sorted(np.linspace(0, 1, 50, endpoint=False), key=lambda shift: -np.abs((across - shift + 0.5) % 1 - 0.5).min())
    meshes = (mesh_with_folds(points, corners, make_surface(points), phase) for phase in phases[:5])
    return max(meshes, key=lambda mesh: min(area_of(mesh[0][face]) for face in mesh[1]))


def mesh_with_folds(points, corners, surface, phase):
    surface.first += surface.width * (phase - 1)
    outline = with_crossings(points, corners, surface)
    across, along = surface.coordinates(outline)
    grid = np.array([(k, v) for k in range(int(np.ceil(across.max())) + 1)
                     for v in np.arange(along.min(), along.max(), SPACING) + (k % 2) * SPACING / 2])
    inner = surface.points(*grid.T)
    distance = np.linalg.norm(inner[:, None] - outline, axis=2).min(1)
    inner = inner[inside(inner, outline) & (distance > 0.6 * SPACING)]
    places = np.concatenate([outline, inner])
    faces = Delaunay(places).simplices
    signed = np.array([area_of(places[face]) for face in faces])
    faces = np.where((signed > 0)[:, None], faces, faces[:, ::-1])
    faces = faces[inside(places[faces].mean(1), outline) & (np.abs(signed) > 1e-9)]
    return (*cut_at_folds(places, faces, surface), surface, outline)


def cut_at_folds(places, faces, surface):
    places, known = list(places), {}
    across = list(surface.coordinates(np.array(places))[0])
    done, open_faces = [], [list(face) for face in faces]
    while open_faces:
        face = open_faces.pop()
        values = [across[v] for v in face]
        line = np.floor(min(values) + ON_LINE) + 1
        if max(values) <= line + ON_LINE:
            done.append(face)
            continue
        before, behind = [], []
        for k in range(3):
            a, b = face[k], face[(k + 1) % 3]
            if across[a] <= line + ON_LINE:
                before.append(a)
            if across[a] >= line - ON_LINE:
                behind.append(a)
            if (across[a] - line) * (across[b] - line) < 0 and min(abs(across[a] - line), abs(across[b] - line)) > ON_LINE:
                key = (min(a, b), max(a, b), line)
                if key not in known:
                    known[key] = len(places)
                    places.append(crossing(places[key[0]], places[key[1]], line, surface))
                    across.append(line)
                before.append(known[key])
                behind.append(known[key])
        for part in (before, behind):
            open_faces += [[part[0], part[k], part[k + 1]] for k in range(1, len(part) - 1)]
    return np.array(places), np.array(done)


def rigidly_nearest(flat, true):
    """Distances after the best rotation and shift."""
    a, b = flat - flat.mean(0), true - true.mean(0)
    u, _, v = np.linalg.svd(a.T @ b)
    return np.linalg.norm(a @ (u @ np.diag([1, np.sign(np.linalg.det(u @ v))]) @ v) - b, axis=1)


def panel_rows(options, folder):
    clone = Clone(options.clones, "garmentcode")
    for name in SPECIFICATIONS:
        panels = json.loads(clone.read(f"assets/Patterns/{name}_specification.json"))["pattern"]["panels"]
        for make_surface in (Cylinder, Cone):
            meshes = {panel: panel_mesh(panels[panel], make_surface) for panel in panels}
            lines, first = [], 1
            for number, (panel, (places, faces, surface, _)) in enumerate(meshes.items()):
                lines.append(f"g {panel}")
                folded = surface.folded(places) + [APART * number, 0, 0]
                lines += ["v " + " ".join(f"{x:.17g}" for x in place) for place in folded]
                lines += ["f " + " ".join(str(v + first) for v in face) for face in faces]
                first += len(places)
            file = folder / f"{name}.obj"
            file.write_text("\n".join(lines) + "\n")
            row, flat = flatten(options, file, ("--unit", "cm"))
            row = {"garment": name, "as": make_surface.name, **row}
            if flat is not None:
                shape, lengths = 0.0, 0.0
                for piece in flat["pieces"]:
                    places, faces, _, outline = meshes[piece["name"]]
                    own = 10 * places[[v - start_of(meshes, piece["name"]) for v in piece["product_vertices"]]]
                    found = np.array(piece["vertices"])
                    diagonal = np.linalg.norm(own.max(0) - own.min(0))
                    shape = max(shape, rigidly_nearest(found, own).max() / diagonal)
                    edges = np.array(piece["outline"])
                    length = lambda x: np.linalg.norm(x[edges] - x[np.roll(edges, -1)], axis=1).sum()
                    lengths = max(lengths, abs(length(found) - length(own)))
                row.update(shape=shape, outline_mm=lengths)
            yield row


def start_of(meshes, name):
    """Of the panel's vertices in the file, from 0."""
    return sum(len(places) for places, *_ in list(meshes.values())[:list(meshes).index(name)])


# ---- garments

def flatten(options, file, arguments):
    """A row of figures, and what was written; or a row with the sentence of the refusal."""
    output = file.with_suffix(".pieces.json")
    begin = time.monotonic()
    run = subprocess.run([options.bespoke, "flatten", file, *arguments, "-o", output, "--quiet"], capture_output=True,
                         text=True, check=False)
    seconds = round(time.monotonic() - begin, 2)
    if run.returncode:
        lines = run.stderr.strip().splitlines() or [f"exit code {run.returncode}"]
        return {"seconds": seconds, "failure": lines[-1].replace(f"{file.parent}/", "")}, None
    flat = json.loads(output.read_text())
    flipped, strains = 0, []
    for piece in flat["pieces"]:
        places, faces = np.array(piece["vertices"]), np.array(piece["faces"])
        a, b, c = places[faces].transpose(1, 0, 2)
        flipped += int((np.cross(b - a, c - a) <= 0).sum())
        strains.append(piece["strain"]["strain_p95"])
    differences = [abs(seam["sides"][0]["length"] - seam["sides"][1]["length"] - seam["ease"]) for seam in flat["seams"]]
    return {"pieces": len(flat["pieces"]), "triangles": sum(len(piece["faces"]) for piece in flat["pieces"]),
            "flipped": flipped, "overlapping": sum(piece["overlaps_itself"] for piece in flat["pieces"]),
            "seams": len(differences), "seams_beyond_1_mm": sum(d > 1 for d in differences),
            "seams_named": sum(seam["differs"] for seam in flat["seams"]),
            "max_mm": round(max(differences, default=0), 4), "strain_p95_median": float(np.median(strains)),
            "strain_p95_max": max(strains), "pieces_beyond_2_percent": sum(s > 0.02 for s in strains),
            "darts_suggested": sum("suggested_dart" in piece for piece in flat["pieces"]), "seconds": seconds}, flat


def garment_rows(options, folder):
    sources = [("makehuman-assets", f"base/clothes/{name}/{name}.obj", "MakeHuman", "dm") for name in MAKEHUMAN]
    sources += [("cloth-fit", f"garment-data/assets/garments/{name}/garment.obj", "cloth-fit", "m") for name in CLOTH_FIT]
    for data_set, path, origin, unit in sources:
        file = folder / f"{Path(path).parent.name}.obj"
        file.write_bytes(Clone(options.clones, data_set).read(path))
        row, _ = flatten(options, file, ("--unit", unit, "--auto-cut", *options.flatten_options))
        yield {"garment": file.stem, "as": origin, **row}


def sample_rows(options, folder):
    for sample, products in SAMPLES.items():
        subprocess.run([options.bespoke, "samples", folder, sample, "--quiet"], check=True)
        models = folder / sample
        ending = "_106" if sample == "girths" else ""
        subprocess.run([options.bespoke, "fit", models / "source.obj", models / f"target{ending}.obj", "--anchors",
                        models / f"anchors{ending}.json", "-o", models / "map.vdb", "--quiet"], check=True)
        for product in products:
            carried = models / f"{product}_carried.obj"
            subprocess.run([options.bespoke, "apply", models / "map.vdb", models / f"{product}.obj", "-o", carried,
                            "--quiet"], check=True)
            for file, form in ((models / f"{product}.obj", "designed"), (carried, "carried")):
                row, _ = flatten(options, file, ("--unit", "cm", "--seams", models / f"{product}_seams.json",
                                                 *options.flatten_options))
                yield {"garment": product, "as": form, **row}


def print_panels(rows):
    yield "| panels | folded as | pieces | triangles | flipped | shape, of the diagonal | outline, mm | seconds |"
    yield "| --- | --- | --- | --- | --- | --- | --- | --- |"
    for row in rows:
        if "failure" in row:
            yield f"| {row['garment']} | {row['as']} | {row['failure']} | | | | | {row['seconds']} |"
        else:
            yield (f"| {row['garment']} | {row['as']} | {row['pieces']} | {row['triangles']} | {row['flipped']} | "
                   f"{row['shape']:.1e} | {row['outline_mm']:.1e} | {row['seconds']} |")


def print_garments(rows):
    yield ("| garment | | pieces | triangles | flipped | overlapping | seams | beyond 1 mm, named | strain p95 of "
           "pieces, %: median / most | beyond 2 %, with a dart suggested | seconds |")
    yield "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    for row in rows:
        if "failure" in row:
            yield f"| {row['garment']} | {row['as']} | {row['failure']} | | | | | | | | {row['seconds']} |"
        else:
            yield (f"| {row['garment']} | {row['as']} | {row['pieces']} | {row['triangles']} | {row['flipped']} | "
                   f"{row['overlapping']} | {row['seams']} | {row['seams_beyond_1_mm']}, {row['seams_named']} | "
                   f"{100 * row['strain_p95_median']:.2g} / {100 * row['strain_p95_max']:.2g} | "
                   f"{row['pieces_beyond_2_percent']}, {row['darts_suggested']} | {row['seconds']} |")


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bespoke", type=lambda path: Path(path).resolve(), help="the program")
    group = parser.add_mutually_exclusive_group(required=True)
    group.add_argument("--panels", action="store_true")
    group.add_argument("--garments", action="store_true")
    group.add_argument("--samples", action="store_true")
    parser.add_argument("--clones", type=Path, help="folder of the clones")
    parser.add_argument("--keep", type=Path, help="folder that files are left in")
    parser.add_argument("--json", type=Path)
    parser.add_argument("--flatten-options", nargs=argparse.REMAINDER, default=[], help="further options of `flatten`")
    options = parser.parse_args(arguments)
    if options.clones is None and not options.samples:
        parser.error("--clones is required")
    rows = []

    def remembered(found):
        for row in found:
            rows.append(row)
            yield row

    with tempfile.TemporaryDirectory() as temporary:
        folder = (options.keep or Path(temporary)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        find, show = ((panel_rows, print_panels) if options.panels else
                      (garment_rows if options.garments else sample_rows, print_garments))
        try:
            for line in show(remembered(find(options, folder))):
                print(line, flush=True)
        except Missing as error:
            print(error, file=sys.stderr)
            return 1
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
