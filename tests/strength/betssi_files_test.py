#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the files of scenes/betssi with what its scripts write: betssi_files_test.py models|tables

The tables need the source code of ASIGA in the folder that the environment variable TUBEFOOT_ASIGA names. Without it, the
test is skipped with exit code 77."""
import os
import pathlib
import subprocess
import sys
import tempfile

SCENES = pathlib.Path(__file__).resolve().parents[2] / "scenes/betssi"


def run(script, *arguments):
    return subprocess.run([sys.executable, SCENES / script, *arguments], capture_output=True, text=True)


def check(condition, message):
    if not condition:
        sys.exit(f"FAILED {message}")


def same_files(folder, suffix):
    for model in ("m3", "m5a", "m5b"):
        name = f"{model}.{suffix}"
        check((folder / name).read_bytes() == (SCENES / name).read_bytes(), f"{name} differs from the file of the repository")


def models(folder):
    outcome = run("make_models.py", "-o", folder)
    check(outcome.returncode == 0, outcome.stderr)
    same_files(folder, "obj")
    for wrong in ("0", "-1", "nan", "1e9", "x"):
        outcome = run("make_models.py", "-o", folder, "--refine", wrong)
        check(outcome.returncode == 2 and "--refine" in outcome.stderr, f"--refine {wrong} was accepted")


def tables(folder):
    outcome = run("make_tables.py", folder, "-o", folder)
    check(outcome.returncode == 2 and "expected the source code of ASIGA" in outcome.stderr, "an empty folder was accepted")
    source = os.environ.get("TUBEFOOT_ASIGA")
    if not source:
        print("Skipped: TUBEFOOT_ASIGA names no folder with the source code of ASIGA")
        sys.exit(77)
    outcome = run("make_tables.py", source, "-o", folder)
    check(outcome.returncode == 0, outcome.stderr)
    same_files(folder, "csv")


def main():
    if sys.argv[1:] not in (["models"], ["tables"]):
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        {"models": models, "tables": tables}[sys.argv[1]](pathlib.Path(folder))


if __name__ == "__main__":
    main()
