"""The wheel, installed where nothing else of the project is."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

PACKAGE = Path(__file__).resolve().parents[2] / "src/python"

USE = """
import json, sys, bespoke, numpy as np
carried = bespoke.Map.load(sys.argv[1])(np.load(sys.argv[2]))
np.save(sys.argv[3], carried)
libraries = {line.split()[-1] for line in open("/proc/self/maps") if ".so" in line}
print(json.dumps([bespoke.__file__, sorted(libraries)]))
"""


def run(*command, **options):
    result = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    directory = tmp_path_factory.mktemp("wheel")
    offline = ["--no-build-isolation", "--no-deps", "--no-index"]
    run(sys.executable, "-m", "pip", "wheel", *offline, "-w", directory, PACKAGE)
    (wheel,) = directory.glob("bespoke-*.whl")
    return wheel


def test_holds_what_it_needs_and_gives_the_same_bits(wheel, pair, around, tmp_path):
    environment = tmp_path / "environment"
    run(sys.executable, "-m", "venv", "--system-site-packages", environment)
    python = environment / "bin/python"
    run(python, "-m", "pip", "install", "--no-index", "--no-deps", wheel)

    pair.map.save(tmp_path / "map.vdb")
    np.save(tmp_path / "points.npy", around)
    alone = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    files = [tmp_path / name for name in ("map.vdb", "points.npy", "carried.npy")]
    where, libraries = json.loads(run(python, "-c", USE, *files, env=alone, cwd=tmp_path))
    assert Path(where).is_relative_to(environment)
    np.testing.assert_array_equal(np.load(tmp_path / "carried.npy"), pair.map(around))
    for name in ("libopenvdb.so", "libtbb.so", "libImath", "libblosc.so"):
        (loaded,) = [Path(path) for path in libraries if Path(path).name.startswith(name)]
        assert loaded.is_relative_to(environment)


def test_is_named_for_the_systems_it_runs_on(wheel):
    version = ".".join(map(str, sys.version_info[:2])).replace(".", "")
    glibc = os.confstr("CS_GNU_LIBC_VERSION").split()[1].replace(".", "_")
    assert wheel.stem.split("-")[2:] == [f"cp{version}", f"cp{version}", f"manylinux_{glibc}_{os.uname().machine}"]
