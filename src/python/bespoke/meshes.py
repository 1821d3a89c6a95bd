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


def read_mesh(path: str | os.PathLike[str]) -> Mesh:
    """Reads OBJ, PLY, STL, OFF or glTF, by the ending of the name; polygons become triangles.

    Raises FileError, FormatError (naming file and line), InvalidInput for an unknown ending.
    """
    return Mesh(*_engine.read_mesh(os.fspath(path)))


def write_mesh(path: str | os.PathLike[str], mesh: Mesh) -> None:
    """Writes OBJ, PLY, STL or OFF, by the ending of the name; the file appears whole or not at all."""
    _engine.write_mesh(os.fspath(path), mesh.vertices, mesh.faces)
