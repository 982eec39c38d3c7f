#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the ray engine of tubefoot on a suite: tubefoot_rays.py PROGRAM SUITE RESULTS RAYS_PER_BEAM

RESULTS gets NAME.nc for each scene that the engine supports. The rejected scenes are printed with their reasons."""
import pathlib
import shutil
import subprocess
import sys
import tempfile


def main():
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    program, suite, results, rays = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3]), sys.argv[4]
    results.mkdir(parents=True, exist_ok=True)
    for scene in sorted((suite / "scenes").iterdir()):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([program, "run", scene / "scene.toml", "-o", f"{folder}/out", "--engine", "ray", "--rays-per-beam",
                                   rays, "--quiet", "--pictures", "none"], capture_output=True, text=True)
            if done.returncode:
                print(f"{scene.name}: {done.stderr.strip()}")
            else:
                shutil.copyfile(f"{folder}/out/echoes.nc", results / f"{scene.name}.nc")


if __name__ == "__main__":
    main()
