#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes rough-terrain.asc, the terrain of the benchmarks (validation/bench/terrain.cpp) for N = 200, as an ESRI ASCII grid.

  cd scenes/chart && python3 make_terrain.py

The terrain covers 20 m x 20 m in cells of 0.1 m. It has smooth relief of about half a metre and white roughness of a
fifth of the cell size. The script needs only the standard library of Python, and the repository contains its output."""
import math

N, EXTENT = 200, 20.0
CELL = EXTENT / N
MASK = (1 << 64) - 1


def mix(x):
    x ^= x >> 30
    x = x * 0xBF58476D1CE4E5B9 & MASK
    x ^= x >> 27
    x = x * 0x94D049BB133111EB & MASK
    return x ^ (x >> 31)


def normal(i, j):
    h = mix(mix(i * 0x9E3779B97F4A7C15 + 1 & MASK) + j & MASK)
    u = ((h >> 11) + 0.5) * 2.0**-53
    v = (mix(h) >> 11) * 2.0**-53
    return math.sqrt(-2 * math.log(u)) * math.cos(6.283185307179586 * v)


def relief(x, y):
    return 0.3 * math.sin(1.3 * x + 0.9 * y) + 0.25 * math.cos(1.9 * y - 0.7 * x + 1) + 0.2 * math.sin(0.5 * x - 2.7 * y)


with open("rough-terrain.asc", "w") as out:
    out.write("ncols {0}\nnrows {0}\nxllcenter {1}\nyllcenter 0\ncellsize {2}\n".format(N + 1, -EXTENT / 2, CELL))
    for j in range(N, -1, -1):
        row = [relief(i * CELL - EXTENT / 2, j * CELL) + 0.2 * CELL * normal(i, j) for i in range(N + 1)]
        out.write(" ".join("{:.5f}".format(z) for z in row) + "\n")
