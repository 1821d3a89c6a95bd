"""Draws a slice of a map's nested levels with the outline of the source in it: where the map is stored finely.

    /usr/bin/python3 samples/render_levels.py MAP.vdb PICTURE.png [x|y|z [PLACE]]

The slice lies across the axis (z by default) at PLACE, mesh units, or through the middle of the source. Needs
pyopenvdb and matplotlib (python3-openvdb, python3-matplotlib).
"""
import sys

import matplotlib
import numpy as np
import pyopenvdb

matplotlib.use("Agg")
import matplotlib.pyplot as plt

PIXELS = 1200  # along the longer edge of the slice


def inside_leaves(grid, x):
    """For every column of x (3×n, world): does a leaf of the grid hold it?"""
    low, high = (np.array(corner) for corner in grid.evalActiveVoxelBoundingBox())
    leaves = np.zeros((high + 1 - low) // 8, dtype=bool)
    for item in grid.citerOnValues():
        leaves[tuple((np.array(item.min) - low) // 8)] = True
    size = grid.transform.voxelSize()[0]
    origin = np.array(grid.transform.indexToWorld((0, 0, 0)))
    index = (np.floor((x - origin[:, None]) / size).astype(int) - low[:, None]) // 8
    held = np.all((index >= 0) & (index < np.array(leaves.shape)[:, None]), axis=0)
    held[held] = leaves[tuple(index[:, held])]
    return held


def plane(grid, across, place):
    """Coordinates along the two other axes and values of the grid on its lattice plane nearest to the place."""
    low, high = (np.array(corner) for corner in grid.evalActiveVoxelBoundingBox())
    size = grid.transform.voxelSize()[0]
    origin = np.array(grid.transform.indexToWorld((0, 0, 0)))
    low[across] = high[across] = round((place - origin[across]) / size)
    values = np.empty(high + 1 - low, dtype=np.float32)
    grid.copyToArray(values, ijk=tuple(low.tolist()))
    ticks = [origin[i] + size * np.arange(low[i], high[i] + 1) for i in range(3) if i != across]
    return *ticks, values.squeeze(across)


def main(asset, picture, axis="z", place=None):
    grids = {grid.name: grid for grid in pyopenvdb.readAllGridMetadata(asset)}
    levels = sorted((name for name in grids if name.startswith("u_")), key=lambda name: int(name[2:]))
    distance = pyopenvdb.read(asset, "source_distance")
    across = "xyz".index(axis)
    along = [i for i in range(3) if i != across]

    coarsest = pyopenvdb.read(asset, levels[0])
    corners = [np.array(coarsest.transform.indexToWorld(tuple(corner)))
               for corner in coarsest.evalActiveVoxelBoundingBox()]
    low, high = corners
    model = distance.evalActiveVoxelBoundingBox()
    middle = np.mean([distance.transform.indexToWorld(tuple(corner)) for corner in model], axis=0)
    step = max(high[along] - low[along]) / PIXELS
    ticks = [np.arange(low[i], high[i], step) for i in along]
    first, second = np.meshgrid(*ticks, indexing="ij")
    x = np.empty((3, first.size))
    x[along[0]], x[along[1]] = first.ravel(), second.ravel()
    x[across] = middle[across] if place is None else float(place)

    finest = np.zeros(first.size)
    for number, name in enumerate(levels):
        finest[inside_leaves(pyopenvdb.read(asset, name), x)] = number + 1
    outline_x, outline_y, outline = plane(distance, across, x[across, 0])

    figure, axes = plt.subplots(figsize=(8, 8 * len(ticks[1]) / len(ticks[0]) + 0.6))
    colours = plt.get_cmap("viridis", len(levels) + 1)
    image = axes.imshow(finest.reshape(first.shape).T, origin="lower", cmap=colours, interpolation="nearest",
                        extent=(low[along[0]], high[along[0]], low[along[1]], high[along[1]]),
                        vmin=-0.5, vmax=len(levels) + 0.5)
    axes.contour(outline_x, outline_y, outline.T, levels=[0], colors="white", linewidths=1)
    bar = figure.colorbar(image, ax=axes, ticks=range(len(levels) + 1), shrink=0.6)
    bar.ax.set_yticklabels(["affine"] + levels)
    axes.set_title(f"finest level, {axis} = {x[across, 0]:.4g}")
    figure.tight_layout()
    figure.savefig(picture, dpi=120)


if __name__ == "__main__":
    if not 3 <= len(sys.argv) <= 5:
        sys.exit(__doc__)
    main(*sys.argv[1:])
