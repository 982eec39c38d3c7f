# SPDX-License-Identifier: GPL-3.0-or-later
"""A small scene as a file and in code, and the program."""

import copy
import os
import pathlib
import subprocess

import numpy as np
import pytest

import tubefoot

PROGRAM = os.environ["TUBEFOOT_PROGRAM"]
SOURCES = pathlib.Path(os.environ["TUBEFOOT_SOURCE_DIR"])

TETRAHEDRON = "v 0 3 0\nv 1 3 0\nv 0 4 0\nv 0 3 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
VERTICES = np.array([[0, 3, 0], [1, 3, 0], [0, 4, 0], [0, 3, 1]], float)
FACETS = np.array([[1, 3, 2], [1, 2, 4], [2, 3, 4], [3, 1, 4]]) - 1

SCENE = """title = "A tetrahedron"
[water]
sound_speed_m_s = 1500
absorption_db_per_km = 400
[[materials]]
name = "sand"
[[materials]]
name = "steel"
lambert_db = -10
[[terrain]]
kind = "flat"
width_m = 20
length_m = 30
material = "sand"
[[objects]]
name = "thing"
shape = "mesh"
file = "thing.obj"
material = "steel"
[[trajectories]]
kind = "line"
start_m = [0, 0, 2]
end_m = [0, 1, 2]
[[sensors]]
name = "camera"
kind = "didson"
beams = 8
horizontal_deg = 16
tilt_deg = 30
samples = 64
pings = 3
ping_interval_s = 0.2
[[sensors]]
name = "side"
kind = "sidescan"
samples = 100
range_max_m = 12
pings = 2
ping_interval_s = 0.3
"""

KEYS = {
    "title": "A tetrahedron",
    "water": {"sound_speed_m_s": 1500, "absorption_db_per_km": 400},
    "materials": [{"name": "sand"}, {"name": "steel", "lambert_db": -10}],
    "terrain": {"kind": "flat", "width_m": 20, "length_m": 30, "material": "sand"},
    "objects": [{"name": "thing", "shape": "mesh", "file": "thing.obj", "material": "steel"}],
    "trajectories": [{"kind": "line", "start_m": [0, 0, 2], "end_m": np.array([0, 1, 2])}],
    "sensors": [
        {"name": "camera", "kind": "didson", "beams": 8, "horizontal_deg": 16, "tilt_deg": 30, "samples": 64,
         "pings": 3, "ping_interval_s": 0.2},
        {"name": "side", "kind": "sidescan", "samples": 100, "range_max_m": np.float64(12), "pings": 2,
         "ping_interval_s": 0.3},
    ],
}


@pytest.fixture
def keys():
    return copy.deepcopy(KEYS)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE)
    (tmp_path / "thing.obj").write_text(TETRAHEDRON)
    return tmp_path


@pytest.fixture
def scene(folder):
    return tubefoot.load(folder / "scene.toml")


@pytest.fixture
def program():
    """Runs the program; with `fails` its code must not be 0 and what it says is returned."""
    def run(*arguments, fails=False):
        done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
        assert (done.returncode != 0) == fails, done.stderr
        return done.stderr.strip() if fails else done.stdout
    return run


def equal_energies(a, b):
    """Bit by bit, all sensors."""
    return list(a) == list(b) and all(a[s].energy.tobytes() == b[s].energy.tobytes() for s in a)
