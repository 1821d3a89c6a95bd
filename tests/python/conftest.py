"""A pair of models that every test starts from: two ellipsoids, of other connectivity and in another place."""

import os
import subprocess
from pathlib import Path

import bespoke
import numpy as np
import pytest


def ellipsoid(rings, sectors, radii):
    """Closed, faces outwards."""
    angles = np.linspace(0, np.pi, rings + 1)[1:-1]
    turns = np.arange(sectors) * 2 * np.pi / sectors
    around = [(np.sin(a) * np.cos(s), np.sin(a) * np.sin(s), np.cos(a)) for a in angles for s in turns]
    vertices = np.array([(0, 0, 1), *around, (0, 0, -1)]) * radii
    at = lambda ring, sector: 1 + ring * sectors + sector % sectors
    last = len(vertices) - 1
    faces = []
    for s in range(sectors):
        faces.append((0, at(0, s), at(0, s + 1)))
        faces.append((last, at(rings - 2, s + 1), at(rings - 2, s)))
        for ring in range(rings - 2):
            faces.append((at(ring, s), at(ring + 1, s), at(ring + 1, s + 1)))
            faces.append((at(ring, s), at(ring + 1, s + 1), at(ring, s + 1)))
    return bespoke.Mesh(vertices, np.array(faces, dtype=np.int32))


TURN = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
SHIFT = np.array([3.0, -1, 2])
SOURCE_RADII = np.array([1, 1.4, 2])
TARGET_RADII = np.array([1.2, 1.3, 1.8])


class Pair:
    def __init__(self, directory):
        self.directory = directory
        self.source = ellipsoid(24, 36, SOURCE_RADII)
        target = ellipsoid(20, 30, TARGET_RADII)
        self.target = bespoke.Mesh(target.vertices @ TURN.T + SHIFT, target.faces)
        directions = np.array(
            [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if (x, y, z) != (0, 0, 0)], float
        )
        directions /= np.linalg.norm(directions, axis=1)[:, None]
        self.anchors = tuple(
            bespoke.Anchor(tuple(a), tuple(b), f"p{k}", 0.0)
            for k, (a, b) in enumerate(
                zip(directions * SOURCE_RADII, directions * TARGET_RADII @ TURN.T + SHIFT)
            )
        )
        self.fit = bespoke.fit(self.source, self.target, self.anchors, tolerance="0.2%")
        self.map = self.fit.map


@pytest.fixture(scope="session")
def pair(tmp_path_factory):
    return Pair(tmp_path_factory.mktemp("pair"))


@pytest.fixture
def around(pair):
    """Points in and around the source, some beyond the map's reach."""
    return np.random.default_rng(7).uniform(-3, 3, (500, 3))


@pytest.fixture(scope="session")
def command():
    """Runs the built command."""
    program = os.environ.get("BESPOKE_COMMAND")
    if not program or not Path(program).exists():
        pytest.skip("BESPOKE_COMMAND does not name the built command")

    def run(*arguments):
        return subprocess.run(
            [program, *map(str, arguments)], check=True, capture_output=True, text=True
        ).stdout

    return run
