#!/usr/bin/env python3
"""Carries an OBJ across a map with pyopenvdb and NumPy alone: a reader of the file format in less than sixty lines.

    /usr/bin/python3 samples/viewers/read_asset.py map.vdb product.obj carried.obj
"""

import json
import sys

import numpy as np
import pyopenvdb as vdb


class Level:
    """A lattice of displacements, trilinear between its nodes and zero where it has none."""

    def __init__(self, grid, origin, voxel_size):
        self.origin, self.voxel_size = np.array(origin), voxel_size
        self.values = {item.min: np.array(item.value) for item in grid.iterOnValues()}

    def __call__(self, x):
        place = (x - self.origin) / self.voxel_size
        low = np.floor(place).astype(int)
        share = place - low
        corners = ((np.array(c), np.prod(np.where(c, share, 1 - share))) for c in np.ndindex(2, 2, 2))
        return sum(weight * self.values.get(tuple((low + corner).tolist()), 0) for corner, weight in corners)


def read_map(path):
    """x ↦ Ψ(1)(x): every step adds its levels to its affine part, the rigid part comes last."""
    record = json.loads(vdb.readMetadata(path)["bespoke:record"])
    steps = []
    for k, step in enumerate(record.get("steps", [record])):
        prefix, pyramid = f"s{k}_u_" if k else "u_", step["pyramid"]
        grids = [vdb.read(path, prefix + str(n)) for n in range(len(pyramid["levels"]))]
        levels = [Level(g, pyramid["origin"], level["voxel_size"]) for g, level in zip(grids, pyramid["levels"])]
        steps.append((np.array(step["affine"]["linear"]), np.array(step["affine"]["offset"]), levels))
    rotation, translation = np.array(record["rigid"]["rotation"]), np.array(record["rigid"]["translation"])

    def carry(x):
        for linear, offset, levels in steps:
            x = offset + linear @ x + sum(level(x) for level in levels)
        return rotation @ x + translation

    return carry


if __name__ == "__main__":
    asset, product, output = sys.argv[1:]
    carry = read_map(asset)
    with open(product) as lines, open(output, "w") as out:
        for line in lines:
            if line.startswith("v "):
                line = "v {:.9g} {:.9g} {:.9g}\n".format(*carry(np.array(line.split()[1:4], float)))
            out.write(line)
