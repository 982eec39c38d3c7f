#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes wellhead.obj, a subsea well head with its guide base, as one mesh of named groups.

  python3 scenes/wellhead/make_wellhead.py

The script needs only the standard library of Python and writes the same file on every machine. The repository contains
the file, so the scenes do not need Python. The origin is on the axis of the conductor at the seabed. The z axis points
up, and coordinates are in metres."""
import math
import pathlib


class Mesh:
    def __init__(self):
        self.lines, self.vertices = [], 0

    def group(self, name):
        self.lines.append("g " + name)

    def add(self, vertices, faces):
        """Adds faces of indices into `vertices`, from 0. Vertices are counter-clockwise as seen from outside."""
        self.lines += ["v {:.4f} {:.4f} {:.4f}".format(*v) for v in vertices]
        self.lines += ["f " + " ".join(str(self.vertices + i + 1) for i in f) for f in faces]
        self.vertices += len(vertices)

    def box(self, low, high):
        corners = [(x, y, z) for z in (low[2], high[2]) for y in (low[1], high[1]) for x in (low[0], high[0])]
        self.add(corners, [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6)])

    def turned(self, profile, sectors, place=(0.0, 0.0), closed=False):
        """Adds a surface of revolution about a vertical axis. The profile lists (radius, height) and goes up on the outside.
        A disc closes each end, unless the profile itself is closed."""
        rings = [[(place[0] + r * math.cos(2 * math.pi * s / sectors), place[1] + r * math.sin(2 * math.pi * s / sectors), z)
                  for s in range(sectors)] for r, z in profile]
        vertices = [v for ring in rings for v in ring]
        faces = []
        pairs = list(zip(range(len(profile)), range(1, len(profile)))) + ([(len(profile) - 1, 0)] if closed else [])
        for a, b in pairs:
            for s in range(sectors):
                t = (s + 1) % sectors
                faces.append((a * sectors + s, a * sectors + t, b * sectors + t, b * sectors + s))
        if not closed:
            faces.append(tuple(range(sectors - 1, -1, -1)))
            faces.append(tuple((len(profile) - 1) * sectors + s for s in range(sectors)))
        self.add(vertices, faces)

    def pipe(self, path, radius, sectors):
        """Adds a pipe along a path in a plane of constant y, closed at both ends."""
        rings = []
        for k, (x, y, z) in enumerate(path):
            before, after = path[max(k - 1, 0)], path[min(k + 1, len(path) - 1)]
            dx, dz = after[0] - before[0], after[2] - before[2]
            length = math.hypot(dx, dz)
            nx, nz = -dz / length, dx / length  # across the path, in its plane
            rings.append([(x + radius * math.cos(a) * nx, y + radius * math.sin(a), z + radius * math.cos(a) * nz)
                          for a in [2 * math.pi * s / sectors for s in range(sectors)]])
        vertices = [v for ring in rings for v in ring]
        faces = []
        for a in range(len(path) - 1):
            for s in range(sectors):
                t = (s + 1) % sectors
                faces.append((a * sectors + s, (a + 1) * sectors + s, (a + 1) * sectors + t, a * sectors + t))
        faces.append(tuple(range(sectors)))
        faces.append(tuple((len(path) - 1) * sectors + s for s in range(sectors - 1, -1, -1)))
        self.add(vertices, faces)


mesh = Mesh()

mesh.group("guide_base")
for y in (-0.85, 0.71):
    mesh.box((-0.85, y, -0.05), (0.85, y + 0.14, 0.14))
for x in (-0.85, 0.71):
    mesh.box((x, -0.71, -0.05), (x + 0.14, 0.71, 0.14))
for x, y in ((0.3, -0.05), (-0.71, -0.05)):  # struts to the conductor
    mesh.box((x, y, 0.0), (x + 0.41, y + 0.1, 0.1))

mesh.group("guide_posts")
for x in (-0.78, 0.78):
    for y in (-0.78, 0.78):
        mesh.turned([(0.06, 0.1), (0.06, 1.25), (0.02, 1.36)], 16, (x, y))

mesh.group("well_head")  # conductor, flange, housing, connector grooves, socket that is open at the top
mesh.turned([(0.38, -0.2), (0.38, 0.48), (0.48, 0.50), (0.48, 0.57), (0.38, 0.59), (0.30, 0.66), (0.30, 0.80), (0.34, 0.82),
             (0.34, 0.87), (0.30, 0.89), (0.30, 1.02), (0.34, 1.04), (0.34, 1.12), (0.26, 1.14), (0.22, 1.14), (0.22, 0.85),
             (0.05, 0.80)], 40)

mesh.group("valves")
mesh.box((0.42, -0.22, 0.20), (0.62, 0.22, 0.56))  # block
for y in (-0.12, 0.12):
    mesh.turned([(0.05, 0.56), (0.05, 0.64), (0.11, 0.66), (0.11, 0.69), (0.03, 0.71)], 16, (0.52, y))  # hand wheels

mesh.group("jumper")  # a pipe from the block to the seabed
arc = [math.pi / 2 * k / 8 for k in range(9)]
mesh.pipe([(0.62, 0.0, 0.40)] + [(0.95 + 0.35 * math.sin(a), 0.0, 0.05 + 0.35 * math.cos(a)) for a in arc] + [(1.30, 0.0, -0.1)],
          0.05, 12)

with open(pathlib.Path(__file__).parent / "wellhead.obj", "w") as out:
    out.write("# A subsea well head on its guide base; written by make_wellhead.py\n")
    out.write("\n".join(mesh.lines) + "\n")
