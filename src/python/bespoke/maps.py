"""Maps: loaded or fitted, applied to points and products, inverted and composed."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from . import _engine
from .meshes import Mesh, _arrays, _source_arrays
from .summaries import ApplySummary, Certificate, Info, Quality

Progress = Callable[[str, int, int], object]
Length = float | str


class Map:
    """A map Ψ(t) of the space around the source onto the space around the target.

    Any number of threads may query one map at a time.
    """

    def __init__(self, engine: _engine.Map) -> None:
        self._engine = engine

    @classmethod
    def load(cls, path: str | os.PathLike[str], *, untrusted: bool = False) -> Map:
        """Reads an asset. With `untrusted` it is checked in a process of its own first.

        Raises FileError, FormatError for whatever the file cannot vouch for, MemoryLimitError.
        """
        return cls(_engine.Map.load(os.fspath(path), untrusted))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the asset, whole or not at all; the same map gives the same bytes."""
        self._engine.save(os.fspath(path))

    def __call__(
        self, points: npt.ArrayLike, t: float = 1.0, *, path: str = "", order: str = ""
    ) -> npt.NDArray[np.float64]:
        """Ψ(t) of points (n, 3) in the source's frame; (n, 3), in the target's frame at t = 1.

        `path` and `order` are those of `bespoke apply`, by default the asset's own. Raises InvalidInput for other shapes
        and for points that are not finite.
        """
        return self._engine.image(points, t, path, order)

    def inverse(self, points: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Ψ(1)⁻¹ of points (n, 3) in the target's frame, through the map's own cells, to 1e-6 of the finest voxel.

        Raises InvalidInput unless the map is certified as a bijection.
        """
        return self._engine.inverse(points)

    def jacobian(self, points: npt.ArrayLike, t: float = 1.0) -> npt.NDArray[np.float64]:
        """(n, 3, 3): entry (i, j) of a point's matrix is the derivative of coordinate i of Ψ(t) by coordinate j."""
        return self._engine.jacobian(points, t)

    def apply(
        self,
        product: str | os.PathLike[str],
        output: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
        t: float | Sequence[float] = 1.0,
        *,
        path: str = "",
        order: str = "",
        rigid: Sequence[str] = (),
        similar: Sequence[str] = (),
        refine: Length | None = None,
        unit: str = "",
        pose: str = "shown",
        clearance: Length = "off",
        layers: Sequence[str | os.PathLike[str]] = (),
        source: Mesh | None = None,
        target: Mesh | None = None,
        progress: Progress | None = None,
    ) -> ApplySummary:
        """Carries a product's file: positions and directions move, everything else is copied through.

        Parts named in `rigid` and `similar` keep their shape: groups, objects and materials of OBJ, nodes of glTF,
        components of PLY. `refine` splits edges of a product until their middles lie no farther than this from
        where the map takes them. `unit` is that of the product's coordinates ("mm", ..., "map" for the map's own), by
        default what a glTF or 3MF file says, else the map's; the product stays in it. `pose` is that of a skinned glTF
        product, as `read_mesh` takes it.
        `clearance` ("keep", "same", a length, or "off") keeps the product clear of the target at t = 1, as `bespoke apply
        --clearance` does, and clear of the products in `layers`, which lie below it, from the inside to the outside;
        what was found is in the summary's `json["products"][0]["clearance"]`.
        With both models that the map was made of, products that penetrate the target at the last time, if that is
        1, are warned of. With several times, `output` names as many files, and they cost one look-up. All files are written or none.
        """
        times = [float(t)] if isinstance(t, (int, float)) else [float(time) for time in t]
        outputs = [output] if isinstance(output, (str, os.PathLike)) else list(output)
        if len(times) != len(outputs):
            raise _engine.InvalidInput(f"{len(times)} times and {len(outputs)} outputs: give one output a time")
        report = json.loads(
            self._engine.apply(
                os.fspath(product),
                [os.fspath(name) for name in outputs],
                times,
                path,
                order,
                list(rigid),
                list(similar),
                refine,
                unit,
                pose,
                str(clearance),
                [os.fspath(name) for name in layers],
                progress,
            )
        )
        found = report["products"][0]
        warnings = list(found.get("warnings", ()))
        if source is not None and target is not None and times[-1] == 1:
            measured = self.measure(source, target, [product], unit=unit, pose=pose, progress=progress)
            warnings += [warning for each in measured.json["products"] for warning in each.get("warnings", ())]
        return ApplySummary(
            points=found["points"],
            in_band=found["in_band"],
            affine_only=found["affine_only"],
            seconds=report["seconds"],
            warnings=tuple(warnings),
            json=report,
        )

    def inverted(
        self, *, tolerance: Length | None = None, half: bool = False, progress: Progress | None = None
    ) -> Map:
        """The map from the target back to the source, as a map of its own (`bespoke invert`)."""
        return Map(self._engine.inverted(tolerance, half, progress))

    def compose(
        self,
        second: Map,
        *,
        tolerance: Length | None = None,
        half: bool = False,
        any_models: bool = False,
        progress: Progress | None = None,
    ) -> Map:
        """This map first, then `second`, as one map (`bespoke compose`)."""
        return Map(self._engine.composed(second._engine, tolerance, half, any_models, progress))

    def check(self, t: float = 1.0, *, progress: Progress | None = None) -> Certificate:
        """Proves that Ψ(t) does not fold, or says where it does."""
        return Certificate._from(json.loads(self._engine.check(t, progress)))

    @property
    def info(self) -> Info:
        """What the asset says about itself."""
        return Info._from(json.loads(self._engine.info()))

    def measure(
        self,
        source: Mesh,
        target: Mesh,
        products: Sequence[str | os.PathLike[str]] = (),
        *,
        unit: str = "",
        pose: str = "shown",
        progress: Progress | None = None,
    ) -> Quality:
        """Numbers for how good the map is, and for what it does to products (files, `unit` and `pose` as for `apply`).

        Raises InvalidInput for models that the map was not made of.
        """
        return Quality._from(
            json.loads(
                self._engine.measure(
                    (*_source_arrays(source), source.unit),
                    (*_arrays(target, "target"), target.unit),
                    target.cloud,
                    [os.fspath(product) for product in products],
                    unit,
                    pose,
                    progress,
                )
            )
        )

    def __repr__(self) -> str:
        info = self.info
        kind = "bijection" if info.certificate.bijection else "not certified"
        return f"<bespoke.Map {info.surface_fit} + {info.elastic}, {info.voxels} voxels, {kind}>"
