"""Carries an OBJ across a map with pyopenvdb and NumPy alone: a reader of the file format in sixty lines.

    /usr/bin/python3 samples/viewers/read_asset.py map.vdb product.obj carried.obj
"""

import json
import sys

import numpy as np
import pyopenvdb as vdb


class Level:
    """A lattice of displacements, trilinear between its nodes and zero where it has none."""

    def __init__(self, grid, pyramid, n):
        self.origin, self.voxel_size = np.array(pyramid["origin"]), pyramid["levels"][n]["voxel_size"]
        # Leaves have 512 nodes, all active and listed one leaf after the other.
        leaves = np.array([node.min for n, node in enumerate(grid.iterOnValues()) if n % 512 == 0])
        self.values = np.zeros((len(leaves) + 1, 8, 8, 8, 3), np.float32)  # the last is where there is none
        for leaf, values in zip(leaves.tolist(), self.values):
            grid.copyToArray(values, leaf)
        self.low = leaves.min(0) // 8 - 1  # of a table with an empty rim
        self.leaf_at = np.full(leaves.max(0) // 8 - self.low + 2, len(leaves))
        self.leaf_at[tuple((leaves // 8 - self.low).T)] = range(len(leaves))

    def at(self, node):
        entry = tuple(np.clip(node // 8 - self.low, 0, np.array(self.leaf_at.shape) - 1).T)
        return self.values[(self.leaf_at[entry], *(node % 8).T)]

    def __call__(self, x):
        place = (x - self.origin) / self.voxel_size
        low = np.floor(place).astype(int)
        shares = ((c, np.prod(np.where(c, place - low, 1 - place + low), 1)) for c in np.ndindex(2, 2, 2))
        return sum(share[:, None] * self.at(low + corner) for corner, share in shares)


def read_map(path):
    """x ↦ Ψ(1)(x) of points (n, 3): every step adds its levels to its affine part, the rigid part comes last."""
    record = json.loads(vdb.readMetadata(path)["bespoke:record"])
    steps = []
    for k, step in enumerate(record.get("steps", [record])):
        prefix, pyramid = f"s{k}_u_" if k else "u_", step["pyramid"]
        levels = [Level(vdb.read(path, f"{prefix}{n}"), pyramid, n) for n in range(len(pyramid["levels"]))]
        steps.append((np.transpose(step["affine"]["linear"]), step["affine"]["offset"], levels))

    def carry(x):
        for linear, offset, levels in steps:
            x = offset + x @ linear + sum(level(x) for level in levels)
        return x @ np.transpose(record["rigid"]["rotation"]) + record["rigid"]["translation"]

    return carry


if __name__ == "__main__":
    asset, product, output = sys.argv[1:] if len(sys.argv) == 4 else sys.exit(__doc__)
    lines = open(product).readlines()
    moved = read_map(asset)(np.array([line.split()[1:4] for line in lines if line.startswith("v ")], float))
    texts = ("v {:.9g} {:.9g} {:.9g}\n".format(*point) for point in moved)
    open(output, "w").writelines(next(texts) if line.startswith("v ") else line for line in lines)
