"""Pairs of corresponding points."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass

from . import _engine


@dataclass(frozen=True)
class Anchor:
    """A point on or near the source and its counterpart on or near the target."""

    a: tuple[float, float, float]  #: on the source
    b: tuple[float, float, float]  #: on the target
    name: str = ""
    sigma: float | None = None  #: accuracy, the standard deviation of a coordinate; 0 is met exactly, None is estimated
    weight: float | None = None  #: instead of sigma: a least-squares weight


class Anchors(tuple[Anchor, ...]):
    """A tuple of anchors that may know the unit of their file."""

    unit: str

    def __new__(cls, pairs: Iterable[Anchor] = (), unit: str = "") -> Anchors:
        anchors = super().__new__(cls, pairs)
        anchors.unit = unit
        return anchors


def read_anchors(path: str | os.PathLike[str]) -> Anchors:
    """Reads pairs from JSON or CSV, as `bespoke fit --anchors` does.

    Raises FileError, or FormatError naming the file and the line or the pair.
    """
    unit, pairs = _engine.read_anchors(os.fspath(path))
    return Anchors((Anchor(a, b, name, sigma, weight) for name, a, b, weight, sigma in pairs), unit)


def _pairs(anchors: Iterable[Anchor]) -> list[_engine.AnchorFields]:
    if isinstance(anchors, (str, bytes, os.PathLike)):
        raise TypeError("anchors must be bespoke.Anchor objects; bespoke.read_anchors reads them from a file")
    pairs = list(anchors)
    for number, pair in enumerate(pairs):
        if not isinstance(pair, Anchor):
            raise TypeError(f"anchor {number} must be a bespoke.Anchor, not {type(pair).__name__}")
    return [(pair.name, pair.a, pair.b, pair.weight, pair.sigma) for pair in pairs]
