#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the meshes of this pack as OBJ files beside their scenes. Plain Python, no packages.

Every coordinate is a multiple of 2^-10 m and printed in full: whoever reads the files has the scene itself, not a
rounding of it, and the same files come from every machine. They are kept in the repository; run this only to see how
they were made."""
import math
import pathlib

HERE = pathlib.Path(__file__).resolve().parent
MASK = (1 << 64) - 1


def snap(x):
    return round(x * 1024) / 1024


def write(file, about, vertices, faces):
    with open(HERE / file, "w", newline="\n") as out:
        out.write(f"# {about}\n")
        for v in vertices:
            out.write("v " + " ".join(f"{x + 0.0:.10f}".rstrip("0").rstrip(".") for x in map(snap, v)) + "\n")
        for f in faces:
            out.write("f " + " ".join(str(k + 1) for k in f) + "\n")


def bed(file, half):
    write(file, f"Horizontal square of {2 * half} m at z = 0",
          [(-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)], [(0, 1, 2), (0, 2, 3)])


def box(size, centre, turn_deg):
    """Eight corners, twelve outward triangles; turned clockwise seen from above."""
    c, s = math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))
    corners = [(x * size[0] / 2, y * size[1] / 2, z * size[2] / 2) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    vertices = [(centre[0] + c * x + s * y, centre[1] - s * x + c * y, centre[2] + z) for x, y, z in corners]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return vertices, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def sphere(radius, centre, rings, sectors):
    """Parallels and meridians."""
    vertices, faces = [(centre[0], centre[1], centre[2] - radius)], []
    for ring in range(1, rings):
        polar = math.pi * ring / rings
        for sector in range(sectors):
            turn = 2 * math.pi * sector / sectors
            vertices.append((centre[0] + radius * math.sin(polar) * math.cos(turn),
                             centre[1] + radius * math.sin(polar) * math.sin(turn),
                             centre[2] - radius * math.cos(polar)))
    vertices.append((centre[0], centre[1], centre[2] + radius))
    top = len(vertices) - 1
    for sector in range(sectors):
        following = (sector + 1) % sectors
        faces += [(0, 1 + following, 1 + sector), (top, top - sectors + sector, top - sectors + following)]
        for ring in range(rings - 2):
            a, b = 1 + ring * sectors + sector, 1 + ring * sectors + following
            faces += [(a, b, b + sectors), (a, b + sectors, a + sectors)]
    return vertices, faces


def bowl(radius, depth, rings, sectors):
    """Spherical cap, open upwards, its rim at z = 0."""
    half_angle = math.acos(1 - depth / radius)
    vertices, faces = [(0, 0, -depth)], []
    for ring in range(1, rings + 1):
        polar = half_angle * ring / rings
        for sector in range(sectors):
            turn = 2 * math.pi * sector / sectors
            vertices.append((radius * math.sin(polar) * math.cos(turn), radius * math.sin(polar) * math.sin(turn),
                             radius - depth - radius * math.cos(polar)))
    for sector in range(sectors):
        following = (sector + 1) % sectors
        faces.append((0, 1 + sector, 1 + following))
        for ring in range(rings - 1):
            a, b = 1 + ring * sectors + sector, 1 + ring * sectors + following
            faces += [(a, a + sectors, b + sectors), (a, b + sectors, b)]
    return vertices, faces


def white(i, j):
    """Pseudo-random number of a grid point, -1 to 1 (the mixer of SplitMix64)."""
    x = (i * 0x9E3779B97F4A7C15 + j * 0xD1B54A32D192ED03 + 1) & MASK
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):
        x = (x ^ (x >> shift)) * factor & MASK
    return ((x ^ (x >> 31)) >> 11) * 2.0**-52 - 1


def terrain(columns, rows, cell, south):
    def height(i, j):
        x, y = (i - columns / 2) * cell, south + j * cell
        return (0.15 * math.sin(1.3 * x + 0.9 * y) + 0.12 * math.cos(1.9 * y - 0.7 * x + 1) +
                0.1 * math.sin(0.5 * x - 2.7 * y) + 0.03 * white(i, j))
    vertices = [((i - columns / 2) * cell, south + j * cell, height(i, j))
                for j in range(rows + 1) for i in range(columns + 1)]
    faces = []
    for j in range(rows):
        for i in range(columns):
            a = j * (columns + 1) + i
            b, c, d = a + 1, a + columns + 2, a + columns + 1
            faces += [(a, b, c), (a, c, d)]
    return vertices, faces


bed("flat-bed/bed.obj", 16)
bed("absorbing-bed/bed.obj", 16)
bed("sphere/bed.obj", 16)
bed("box-and-wall/bed.obj", 16)
write("sphere/sphere.obj", "Sphere of radius 0.75 m that touches z = 0", *sphere(0.75, (0, 0, 0.75), 32, 64))
write("box-and-wall/box.obj", "Box of 1.25 m x 0.75 m x 0.625 m on z = 0",
      *box((1.25, 0.75, 0.625), (-0.875, -1, 0.3125), 20))
write("box-and-wall/wall.obj", "Wall of 2 m x 1/32 m x 0.75 m on z = 0",
      *box((2, 0.03125, 0.75), (0.75, 0.75, 0.375), -25))
write("bowl/bowl.obj", "Spherical cap of radius 2.5 m, 1.5 m deep, rim at z = 0", *bowl(2.5, 1.5, 24, 72))
write("terrain/terrain.obj", "Rough bed of 8 m x 10 m in cells of 1/8 m", *terrain(64, 80, 0.125, 2.0))
