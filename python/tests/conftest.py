# SPDX-License-Identifier: GPL-3.0-or-later
"""A small scene as a file and in code, and the program."""

import copy
import os
import pathlib
import struct
import subprocess
import zlib

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


def said_by(*arguments):
    """What the program says on stderr, one entry a line."""
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=True)
    return done.stderr.splitlines()


def png_pixels(data):
    """Pixels of an RGB PNG, (height, width, 3) in its own depth, read from the specification."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    place, packed = 8, b""
    while place < len(data):
        length, kind = struct.unpack(">I4s", data[place:place + 8])
        body = data[place + 8:place + 8 + length]
        assert struct.unpack(">I", data[place + 8 + length:place + 12 + length])[0] == zlib.crc32(kind + body)
        if kind == b"IHDR":
            width, height, bits, colours, *rest = struct.unpack(">IIBBBBB", body)
            assert (colours, rest) == (2, [0, 0, 0])
        packed += body if kind == b"IDAT" else b""
        place += 12 + length
    step = 3 * bits // 8
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + width * step)
    above = np.zeros(width * step, int)
    pixels = []
    for how, *row in rows.astype(int).tolist():
        for i in range(len(row)):
            left, corner = (row[i - step], int(above[i - step])) if i >= step else (0, 0)
            up = int(above[i])
            guess = left + up - corner
            by = (abs(guess - left), abs(guess - up), abs(guess - corner))
            row[i] = (row[i] + (0, left, up, (left + up) // 2, (left, up, corner)[by.index(min(by))])[how]) & 255
        above = np.array(row)
        pixels.append(np.array(row, np.uint8))
    return np.array(pixels).reshape(-1).view(">u2" if bits == 16 else np.uint8).reshape(height, width, 3)
