#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes cornice.obj next to this file: a narrow strip near the upper edge of the fan, 4.01 m from the sonar of scene.toml."""
import math
import pathlib

RANGE_M, LOWER_DEG, UPPER_DEG, HALF_FAN_DEG, STEPS = 4.01, 8.4, 9.4, 30, 48
lines = ["# Written by make_mesh.py."]
for step in range(STEPS + 1):
    azimuth = math.radians((2 * step / STEPS - 1) * HALF_FAN_DEG)
    for elevation in map(math.radians, (LOWER_DEG, UPPER_DEG)):
        lines.append("v %.6f %.6f %.6f" % (RANGE_M * math.sin(azimuth) * math.cos(elevation),
                                           RANGE_M * math.cos(azimuth) * math.cos(elevation), RANGE_M * math.sin(elevation)))
for step in range(STEPS):
    a = 2 * step + 1  # lower and upper point on the port side, then on the starboard side
    lines += [f"f {a} {a + 2} {a + 1}", f"f {a + 1} {a + 2} {a + 3}"]
(pathlib.Path(__file__).parent / "cornice.obj").write_text("\n".join(lines) + "\n")
