"""Properties of the ParaView plugin, run in pvbatch: pvbatch paraview_test.py DIRECTORY PLUGIN

DIRECTORY holds map.vdb, source.obj, product.obj and moved.obj, where the command carries the product. Prints the name of every property.
"""

import sys
from pathlib import Path

import numpy as np
import paraview.simple as pv
from vtkmodules.util.numpy_support import vtk_to_numpy

DIRECTORY, PLUGIN = Path(sys.argv[1]), sys.argv[2]
MAP = str(DIRECTORY / "map.vdb")
pv.LoadPlugin(PLUGIN, ns=globals())


def read_obj(name):
    lines = (DIRECTORY / name).read_text().splitlines()
    return np.array([line.split()[1:4] for line in lines if line.startswith("v ")], float)


def fetched(source, port=0):
    return pv.servermanager.Fetch(source, idx=port)


def array(data, name):
    return vtk_to_numpy(data.GetPointData().GetArray(name)).astype(float)


def points(data):
    return vtk_to_numpy(data.GetPoints().GetData()).astype(float)


def carried_points_agree_with_apply():
    product = pv.OpenDataFile(str(DIRECTORY / "product.obj"))
    moved = read_obj("moved.obj")
    data = fetched(BespokeCarry(Input=product, Map=MAP))
    tolerance = 1e-6 * np.linalg.norm(np.ptp(moved, axis=0))
    assert np.abs(points(data) - moved).max() < tolerance
    arrows = fetched(BespokeCarry(Input=product, Map=MAP, MovePoints=0))
    assert np.abs(points(arrows) - read_obj("product.obj")).max() < tolerance
    assert np.abs(points(arrows) + array(arrows, "displacement") - moved).max() < 2 * tolerance


def normals_follow_and_cells_stay():
    sphere = pv.Sphere(Radius=0.5)
    given, data = fetched(sphere), fetched(BespokeCarry(Input=sphere, Map=MAP))
    assert data.GetNumberOfCells() == given.GetNumberOfCells()
    normals = array(data, "Normals")
    outward = points(data) - points(data).mean(0)
    assert (np.einsum("ij,ij->i", normals, outward) > 0).all()
    assert np.abs(normals - array(given, "Normals")).max() > 0.1  # the map turns by 40 degrees


def lattice_holds_the_map_at_its_nodes():
    """Carried as points, the nodes go where their arrows point."""
    lattice = fetched(BespokeMap(FileName=MAP))
    nodes = pv.ExtractSurface(Input=pv.OutputPort(BespokeMap(FileName=MAP), 0))
    data = fetched(BespokeCarry(Input=nodes, Map=MAP, MovePoints=0))
    before = fetched(nodes)
    assert np.abs(array(data, "displacement") - array(before, "displacement")).max() < 1e-5
    assert array(lattice, "determinant").min() > 0
    assert lattice.GetNumberOfPoints() == len(array(lattice, "determinant"))


def contour_of_the_distance_is_the_source():
    reader = BespokeMap(FileName=MAP)
    contour = fetched(
        pv.Contour(Input=pv.OutputPort(reader, 1), ContourBy=["POINTS", "source_distance"], Isosurfaces=[0.0])
    )
    voxel = fetched(reader, 1).GetSpacing()[0]
    # An ellipsoid of half axes 1, 1.4 and 0.8.
    for axis, radius in enumerate((1, 1.4, 0.8)):
        low, high = points(contour)[:, axis].min(), points(contour)[:, axis].max()
        # Half a voxel of shift would move both ends the same way.
        assert abs(low + high) < 0.1 * voxel and abs(high - radius) < 0.5 * voxel, (low, high, voxel)


for prop in (
    carried_points_agree_with_apply,
    normals_follow_and_cells_stay,
    lattice_holds_the_map_at_its_nodes,
    contour_of_the_distance_is_the_source,
):
    prop()
    print("held:", prop.__name__, flush=True)
