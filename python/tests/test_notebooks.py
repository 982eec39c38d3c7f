# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the notebooks of docs/examples/notebooks, and checks what they claim."""

import json

import numpy as np
import pytest

from conftest import SOURCES

matplotlib = pytest.importorskip("matplotlib")
FOLDER = SOURCES / "docs/examples/notebooks"


def run_notebook(name):
    """Returns the variables of a notebook after all its cells."""
    matplotlib.use("Agg")
    variables = {"__name__": "__main__"}
    for number, cell in enumerate(json.loads((FOLDER / name).read_text())["cells"]):
        if cell["cell_type"] == "code":
            exec(compile("".join(cell["source"]), f"{name}, cell {number}", "exec"), variables)
    return variables


def test_pose_and_mounting_reach_the_cramer_rao_bound():
    found = run_notebook("pose-from-sonar-images.ipynb")
    for ratio, (low, high) in (found["pose_test"], found["mounting_test"]):
        assert low < ratio < high
    assert len(found["pose_errors"]) == len(found["mounting_errors"]) == 1000


def test_height_field_is_recovered():
    found = run_notebook("height-field-from-sonar-images.ipynb")
    assert found["heights"].shape == (64, 64)
    seen = found["seen"]
    before, after = (np.sqrt(np.mean((heights - found["true_heights"])[seen]**2))
                     for heights in (found["initial_heights"], found["heights"]))
    assert after < 0.25 * before


def test_measured_and_simulated_extents_agree(monkeypatch):
    pytest.importorskip("netCDF4")
    pytest.importorskip("scipy")
    monkeypatch.chdir(SOURCES)
    if not (SOURCES / "build/release/tubefoot").exists():
        pytest.skip("build/release/tubefoot does not exist")
    found = run_notebook("measured-and-simulated.ipynb")
    assert "95 % within" in found["notes"]
    known = [row for row in found["extents"] if row["quantity"] == "extent_3db" and row["overlap"]]
    assert len(known) >= 2 and all(row["overlap"] == "yes" for row in known)
