"""What was found, as data classes; `_from` makes them of the library's JSON."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any


def _known(kind: type, found: Mapping[str, Any]) -> dict[str, Any]:
    names = {field.name for field in fields(kind)}
    return {name: value for name, value in found.items() if name in names}


@dataclass(frozen=True)
class Statistics:
    """Of a sample; a length's unit is the models'. Quantiles that were not requested are None."""

    count: int
    min: float = 0.0
    max: float = 0.0
    median: float | None = None
    p1: float | None = None
    p95: float | None = None
    p99: float | None = None

    @classmethod
    def _from(cls, found: Mapping[str, Any]) -> Statistics:
        return cls(**_known(cls, found))


@dataclass(frozen=True)
class FoldedCell:
    """A cell in which the Jacobian's determinant is not positive everywhere."""

    level: int
    center: tuple[float, float, float]  #: source frame
    determinant: float


@dataclass(frozen=True)
class Certificate:
    """What is proved about a map."""

    bijection: bool  #: of all of space, proved
    certified: int  #: finest cells with a positive determinant, proved
    undecided: int
    folded: int
    min_determinant: float  #: lower bound over the certified cells
    affine_determinant: float
    places: tuple[FoldedCell, ...] = ()

    @classmethod
    def _from(cls, found: Mapping[str, Any]) -> Certificate:
        places = tuple(
            FoldedCell(place["level"], tuple(place["center"]), place["determinant"]) for place in found["places"]
        )
        return cls(**{**_known(cls, found), "places": places})


@dataclass(frozen=True)
class Model:
    """One of the two models of a map."""

    hash: str  #: SHA-256 of vertices and faces
    box_min: tuple[float, float, float]
    box_max: tuple[float, float, float]

    @classmethod
    def _from(cls, found: Mapping[str, Any]) -> Model:
        return cls(found["hash"], tuple(found["box"]["min"]), tuple(found["box"]["max"]))


@dataclass(frozen=True)
class AnchorResidual:
    """An anchor as the asset records it."""

    name: str
    a: tuple[float, float, float]
    b: tuple[float, float, float]
    residual: float  #: distance of a's image from b

    @classmethod
    def _from(cls, found: Mapping[str, Any]) -> AnchorResidual:
        return cls(found["name"], tuple(found["a"]), tuple(found["b"]), found["residual"])


@dataclass(frozen=True)
class Info:
    """What an asset says about itself."""

    unit: str
    path: str  #: how the motion goes with t
    surface_fit: str
    elastic: str
    lambda_: float  #: effective distance
    tolerance: float  #: requested
    bake_error: Statistics
    precision: str  #: "single" or "half"
    voxels: int
    certificate: Certificate
    source: Model
    target: Model
    anchors: tuple[AnchorResidual, ...]
    json: Mapping[str, Any]  #: all of `bespoke info --json`

    @classmethod
    def _from(cls, found: Mapping[str, Any]) -> Info:
        return cls(
            unit=found["unit"],
            path=found["path"],
            surface_fit=found["surface_fit"],
            elastic=found["elastic"],
            lambda_=found["lambda"],
            tolerance=found["tolerance"],
            bake_error=Statistics._from(found["bake_error"]),
            precision=found["precision"],
            voxels=found["voxels"],
            certificate=Certificate._from(found["certificate"]),
            source=Model._from(found["source"]),
            target=Model._from(found["target"]),
            anchors=tuple(AnchorResidual._from(anchor) for anchor in found["anchors"]),
            json=found,
        )


@dataclass(frozen=True)
class Stage:
    """A step of the fit: its name, what it took and what it found."""

    name: str
    seconds: float
    found: Mapping[str, Any]

    @classmethod
    def _from(cls, found: Mapping[str, Any]) -> Stage:
        rest = {key: value for key, value in found.items() if key not in ("name", "seconds")}
        return cls(found["name"], found["seconds"], rest)


@dataclass(frozen=True)
class FitReport:
    """How a map came to be."""

    seconds: float
    peak_memory: int  #: bytes
    vertex_residuals: Statistics  #: of the source's vertices from their registered places
    anchor_residuals: Statistics | None  #: None without anchors
    stages: tuple[Stage, ...]
    json: Mapping[str, Any]  #: all of `bespoke fit --report`

    @classmethod
    def _from(cls, found: Mapping[str, Any]) -> FitReport:
        anchors = found.get("anchor_residuals")
        return cls(
            seconds=found["seconds"],
            peak_memory=found["peak_memory"],
            vertex_residuals=Statistics._from(found["vertex_residuals"]),
            anchor_residuals=Statistics._from(anchors) if anchors else None,
            stages=tuple(Stage._from(stage) for stage in found["stages"]),
            json=found,
        )


@dataclass(frozen=True)
class ApplySummary:
    """What was carried."""

    points: int
    in_band: int  #: points that the elastic part moved
    affine_only: int
    seconds: float
    warnings: tuple[str, ...]  #: what the file holds that was left as it is; of a product inside the target
    json: Mapping[str, Any]  #: all of `bespoke apply --report`


@dataclass(frozen=True)
class Quality:
    """The measures of `bespoke measure`."""

    unit: str
    anchor_residuals: Statistics
    source_to_target: Statistics  #: from the mapped source to the target's surface
    target_to_source: Statistics
    hausdorff: float
    min_determinant: float  #: of the Jacobian at the samples
    flipped_faces: int  #: of the source
    warnings: tuple[str, ...]  #: of products that lie inside the target, though not inside the source before
    json: Mapping[str, Any]  #: all of `bespoke measure --json`, products too

    @classmethod
    def _from(cls, found: Mapping[str, Any]) -> Quality:
        return cls(
            unit=found["unit"],
            anchor_residuals=Statistics._from(found["anchor_residuals"]),
            source_to_target=Statistics._from(found["source_to_target"]),
            target_to_source=Statistics._from(found["target_to_source"]),
            hausdorff=found["hausdorff"],
            min_determinant=found["distortion"]["min_determinant"],
            flipped_faces=found["flipped_faces"],
            warnings=tuple(
                f"{product['name']}: {warning}"
                for product in found["products"]
                for warning in product.get("warnings", ())
            ),
            json=found,
        )
