"""From two models and their anchors to a map."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from . import _engine
from .anchors import Anchor, _text
from .maps import Length, Map, Progress
from .meshes import Mesh, _arrays, _source_arrays
from .summaries import FitReport


@dataclass(frozen=True)
class Fit:
    """A map and how it came to be."""

    map: Map
    fitted: Mesh  #: the source registered to the target, target frame
    confidence: npt.NDArray[np.float64]  #: (n,), 0 to 1: whether a vertex found a counterpart; empty with `fitted`
    report: FitReport


def fit(
    source: Mesh,
    target: Mesh,
    anchors: Iterable[Anchor] = (),
    *,
    fitted: Mesh | None = None,
    add_corners: bool = False,
    surface_fit: str | None = None,
    boundaries: str | None = None,
    max_stretch: float | None = None,
    elastic: str | None = None,
    guides: str | None = None,
    max_squeeze: float | None = None,
    path: str | None = None,
    steps: int | None = None,
    as_given: bool = False,
    any_size: bool = False,
    any_anchors: bool = False,
    unit: str = "",
    paper: bool = False,
    anchor_sigma: Length | None = None,
    lambda_: Length | None = None,
    tolerance: Length | None = None,
    fit_tolerance: Length | None = None,
    contact_offset: Length | None = None,
    voxel_size: Length | None = None,
    nodes: str | None = None,
    strict: bool = False,
    half: bool = False,
    keep_exact: bool = False,
    max_memory: int | None = None,
    progress: Progress | None = None,
) -> Fit:
    """Fits a map of the space around `source` onto the space around `target`, and bakes it.

    The options are those of `bespoke fit`, with its defaults; lengths are numbers in the models' unit or texts like
    "10%" of the source's diagonal, `max_memory` is in bytes. Without anchors models in similar pose are aligned by their
    surfaces, or refused. `unit` is that of the map: meshes and anchors that say another are converted, others are taken
    as being in it; by default it is what anchors, source or target say. `Anchors` hold curves and patches too. Given the same input, the map is the command's, bit for bit.

    Raises TypeError for models and anchors of other types, InvalidInput, SolverError (also when models cannot be
    aligned with certainty), MemoryLimitError.
    """
    source_arrays, target_arrays = _source_arrays(source), _arrays(target, "target")
    fitted_arrays = None if fitted is None else _arrays(fitted, "fitted")
    options = {
        "surface_fit": surface_fit,
        "boundaries": boundaries,
        "max_stretch": max_stretch,
        "elastic": elastic,
        "guides": guides,
        "max_squeeze": max_squeeze,
        "path": path,
        "steps": steps,
        "as_given": as_given,
        "any_size": any_size,
        "any_anchors": any_anchors,
        "unit": unit,
        "source_unit": source.unit,
        "target_unit": target.unit,
        "fitted_unit": "" if fitted is None else fitted.unit,
        "paper": paper,
        "anchor_sigma": anchor_sigma,
        "lambda_": lambda_,
        "tolerance": tolerance,
        "fit_tolerance": fit_tolerance,
        "contact_gap": contact_offset,
        "voxel_size": voxel_size,
        "nodes": nodes,
        "strict": strict,
        "half": half,
        "keep_exact": keep_exact,
        "max_memory": max_memory,
    }
    engine, vertices, confidence, report = _engine.fit(
        source_arrays,
        target_arrays,
        target.cloud,
        _text(anchors),
        fitted_arrays,
        add_corners,
        options,
        progress,
    )
    made = Map(engine)
    known = made.info.unit
    registered = Mesh(vertices, source.faces, unit="" if known == "unknown" else known)
    return Fit(made, registered, confidence, FitReport._from(json.loads(report)))
