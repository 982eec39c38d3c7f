#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the bowls of the scenes as spherical caps without thickness: python3 scenes/make_bowl.py

  chart/bowl.obj  radius 2.5 m, 1.5 m deep, open upwards, with the rim at z = 0
  paths/bowl.obj  half a sphere of radius 1 m, open towards -y, with the rim in the plane y = 0

The script needs only the standard library of Python and writes the same files on every machine. The repository contains
the files."""
import math
import pathlib


def write(file, what, radius, depth, rings, sectors, place):
    """Writes a bowl. `place` maps points of a bowl that is open upwards, with its rim at z = 0, to the wanted position."""
    half_angle = math.acos(1 - depth / radius)
    vertices, faces = [(0.0, 0.0, -depth)], []
    for ring in range(1, rings + 1):
        angle = half_angle * ring / rings
        for sector in range(sectors):
            turn = 2 * math.pi * sector / sectors
            r = radius * math.sin(angle)
            vertices.append((r * math.cos(turn), r * math.sin(turn), radius - depth - radius * math.cos(angle)))
    for sector in range(sectors):
        faces.append((0, 1 + sector, 1 + (sector + 1) % sectors))
    for ring in range(1, rings):
        for sector in range(sectors):
            a, b = 1 + (ring - 1) * sectors + sector, 1 + (ring - 1) * sectors + (sector + 1) % sectors
            c, d = a + sectors, b + sectors
            faces += [(a, c, d), (a, d, b)]
    with open(pathlib.Path(__file__).parent / file, "w") as out:
        out.write("# {}; written by make_bowl.py\n".format(what))
        for v in vertices:
            out.write("v {:.5f} {:.5f} {:.5f}\n".format(*place(*v)))
        for f in faces:
            out.write("f {} {} {}\n".format(*(i + 1 for i in f)))


write("chart/bowl.obj", "Spherical cap of radius 2.5 m, 1.5 m deep", 2.5, 1.5, 24, 72, lambda x, y, z: (x, y, z))
write("paths/bowl.obj", "Half a sphere of radius 1 m", 1.0, 1.0, 10, 32, lambda x, y, z: (x, -z, y))
