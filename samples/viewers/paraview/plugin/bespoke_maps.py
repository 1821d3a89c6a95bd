"""bespoke's maps in ParaView: a reader of their grids, and a filter that carries polygonal data through a map.

Needs pyopenvdb (Debian: python3-openvdb) in ParaView's Python. ParaView 5.11 on Python 3.11 needs python311 in PYTHONPATH to load any
plugin in Python.
"""

import json
import os
import sys

import numpy as np
import pyopenvdb as vdb
from paraview.util.vtkAlgorithm import VTKPythonAlgorithmBase, smdomain, smhint, smproperty, smproxy
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkPolyDataNormals

sys.path.insert(0, os.path.abspath(__file__ + "/../../.."))
from read_asset import read_map


def record_of(path):
    """What the file says of itself. Raises ValueError for a .vdb that is no map."""
    if not path:
        raise ValueError("no map: give the .vdb file that `bespoke fit` wrote")
    try:
        return json.loads(vdb.readMetadata(path)["bespoke:record"])
    except KeyError:
        raise ValueError(f"{path} is no map of bespoke: it has no bespoke:record") from None


def lattice_of(grid):
    """The grid's box of nodes as an image without values: nodes are VTK's points, so there is no shift by half a voxel."""
    low, high = grid.evalActiveVoxelBoundingBox()
    image = vtkImageData()
    image.SetDimensions(*(np.subtract(high, low) + 1))
    image.SetSpacing(grid.transform.voxelSize())
    image.SetOrigin(grid.transform.indexToWorld(low))
    return image


def nodes_of(image):
    """(n, 3), the first index fastest."""
    axes = [o + h * np.arange(n) for o, h, n in zip(image.GetOrigin(), image.GetSpacing(), image.GetDimensions())]
    z, y, x = np.meshgrid(*axes[::-1], indexing="ij")
    return np.c_[x.ravel(), y.ravel(), z.ravel()]


def values_of(grid):
    """One value a node of the grid's box, the first index fastest."""
    low, high = grid.evalActiveVoxelBoundingBox()
    values = np.zeros(np.subtract(high, low) + 1, np.float32)
    grid.copyToArray(values, low)
    return values.ravel("F")


def give(data, name, values):
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    data.GetPointData().AddArray(array)


@smproxy.reader(
    name="BespokeMap", label="Bespoke Map", extensions="vdb", file_description="bespoke maps", support_reload=False
)
@smproperty.xml('<OutputPort name="Map" index="0" /><OutputPort name="Source" index="1" />')
class MapReader(VTKPythonAlgorithmBase):
    """Port 0: displacement and determinant on the map's coarse lattice. Port 1: distance from the source model."""

    def __init__(self):
        super().__init__(nInputPorts=0, nOutputPorts=2, outputType="vtkImageData")
        self._path = None

    @smproperty.stringvector(name="FileName", panel_visibility="never")
    @smdomain.filelist()
    @smhint.filechooser(extensions="vdb", file_description="bespoke maps")
    def SetFileName(self, path):
        if path != self._path:
            self._path = path
            self.Modified()

    def RequestInformation(self, request, inputs, outputs):
        record_of(self._path)
        for port, name in enumerate(("jacobian", "source_distance")):
            extent = lattice_of(vdb.read(self._path, name)).GetExtent()
            outputs.GetInformationObject(port).Set(self.GetExecutive().WHOLE_EXTENT(), *extent)
        return 1

    def RequestData(self, request, inputs, outputs):
        jacobian = vdb.read(self._path, "jacobian")
        image = lattice_of(jacobian)
        nodes = nodes_of(image)
        # The map itself at the nodes, not the preview that the file holds.
        give(image, "displacement", (read_map(self._path)(nodes) - nodes).astype(np.float32))
        give(image, "determinant", values_of(jacobian) + 1)
        vtkImageData.GetData(outputs, 0).ShallowCopy(image)

        distance = vdb.read(self._path, "source_distance")
        image = lattice_of(distance)
        give(image, "source_distance", values_of(distance))
        vtkImageData.GetData(outputs, 1).ShallowCopy(image)
        return 1


@smproxy.filter(name="BespokeCarry", label="Bespoke Carry")
@smproperty.input(name="Input", port_index=0)
@smdomain.datatype(dataTypes=["vtkPolyData"], composite_data_supported=False)
class Carry(VTKPythonAlgorithmBase):
    """The input where the map takes it, Ψ(1), with the array `displacement`; normals are made anew where there were some.

    Without MovePoints only the array is added, for arrows.
    """

    def __init__(self):
        super().__init__(nInputPorts=1, nOutputPorts=1, inputType="vtkPolyData", outputType="vtkPolyData")
        self._path = None
        self._moves = True
        self._loaded = None, None

    @smproperty.stringvector(name="Map")
    @smdomain.filelist()
    @smhint.filechooser(extensions="vdb", file_description="bespoke maps")
    def SetMap(self, path):
        if path != self._path:
            self._path = path
            self.Modified()

    @smproperty.xml(
        """<IntVectorProperty name="MovePoints" command="SetMovePoints" number_of_elements="1" default_values="1">
             <BooleanDomain name="bool" />
           </IntVectorProperty>"""
    )
    def SetMovePoints(self, moves):
        if bool(moves) != self._moves:
            self._moves = bool(moves)
            self.Modified()

    def map(self):
        """Read once for every state of the file."""
        record_of(self._path)
        state = self._path, os.stat(self._path).st_mtime_ns
        if self._loaded[0] != state:
            self._loaded = state, read_map(self._path)
        return self._loaded[1]

    def RequestData(self, request, inputs, outputs):
        given, result = vtkPolyData.GetData(inputs[0]), vtkPolyData.GetData(outputs)
        result.ShallowCopy(given)
        if given.GetNumberOfPoints() == 0:
            return 1
        x = vtk_to_numpy(given.GetPoints().GetData()).astype(float)
        moved = self.map()(x)
        give(result, "displacement", (moved - x).astype(np.float32))
        if not self._moves:
            return 1
        points = vtkPoints()
        points.SetData(numpy_to_vtk(moved.astype(np.float32), deep=True))
        result.SetPoints(points)
        if given.GetPointData().GetNormals():
            result.ShallowCopy(with_new_normals(result))
        return 1


def with_new_normals(data):
    """Of the same points: no edge is split, no face turned."""
    normals = vtkPolyDataNormals()
    normals.SetInputData(data)
    normals.SplittingOff()
    normals.ConsistencyOff()
    normals.Update()
    return normals.GetOutput()
