#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""on_demand_test.py PROGRAM SOURCES: the program starts with few shared libraries. It loads those of pictures, rasters and
echo files when a command needs them, and reports one that cannot be loaded."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

PROGRAM, SOURCES = sys.argv[1], pathlib.Path(sys.argv[2])
SCENE, TERRAIN = (SOURCES / "scenes/chart" / name for name in ("sphere-on-plane.toml", "rough-terrain.toml"))  # the second reads a raster
MOST_AT_START = 40
PICTURES, DRAWINGS, RASTERS, ECHOES = "libOpenImageIO.so", "librsvg-2.so", "libgdal.so", "libnetcdf.so"
wrong = []


def hold(true, words):
    if not true:
        wrong.append(words)


def outcome(*arguments, **environment):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, env={**os.environ, **environment})


def loaded(*arguments):
    """The shared libraries that are in memory when a command ends."""
    with tempfile.TemporaryDirectory() as scratch:
        done = outcome(*arguments, LD_DEBUG="files", LD_DEBUG_OUTPUT=scratch + "/log")
        hold(done.returncode == 0, f"{arguments}: {done.stderr}")
        (log,) = pathlib.Path(scratch).iterdir()
        return {pathlib.Path(name).name for name in re.findall(r"calling init: (.*)", log.read_text())}


with tempfile.TemporaryDirectory() as scratch:
    folder = pathlib.Path(scratch)
    run = ["run", SCENE, "--engine", "ray", "--rays", "500", "--quiet", "-o"]

    at_start = loaded("--help")
    hold(len(at_start) <= MOST_AT_START, f"--help loads {len(at_start)} shared libraries, expected at most {MOST_AT_START}")
    for words in (["--help"], ["presets"], ["check", SCENE], [*run, folder / "plain", "--pictures", "none"]):
        libraries = loaded(*words)
        for name in (PICTURES, DRAWINGS, RASTERS, *([] if "run" in words else [ECHOES])):
            hold(not any(library.startswith(name) for library in libraries), f"{words} loads {name}")
    on_demand = loaded(*run, folder / "drawn") | loaded("check", TERRAIN)
    hold((folder / "drawn/echoes.nc").read_bytes() == (folder / "plain/echoes.nc").read_bytes(),
         "energies depend on the loaded libraries")

    # A file of this name that is no library, which the dynamic linker finds first.
    for name, words in ((PICTURES, [*run, folder / "no-pictures"]), (DRAWINGS, [*run, folder / "no-drawings"]),
                        (RASTERS, ["check", TERRAIN]), (ECHOES, [*run, folder / "no-echoes"])):
        broken = folder / f"without-{name}"
        broken.mkdir()
        file = next(library for library in on_demand if library.startswith(name))
        (broken / file).touch()
        hold(outcome("--help", LD_LIBRARY_PATH=str(broken)).returncode == 0, f"--help needs {name}")
        done = outcome(*words, LD_LIBRARY_PATH=str(broken))
        hold(done.returncode == 1, f"without {name} {words} ends with {done.returncode}")
        expected = rf"^tubefoot: cannot load a shared library: \S*{re.escape(file)}: .*: install \S+"
        hold(re.search(expected, done.stderr, re.M), f"without {name}: {done.stderr}")

print("\n".join(wrong) or f"the program starts with {len(at_start)} shared libraries and loads the others on demand")
sys.exit(bool(wrong))
