#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The study of scaling (validation/scaling) reads the seconds of each ping from what the program keeps:
ping_seconds_test.py PROGRAM"""
import pathlib
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "validation/scaling"))
from runs import Run, with_pings  # noqa: E402

with tempfile.TemporaryDirectory(prefix="tubefoot-scaling-") as folder:
    run = Run(sys.argv[1], with_pings("survey/scene.toml", 5, pathlib.Path(folder)), ["--threads", "1"])
assert len(run.pings) % 5 == 0 and (run.pings >= 0).all() and (run.pings.sum(axis=1) > 0).all(), run.pings
