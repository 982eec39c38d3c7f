# SPDX-License-Identifier: GPL-3.0-or-later
"""The assumed configuration: the patch test of docs/examples/patch-test, and recorded poses in memory and in files."""

import importlib.util

import numpy as np
import pytest

import tubefoot
from conftest import SOURCES


@pytest.fixture(scope="module")
def patch_test():
    spec = importlib.util.spec_from_file_location("patch_test", SOURCES / "docs/examples/patch-test/patch_test.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("planted", [
    {"latency_s": 0.25, "pitch_deg": -0.8, "roll_deg": 1.3, "heading_deg": 0.7},
    {"latency_s": -0.15, "pitch_deg": 1.1, "roll_deg": -0.6, "heading_deg": -1.4},
    {"latency_s": 0.0, "pitch_deg": 0.0, "roll_deg": 0.0, "heading_deg": 0.0},
])
def test_patch_test_recovers_planted_errors(patch_test, planted):
    found = patch_test.patch_test(planted)
    assert found["latency_s"] == pytest.approx(planted["latency_s"], abs=0.02)
    assert found["pitch_deg"] == pytest.approx(planted["pitch_deg"], abs=0.1)
    assert found["roll_deg"] == pytest.approx(planted["roll_deg"], abs=0.02)
    assert found["heading_deg"] == pytest.approx(planted["heading_deg"], abs=0.1)


def test_recorded_poses_are_in_the_file_and_not_in_the_truth(patch_test, tmp_path):
    errors = {"latency_s": 0.5, "pitch_deg": 2, "roll_deg": 3, "heading_deg": 4}
    line = {"north": (0.0, 1, 2.0)}
    result = tubefoot.run(patch_test.scene(errors, 0, line), output=tmp_path / "out")["north"]
    stored = tubefoot.open(tmp_path / "out")["north"]
    for sensor in (result, stored):
        data = sensor.to_xarray()
        np.testing.assert_allclose(data.recorded_sensor_position - data.sensor_position, [[0, -1, 0]] * 9, atol=1e-9)
        for angle, error in ("heading", 4), ("pitch", 2), ("roll", 3):
            np.testing.assert_allclose(data[f"recorded_sensor_{angle}"] - data[f"sensor_{angle}"], error, atol=1e-9)
