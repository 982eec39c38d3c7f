#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes bowl.obj: half a sphere of radius 1 m, a shell without thickness, its rim in the plane y = 0, open towards -y.

Plain Python, no packages: the same file on every machine. Run in this folder; the result is kept in the repository."""
import math

RINGS, SECTORS = 10, 32

vertices, faces = [(0.0, 1.0, 0.0)], []
for ring in range(1, RINGS + 1):
    angle = math.pi / 2 * ring / RINGS
    for sector in range(SECTORS):
        turn = 2 * math.pi * sector / SECTORS
        r = math.sin(angle)
        vertices.append((r * math.cos(turn), math.cos(angle), r * math.sin(turn)))
for sector in range(SECTORS):
    faces.append((0, 1 + sector, 1 + (sector + 1) % SECTORS))
for ring in range(1, RINGS):
    for sector in range(SECTORS):
        a, b = 1 + (ring - 1) * SECTORS + sector, 1 + (ring - 1) * SECTORS + (sector + 1) % SECTORS
        c, d = a + SECTORS, b + SECTORS
        faces += [(a, c, d), (a, d, b)]
with open("bowl.obj", "w") as out:
    out.write("# Half a sphere of radius 1 m; written by make_bowl.py\n")
    for v in vertices:
        out.write("v {:.5f} {:.5f} {:.5f}\n".format(*v))
    for f in faces:
        out.write("f {} {} {}\n".format(*(i + 1 for i in f)))
