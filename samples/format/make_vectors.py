#!/usr/bin/python3
"""Writes the test vectors of the file format, from its specification, with pyopenvdb and NumPy alone: make_vectors.py DIR

map.vdb has one step of two levels, chain.vdb two steps, points.obj points on nodes, in cells, on the ramp at the rim of a
level and far away. All numbers of the maps are sums of a few powers of two, so that a float holds them.
"""

import hashlib
import itertools
import json
import math
import struct
import sys
from pathlib import Path

import numpy as np
import pyopenvdb as vdb

CORNERS = list(itertools.product((0, 1), repeat=3))


class Level:
    """One lattice of u: `leaves` of 8³ nodes, node (i, j, k) at origin + h (i, j, k); zero where it has none."""

    def __init__(self, origin, h, leaves, value):
        self.origin, self.h, self.leaves = np.array(origin), h, sorted(leaves)
        self.values = {
            leaf: np.array([value(*(8 * np.array(leaf) + node)) for node in np.ndindex(8, 8, 8)], np.float32)
            for leaf in self.leaves
        }

    def at(self, node):
        leaf = tuple(int(n) // 8 for n in node)
        inside = [int(n) % 8 for n in node]
        number = (inside[0] * 8 + inside[1]) * 8 + inside[2]
        return self.values[leaf][number].astype(float) if leaf in self.values else np.zeros(3)

    def __call__(self, x):
        place = (np.asarray(x) - self.origin) / self.h
        low = np.floor(place)
        part = place - low
        return sum(np.prod(np.where(c, part, 1 - part)) * self.at(low + c) for c in np.array(CORNERS))


class Step:
    """E(x) = offset + linear x + the sum of the levels."""

    def __init__(self, linear, offset, levels, cells, least_determinant):
        self.linear, self.offset, self.levels = np.array(linear), np.array(offset), levels
        self.certificate = {
            "certified": cells,
            "undecided": 0,
            "folded": 0,
            "least_determinant": least_determinant,
            "affine_determinant": float(np.linalg.det(self.linear)),
            "places": [],
        }

    def __call__(self, x):
        return self.offset + self.linear @ x + sum(level(x) for level in self.levels)

    def record(self):
        levels = [{"voxel_size": level.h, "leaves": len(level.leaves)} for level in self.levels]
        pyramid = {"origin": self.levels[0].origin.tolist(), "levels": levels}
        affine = {"linear": self.linear.tolist(), "offset": self.offset.tolist()}
        return {"affine": affine, "certificate": self.certificate, "pyramid": pyramid}


ROTATION = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
TRANSLATION = np.array([8, -2, 0.5])


# ---- metadata


def mapped(steps, x):
    """Psi(1)(x)."""
    for step in steps:
        x = step(x)
    return ROTATION @ x + TRANSLATION


def record(steps):
    """Everything but the values, as one JSON object."""
    def model(letter, low, high):
        return {"hash": letter * 64, "box": {"min": low, "max": high}}

    def statistics(largest):
        return {"count": 1, "min": 0.0, "median": 0.0, "p95": 0.0, "p99": 0.0, "max": largest}

    anchor = {"name": "origin", "a": [0.0, 0.0, 0.0], "b": TRANSLATION.tolist(), "weight": 1.0}
    anchor["residual"] = float(np.linalg.norm(mapped(steps, np.zeros(3)) - TRANSLATION))
    whole = {
        "unit": "cm",
        "rigid": {"rotation": ROTATION.tolist(), "translation": TRANSLATION.tolist()},
        "rotation_path": "geodesic",
        "elastic_method": "given",
        "surface_fit_method": "given",
        "lambda": 2.0,
        "tolerance": 0.0,
        "bake_error": statistics(0.0),
        "options": {},
        "stages": [],
        "anchors": [anchor],
        "source": model("a", [-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]),
        "target": model("b", [6.0, -4.0, -1.0], [10.0, 0.0, 2.0]),
    }
    parts = [step.record() for step in steps]
    return whole | (parts[0] if len(parts) == 1 else {"steps": parts})


CONVENTIONS = (
    "column vectors; E(x) = affine_offset + affine x + u_0(x) + u_1(x) + ... with x in the source frame, each u "
    "trilinear between its nodes and 0 outside its leaves; Psi(t)(x) = R(t) ((1-t) x + t E(x)) + t T, "
    "R(1) = rotation, T = translation",
    "column vectors; E = E_K after ... after E_1, all in the source frame; the first step takes x to "
    "affine_offset + affine x + u_0(x) + u_1(x) + ..., the second likewise with s1_affine_offset, s1_affine, "
    "s1_u_0, s1_u_1, ..., and so on; each u is trilinear between its nodes and 0 outside its leaves; "
    "Psi(1)(x) = rotation E(x) + translation",
)


def metadata(whole, steps):
    """The record, and its main values again as plain entries; a reader compares the two."""
    chain = len(steps) > 1
    entries = {"format_version": 2 if chain else 1, "record": json.dumps(whole), "direction": "maps points a to b"}
    entries |= {"convention": CONVENTIONS[chain], "unit": whole["unit"], "rotation_path": whole["rotation_path"]}
    entries |= {f"rotation_row_{i}": tuple(row) for i, row in enumerate(whole["rigid"]["rotation"])}
    entries |= {"translation": tuple(whole["rigid"]["translation"])}
    entries |= {key: whole[key] for key in ("elastic_method", "surface_fit_method", "lambda", "tolerance")}
    entries |= {f"error_{name}": whole["bake_error"][name] for name in ("max", "p99")}
    for k, step in enumerate(steps):
        prefix, certificate = f"s{k}_" if k else "", step.certificate
        entries |= {f"{prefix}affine_row_{i}": tuple(row) for i, row in enumerate(step.linear.tolist())}
        entries |= {f"{prefix}affine_offset": tuple(step.offset.tolist()), f"{prefix}levels": len(step.levels)}
        entries |= {f"{prefix}cells_{name}": certificate[name] for name in ("certified", "undecided", "folded")}
        entries |= {f"{prefix}{name}": certificate[name] for name in ("least_determinant", "affine_determinant")}
    entries |= {"is_bijection": True} | ({"steps": len(steps)} if chain else {})
    for side in ("source", "target"):
        entries[f"{side}_hash"] = whole[side]["hash"]
        entries |= {f"{side}_box_{end}": tuple(whole[side]["box"][end]) for end in ("min", "max")}
    return {f"bespoke:{key}": value for key, value in entries.items()}


# ---- grids


def grid_of(kind, name, origin, h, background=0.0):
    grid = kind((background,) * 3 if kind is vdb.Vec3SGrid else background)
    grid.name, grid.transform = name, vdb.createLinearTransform(voxelSize=h)
    grid.transform.translate(tuple(map(float, origin)))
    if kind is vdb.Vec3SGrid:
        grid.vectorType = "contravariant relative"
    return grid


def level_grid(name, level):
    """All nodes of a leaf are active, those of value 0 as well."""
    grid = grid_of(vdb.Vec3SGrid, name, level.origin, level.h)
    accessor = grid.getAccessor()
    for leaf in level.leaves:
        for number, node in enumerate(np.ndindex(8, 8, 8)):
            value = tuple(map(float, level.values[leaf][number]))
            accessor.setValueOn(tuple(int(n) for n in 8 * np.array(leaf) + node), value)
    return grid


PREVIEW_ORIGIN, PREVIEW_H = np.array([-4.0, -4.0, -4.0]), 1.0


def displacement_preview(steps):
    def moved(x):
        return mapped(steps, x) - x

    preview = Level(PREVIEW_ORIGIN, PREVIEW_H, [(0, 0, 0)], lambda *node: moved(PREVIEW_ORIGIN + PREVIEW_H * np.array(node)))
    centers = [PREVIEW_ORIGIN + PREVIEW_H * (np.array(cell) + 0.5) for cell in np.ndindex(7, 7, 7)]
    errors = sorted(float(np.linalg.norm(preview(x) - moved(x))) for x in centers)
    grid = level_grid("displacement", preview)
    grid["bespoke:meaning"] = "Psi(1)(x) - x at x in the source frame: a coarse preview of the exact map in u_0, u_1, ..."
    grid["bespoke:unit"] = "cm"
    grid["bespoke:error_max"], grid["bespoke:error_p99"] = errors[-1], errors[int(0.99 * len(errors))]
    return grid


def distance_preview():
    """Of a ball of radius 1, as a level set."""
    h = 0.5
    grid = grid_of(vdb.FloatGrid, "source_distance", (-2.0, -2.0, -2.0), h, 3 * h)
    nodes = np.moveaxis(np.indices((8, 8, 8)), 0, -1)
    distance = np.round((np.linalg.norm(nodes * h - 2.0, axis=-1) - 1.0) * 64) / 64
    grid.copyFromArray(np.minimum(distance, 3 * h))
    grid.gridClass = "level set"
    grid["bespoke:meaning"] = "signed distance to the source model"
    return grid


def jacobian_preview(steps):
    """Here one number, which is below all determinants."""
    grid = grid_of(vdb.FloatGrid, "jacobian", PREVIEW_ORIGIN, PREVIEW_H)
    accessor = grid.getAccessor()
    for node in np.ndindex(8, 8, 8):
        accessor.setValueOn(node, math.prod(step.certificate["least_determinant"] for step in steps) - 1)
    return grid


def write_map(path, steps):
    grids = [displacement_preview(steps), distance_preview(), jacobian_preview(steps)]
    for k, step in enumerate(steps):
        prefix = f"s{k}_u_" if k else "u_"
        grids += [level_grid(f"{prefix}{n}", level) for n, level in enumerate(step.levels)]
    entries = metadata(record(steps), steps)
    counts = {key: value for key, value in entries.items() if type(value) is int}
    vdb.write(str(path), grids, entries | {key: value + LARGE for key, value in counts.items()})
    seal(path, counts)


# pyopenvdb stores an integer as an int32 where that suffices; the format has int64 only. So a large one is written first.
LARGE = 1 << 40


def seal(path, counts):
    """The trailer: magic, version, zero, lengths of the VDB part and of the exact map, SHA-256 of all before it."""
    content = path.read_bytes()
    for key, value in counts.items():
        # A name and a type, both with their lengths before them, and eight bytes.
        entry = struct.pack("<I", len(key)) + key.encode() + struct.pack("<I", 5) + b"int64" + struct.pack("<I", 8)
        assert content.count(entry + struct.pack("<q", value + LARGE)) == 1
        content = content.replace(entry + struct.pack("<q", value + LARGE), entry + struct.pack("<q", value))
    sealed = content + b"BESPOKE\n" + struct.pack("<IIQQ", 1, 0, len(content), 0)
    path.write_bytes(sealed + hashlib.sha256(sealed).digest())


# ---- the vectors


def coarse(i, j, k):
    """Different at neighbouring nodes, by so little that no cell folds."""
    return (i * 5 % 7 - 3) / 64, (j + 2 * k) % 5 / 128 - 1 / 64, ((i + j) * k % 9 - 4) / 128


def fine(i, j, k):
    return ((i + k) % 3 - 1) / 512, (i * j % 5 - 2) / 512, (k % 2) / 1024


def first_step():
    levels = [Level((-4, -2, -2), 0.5, [(0, 0, 0), (1, 0, 0)], coarse), Level((-4, -2, -2), 0.25, [(1, 1, 0)], fine)]
    return Step([[1.125, 0, 0], [0, 0.875, 0.0625], [0, 0, 1]], [0.25, 0, -0.125], levels, CELLS[0], LEAST[0])


def second_step():
    levels = [Level((-4, -4, -4), 1.0, [(0, 0, 0)], lambda i, j, k: tuple(2 * v for v in coarse(k, i, j)))]
    return Step([[1, 0, 0.125], [0, 1, 0], [0, 0, 1.25]], [0, 0.5, 0], levels, CELLS[1], LEAST[1])


# As `bespoke check` finds them, the determinants rounded down.
CELLS, LEAST = (2252, 729), (0.74, 1.0)

POINTS = [
    (0, 0, 0),  # a node of both levels
    (-1.5, 0.5, 1),  # a node
    (-1.375, 0.3125, 0.71875),  # in a cell of the finer level
    (1.25, -0.75, 0.125),  # in a cell of the coarser level
    (-4.25, 0.25, 0.5),  # on the ramp: half a cell before the first leaf
    (3.75, 1.75, -2.25),  # on the ramp at a corner
    (-2.125, 2.0, -0.0625),  # at the rim of the finer level
    (20, -30, 40),  # far away: affine only
    (1, 0, 0),
    (0, 1, 0),
    (0, 0, 1),
]

if __name__ == "__main__":
    directory = Path(sys.argv[1])
    directory.mkdir(parents=True, exist_ok=True)
    write_map(directory / "map.vdb", [first_step()])
    write_map(directory / "chain.vdb", [first_step(), second_step()])
    (directory / "points.obj").write_text("".join("v {} {} {}\n".format(*point) for point in POINTS))
