#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the meshes of the survey scenes: wreck.obj (a small coaster with an open hold) and rocks.obj (a patch of rocks).

  cd scenes/survey && python3 make_meshes.py

The script needs only the standard library of Python. Its random numbers are seeded, so it writes the same files on every
machine. The repository contains the files, so the scenes do not need Python."""
import math
import random


def write_obj(name, vertices, faces, comment):
    with open(name, "w") as out:
        out.write(f"# {comment}\n")
        for v in vertices:
            out.write("v {:.3f} {:.3f} {:.3f}\n".format(*v))
        for f in faces:
            out.write("f " + " ".join(str(i + 1) for i in f) + "\n")


class Mesh:
    def __init__(self):
        self.vertices, self.faces = [], []

    def add(self, vertices, faces):
        base = len(self.vertices)
        self.vertices += vertices
        self.faces += [[base + i for i in f] for f in faces]


def hull(length, beam, depth, stations=24, ribs=6):
    """Returns a ship's hull with the bow at +y: a tapered shell up to the edge of a flat deck with an open hold."""
    mesh = Mesh()
    rows = []
    for s in range(stations + 1):
        t = s / stations
        y = (t - 0.5) * length
        taper = min(1.0, (1 - t) / 0.3) ** 0.7 * min(1.0, (t + 0.02) / 0.12) ** 0.5
        half = max(0.04, beam / 2 * taper)
        rows.append([(side * half * math.sin(a), y, depth * (1 - math.cos(a)))
                     for side in (-1, 1) for a in [math.pi / 2 * r / ribs for r in range(ribs + 1)]])
    flat = [v for row in rows for v in row]
    width = 2 * (ribs + 1)
    faces = []
    for s in range(stations):
        for side in range(2):
            for r in range(ribs):
                a = s * width + side * (ribs + 1) + r
                faces.append([a, a + 1, a + width + 1, a + width])
        # Strip of the deck between its two edges. Amidships, the hold is open.
        if not stations * 0.35 < s < stations * 0.6:
            a, b = s * width + ribs, s * width + 2 * ribs + 1
            faces.append([a, a + width, b + width, b])
    mesh.add(flat, faces)
    return mesh


def box(cx, cy, z0, sx, sy, sz):
    v = [(cx + x * sx / 2, cy + y * sy / 2, z0 + z * sz) for z in (0, 1) for y in (-1, 1) for x in (-1, 1)]
    f = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    return v, f


def mast(cx, cy, z0, radius, height, sides=8):
    ring = [(cx + radius * math.cos(2 * math.pi * k / sides), cy + radius * math.sin(2 * math.pi * k / sides))
            for k in range(sides)]
    v = [(x, y, z0) for x, y in ring] + [(x, y, z0 + height) for x, y in ring]
    f = [[k, (k + 1) % sides, sides + (k + 1) % sides, sides + k] for k in range(sides)]
    f.append([sides + k for k in range(sides)])
    return v, f


def icosphere(levels):
    g = (1 + 5 ** 0.5) / 2
    v = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g),
         (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    f = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6),
         (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10),
         (8, 6, 7), (9, 8, 1)]
    for _ in range(levels):
        middle, finer = {}, []

        def mid(a, b):
            key = (min(a, b), max(a, b))
            if key not in middle:
                middle[key] = len(v)
                v.append(tuple((p + q) / 2 for p, q in zip(v[a], v[b])))
            return middle[key]

        for a, b, c in f:
            ab, bc, ca = mid(a, b), mid(b, c), mid(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        f = finer
    return [tuple(x / math.sqrt(sum(y * y for y in p)) for x in p) for p in v], f


def rocks(seed, count, patch_radius):
    rng = random.Random(seed)
    mesh = Mesh()
    ball, faces = icosphere(1)
    for _ in range(count):
        r, a = patch_radius * math.sqrt(rng.random()), 2 * math.pi * rng.random()
        size = 0.25 + 0.9 * rng.random() ** 3
        stretch = [size * (0.7 + 0.6 * rng.random()) for _ in range(3)]
        vertices = [tuple(c * s * (0.85 + 0.3 * rng.random()) for c, s in zip(p, stretch)) for p in ball]
        turn = 2 * math.pi * rng.random()
        c, s = math.cos(turn), math.sin(turn)
        mesh.add([(r * math.cos(a) + c * x - s * y, r * math.sin(a) + s * x + c * y, z) for x, y, z in vertices], faces)
    return mesh


wreck = hull(length=26.0, beam=6.4, depth=3.4)
wreck.add(*box(0, -8.6, 3.4, 4.2, 4.4, 2.2))   # bridge
wreck.add(*box(0, -9.4, 5.6, 2.6, 2.4, 1.6))   # wheelhouse
wreck.add(*mast(0, 5.2, 3.4, 0.18, 4.5))
wreck.add(*mast(0, -10.6, 5.6, 0.45, 2.4))     # funnel
write_obj("wreck.obj", wreck.vertices, wreck.faces, "a 26 m coaster, keel at z = 0, bow at +y; make_meshes.py")
patch = rocks(seed=11, count=45, patch_radius=7.0)
write_obj("rocks.obj", patch.vertices, patch.faces, "a patch of 45 rocks about the origin; make_meshes.py")
