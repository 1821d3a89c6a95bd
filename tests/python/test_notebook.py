"""The notebook of samples/python, run as its page says."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

NOTEBOOK = Path(__file__).parents[2] / "samples" / "python" / "dress.ipynb"


def cells(path):
    return json.loads(path.read_text())["cells"]


def test_runs_and_draws_every_plot(tmp_path):
    # Here, for pytest fails a run whose modules are all skipped.
    for module in ("nbconvert", "ipykernel", "matplotlib"):
        pytest.importorskip(module, reason=f"{module} is not installed: tools/setup --viewers")
    command = os.environ["BESPOKE_COMMAND"]
    subprocess.run([command, "samples", tmp_path, "dress", "--quiet"], check=True)
    shutil.copy(NOTEBOOK, tmp_path)
    convert = [sys.executable, "-m", "nbconvert", "--execute", "--to", "notebook", "--output", "run", NOTEBOOK.name]
    run = subprocess.run(
        convert, cwd=tmp_path, env=os.environ | {"BESPOKE_MODELS": str(tmp_path)}, capture_output=True, text=True
    )
    assert run.returncode == 0, run.stderr
    outputs = [output for cell in cells(tmp_path / "run.ipynb") for output in cell.get("outputs", ())]
    pictures = [output["data"]["image/png"] for output in outputs if "image/png" in output.get("data", {})]
    assert len(pictures) == sum("plt.show()" in "".join(cell["source"]) for cell in cells(NOTEBOOK)) == 5
    assert "bijection: True" in "".join("".join(output.get("text", "")) for output in outputs)


def test_stands_in_the_repository_without_outputs():
    code = [cell for cell in cells(NOTEBOOK) if cell["cell_type"] == "code"]
    assert code and all(not cell["outputs"] and cell["execution_count"] is None for cell in code)
