"""Points per second through VTK's vtkGridTransform, the rival of `apply_benchmark`'s look-ups.

    bespoke export map.vdb --grid 0.5% -o map.vti
    /usr/bin/python3 tests/performance/vtk_grid_transform.py map.vti

One thread, a million points of the image's box: in rows along x, and in random order. Needs Debian's python3-paraview or python3-vtk9.
"""

import sys
import time

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

POINTS = 1_000_000
REPETITIONS = 5


def transform_of(path):
    reader = vtk.vtkXMLImageDataReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    transform = vtk.vtkGridTransform()
    transform.SetDisplacementGridData(image)
    transform.SetInterpolationModeToLinear()
    transform.Update()
    return transform, np.reshape(image.GetBounds(), (3, 2)), image.GetNumberOfPoints()


def rows(box):
    side = round(POINTS ** (1 / 3))
    axes = [np.linspace(low, high, side) for low, high in box]
    z, y, x = np.meshgrid(*axes[::-1], indexing="ij")
    return np.stack([x, y, z], axis=-1).reshape(-1, 3)


def seconds_of(transform, points):
    given, taken = vtk.vtkPoints(), vtk.vtkPoints()
    for these in (given, taken):
        these.SetDataTypeToDouble()
    given.SetData(numpy_to_vtk(points))
    best = float("inf")
    for _ in range(REPETITIONS):
        taken.Reset()
        begin = time.process_time()
        transform.TransformPoints(given, taken)
        best = min(best, time.process_time() - begin)
    return best


transform, box, voxels = transform_of(sys.argv[1])
ordered = rows(box)
shuffled = np.random.default_rng(1).permutation(ordered)
for name, points in (("in rows", ordered), ("in random order", shuffled)):
    print(f"{voxels} voxels, {name}: {len(points) / seconds_of(transform, points) / 1e6:.2f} million points/s")
