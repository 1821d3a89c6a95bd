"""Triangle meshes as arrays."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from . import _engine


@dataclass(frozen=True)
class Mesh:
    """Triangles over shared vertices."""

    vertices: npt.NDArray[np.float64]  #: (n, 3), the model's unit
    faces: npt.NDArray[np.int32]  #: (m, 3), indices of vertices, counter-clockwise seen from outside
    cloud: _engine.PointCloud | None = None  #: of a target: the points that it is the surface of
    unit: str = ""  #: "m", "mm", ... of the vertices, where a file says it (glTF, 3MF) or its maker does

    @property
    def diagonal(self) -> float:
        """Length of the bounding box's diagonal."""
        return float(np.linalg.norm(np.ptp(np.asarray(self.vertices), axis=0)))


def _arrays(mesh: Mesh, what: str) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]]:
    if not isinstance(mesh, Mesh):
        raise TypeError(
            f"{what} must be a bespoke.Mesh, not {type(mesh).__name__}; bespoke.read_mesh reads one from a file"
        )
    return mesh.vertices, mesh.faces


def _source_arrays(mesh: Mesh) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]]:
    arrays = _arrays(mesh, "source")
    if mesh.cloud is not None:
        raise _engine.InvalidInput("source: is the surface of a point cloud, which can be a target only")
    return arrays


def read_mesh(path: str | os.PathLike[str], *, pose: str = "shown") -> Mesh:
    """Reads OBJ, PLY, STL, OFF, glTF or 3MF, by the ending of the name; polygons become triangles.

    A PLY file of points with normals and no faces becomes the surface through them, which can be a target (`Mesh.cloud`
    says what the points were like). `pose` is that of skinned glTF meshes: "shown", as viewers have it, or "stored", as
    in the file.

    Raises FileError, FormatError (naming file and line), InvalidInput for an unknown ending, and for points with neither faces
    nor normals.
    """
    return Mesh(*_engine.read_mesh(os.fspath(path), pose))


def write_mesh(path: str | os.PathLike[str], mesh: Mesh) -> None:
    """Writes OBJ, PLY, STL, OFF or 3MF, by the ending of the name; the file appears whole or not at all."""
    _engine.write_mesh(os.fspath(path), mesh.vertices, mesh.faces, mesh.unit)
