#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes bowl.obj: a spherical cap of radius 2.5 m, 1.5 m deep, open upwards, its rim at z = 0.

Plain Python, no packages: the same file on every machine. Run in this folder; the result is kept in the repository."""
import math

RADIUS, DEPTH, RINGS, SECTORS = 2.5, 1.5, 24, 72

half_angle = math.acos(1 - DEPTH / RADIUS)
vertices, faces = [(0.0, 0.0, -DEPTH)], []
for ring in range(1, RINGS + 1):
    angle = half_angle * ring / RINGS
    for sector in range(SECTORS):
        turn = 2 * math.pi * sector / SECTORS
        r = RADIUS * math.sin(angle)
        vertices.append((r * math.cos(turn), r * math.sin(turn), RADIUS - DEPTH - RADIUS * math.cos(angle)))
for sector in range(SECTORS):
    faces.append((0, 1 + sector, 1 + (sector + 1) % SECTORS))
for ring in range(1, RINGS):
    for sector in range(SECTORS):
        a, b = 1 + (ring - 1) * SECTORS + sector, 1 + (ring - 1) * SECTORS + (sector + 1) % SECTORS
        c, d = a + SECTORS, b + SECTORS
        faces += [(a, c, d), (a, d, b)]
with open("bowl.obj", "w") as out:
    out.write("# Spherical cap of radius 2.5 m, 1.5 m deep; written by make_bowl.py\n")
    for v in vertices:
        out.write("v {:.5f} {:.5f} {:.5f}\n".format(*v))
    for f in faces:
        out.write("f {} {} {}\n".format(*(i + 1 for i in f)))
