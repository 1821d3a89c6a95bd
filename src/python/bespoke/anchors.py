"""What belongs together on two models: pairs of points, curves and patches."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _engine


@dataclass(frozen=True)
class Anchor:
    """A point on or near the source and its counterpart on or near the target."""

    a: tuple[float, float, float]  #: on the source
    b: tuple[float, float, float]  #: on the target
    name: str = ""
    sigma: float | None = None  #: accuracy, the standard deviation of a coordinate; 0 is met exactly, None is estimated
    weight: float | None = None  #: instead of sigma: a least-squares weight


@dataclass(frozen=True, eq=False)
class Curve:
    """A line on the source and its counterpart on the target, which slides along itself except at fixed points."""

    a: npt.ArrayLike  #: (n, 3), a polyline on the source
    b: npt.ArrayLike  #: (m, 3), on the target
    name: str = ""
    closed: bool = False
    fixed: Sequence[tuple[int, int]] = ()  #: points of a and of b, by number from 0, that belong together


@dataclass(frozen=True, eq=False)
class PatchSide:
    """A part of a model's surface: one of the two."""

    border: npt.ArrayLike | None = None  #: (n, 3), a closed polyline around it
    faces: Sequence[int] | None = None  #: by their numbers from 0


@dataclass(frozen=True, eq=False)
class Patch:
    """A part of the source and its counterpart: inside goes inside, border onto border."""

    a: PatchSide | None = None  #: on the source
    b: PatchSide | None = None  #: on the target
    name: str = ""
    exclude: bool = False  #: attracts nothing and is attracted by nothing; one side may be missing then


class Anchors(tuple[Anchor, ...]):
    """A tuple of pairs that may know curves, patches and the unit of their file."""

    unit: str
    curves: tuple[Curve, ...]
    patches: tuple[Patch, ...]

    def __new__(
        cls,
        pairs: Iterable[Anchor] = (),
        unit: str = "",
        curves: Iterable[Curve] = (),
        patches: Iterable[Patch] = (),
    ) -> Anchors:
        anchors = super().__new__(cls, pairs)
        anchors.unit = unit
        anchors.curves = tuple(curves)
        anchors.patches = tuple(patches)
        return anchors


def read_anchors(path: str | os.PathLike[str]) -> Anchors:
    """Reads pairs, curves and patches from JSON, or pairs from CSV, as `bespoke fit --anchors` does.

    Raises FileError, or FormatError naming the file and the line or the pair.
    """
    document = json.loads(_engine.read_anchors(os.fspath(path)))
    return Anchors(
        (
            Anchor(tuple(pair["a"]), tuple(pair["b"]), pair.get("name", ""), pair.get("sigma"), pair.get("weight"))
            for pair in document["pairs"]
        ),
        document.get("units", ""),
        (
            Curve(
                np.array(curve["a"]),
                np.array(curve["b"]),
                curve.get("name", ""),
                curve.get("closed", False),
                tuple((i, j) for i, j in curve.get("fixed", ())),
            )
            for curve in document.get("curves", ())
        ),
        (
            Patch(_side(patch.get("a")), _side(patch.get("b")), patch.get("name", ""), patch.get("exclude", False))
            for patch in document.get("patches", ())
        ),
    )


def _side(side: Mapping[str, Any] | None) -> PatchSide | None:
    if side is None:
        return None
    return PatchSide(faces=tuple(side["faces"])) if "faces" in side else PatchSide(np.array(side["border"]))


def _text(anchors: Iterable[Anchor]) -> str:
    """The text of the JSON file that says the same."""
    if isinstance(anchors, (str, bytes, os.PathLike)):
        raise TypeError("anchors must be bespoke.Anchor objects; bespoke.read_anchors reads them from a file")
    pairs = list(anchors)
    for number, pair in enumerate(pairs):
        if not isinstance(pair, Anchor):
            raise TypeError(f"anchor {number} must be a bespoke.Anchor, not {type(pair).__name__}")
    document: dict[str, Any] = {"pairs": [_pair_fields(pair) for pair in pairs]}
    if unit := getattr(anchors, "unit", ""):
        document["units"] = unit
    if curves := getattr(anchors, "curves", ()):
        document["curves"] = [_curve_fields(curve) for curve in curves]
    if patches := getattr(anchors, "patches", ()):
        document["patches"] = [_patch_fields(patch) for patch in patches]
    try:
        return json.dumps(document, allow_nan=False)
    except ValueError as error:
        raise _engine.InvalidInput("anchors: a number is not finite") from error


def _rows(points: npt.ArrayLike) -> list[list[float]]:
    rows: list[list[float]] = np.asarray(points, dtype=np.float64).tolist()
    return rows


def _pair_fields(pair: Anchor) -> dict[str, Any]:
    fields: dict[str, Any] = {"a": [float(x) for x in pair.a], "b": [float(x) for x in pair.b]}
    if pair.name:
        fields["name"] = pair.name
    if pair.sigma is not None:
        fields["sigma"] = float(pair.sigma)
    if pair.weight is not None and not math.isinf(pair.weight):
        fields["weight"] = float(pair.weight)
    return fields


def _curve_fields(curve: Curve) -> dict[str, Any]:
    return {
        "a": _rows(curve.a),
        "b": _rows(curve.b),
        "name": curve.name,
        "closed": bool(curve.closed),
        "fixed": [[int(i), int(j)] for i, j in curve.fixed],
    }


def _patch_fields(patch: Patch) -> dict[str, Any]:
    fields: dict[str, Any] = {"name": patch.name, "exclude": bool(patch.exclude)}
    for key, side in (("a", patch.a), ("b", patch.b)):
        if side is None:
            continue
        fields[key] = {}
        if side.border is not None:
            fields[key]["border"] = _rows(side.border)
        if side.faces is not None:
            fields[key]["faces"] = [int(face) for face in side.faces]
    return fields
