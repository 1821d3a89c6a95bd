"""Maps of the space around one model onto the space around another::

    import bespoke

    source, target = bespoke.read_mesh("woman.obj"), bespoke.read_mesh("man.obj")
    fitted = bespoke.fit(source, target, bespoke.read_anchors("anchors.json"))
    fitted.map.save("woman_to_man.vdb")
    moved = fitted.map(points)  # (n, 3) doubles

Lengths are in the models' unit. Arrays of points are (n, 3) float64 in rows; such arrays are taken as they lie, others are
converted. Long calls run without Python's global lock, stop at Ctrl-C, and tell ``progress(stage, done, total)`` where
they are; whatever that raises stops them too. Errors are subclasses of `Error`.
"""

from ._engine import (
    Error,
    FileError,
    FormatError,
    Interrupted,
    InvalidInput,
    MemoryLimitError,
    SolverError,
)
from .anchors import Anchor, Anchors, Curve, Patch, PatchSide, read_anchors
from .fitting import Fit, fit
from .maps import Map
from .meshes import Mesh, read_mesh, write_mesh
from .summaries import (
    AnchorResidual,
    ApplySummary,
    Certificate,
    FitReport,
    FoldedCell,
    Info,
    Model,
    Quality,
    Stage,
    Statistics,
)

__all__ = [
    "Anchor",
    "AnchorResidual",
    "Anchors",
    "ApplySummary",
    "Certificate",
    "Curve",
    "Error",
    "FileError",
    "Fit",
    "FitReport",
    "FoldedCell",
    "FormatError",
    "Info",
    "Interrupted",
    "InvalidInput",
    "Map",
    "MemoryLimitError",
    "Mesh",
    "Model",
    "Patch",
    "PatchSide",
    "Quality",
    "SolverError",
    "Stage",
    "Statistics",
    "fit",
    "read_anchors",
    "read_mesh",
    "write_mesh",
]
