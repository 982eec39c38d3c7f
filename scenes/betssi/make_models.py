#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the BeTSSi models M3, M5A and M5B as closed meshes in metres: make_models.py [-o FOLDER] [--refine N]

  m3.obj   frustum of a cone of 41 m along x, with half spheres of radius 3 m (towards +x) and 5 m at its ends
  m5a.obj  two cylinders of radius 0.3 m and length 4.8 m along x, 1 m apart along z
  m5b.obj  the same cylinders along z, 1 m apart along x

--refine N divides the chord error (1 mm for M3, 0.1 mm for M5A and M5B) by N. The script needs only the standard library of
Python and writes the same files on every machine. Without options it writes the files of the repository."""
import argparse
import math
import pathlib


def outer(half_angle):
    """Radius of the corners of a regular polygon whose mean distance from the centre is 1.

    Each side spans twice the half angle. The corners deviate from the circle of radius 1 more than any other point."""
    return half_angle / (math.cos(half_angle) * math.asinh(math.tan(half_angle)))


def parts(angle, radius, chord_error):
    """Number of sides of equal angle that keep the chord error."""
    count = 1
    while angle / count > math.pi / 2 or radius * (outer(angle / count / 2) - 1) > chord_error:
        count += 1
    return count


def quarter(radius, centre, sign, chord_error):
    """Profile of a half sphere from its rim, without the rim, to the pole: (position on the axis, radius)."""
    count = parts(math.pi / 2, radius, chord_error)
    corner = radius * outer(math.pi / 4 / count)
    angles = [math.pi / 2 * k / count for k in range(1, count + 1)]
    return [(centre + sign * corner * math.sin(a), corner * math.cos(a) if a < math.pi / 2 else 0) for a in angles]


def revolved(profile, radius, chord_error):
    """Closed surface of a profile that begins and ends on the axis, which is x. Faces are counter-clockwise from outside."""
    sectors = 4 * parts(math.pi / 2, radius, chord_error)  # a multiple of 4, for mirror symmetry in y and z
    corner = outer(math.pi / sectors)
    vertices, rings, faces = [], [], []
    for along, r in profile:
        count = sectors if r > 0 else 1
        rings.append([len(vertices) + k % count for k in range(sectors + 1)])
        for k in range(count):
            turn = 2 * math.pi * k / sectors
            vertices.append((along, corner * r * math.cos(turn), corner * r * math.sin(turn)))
    for low, high in zip(rings, rings[1:]):
        for k in range(sectors):
            for face in ((low[k], high[k + 1], high[k]), (low[k], low[k + 1], high[k + 1])):
                if len(set(face)) == 3:
                    faces.append(face)
    return vertices, faces


def joined(meshes):
    vertices, faces = [], []
    for more, sides in meshes:
        faces += [tuple(len(vertices) + corner for corner in face) for face in sides]
        vertices += more
    return vertices, faces


def placed(mesh, place):
    """Moves a mesh by a function that keeps its orientation."""
    return [place(*v) for v in mesh[0]], mesh[1]


def m3(chord_error):
    small, large, length = 3, 5, 41
    front = length / 2 + (large - small) / 2
    back = front - length
    profile = [*reversed(quarter(large, back, -1, chord_error)), (back, large), (front, small),
               *quarter(small, front, 1, chord_error)]
    return revolved(profile, large, chord_error)


def cylinder(chord_error):
    radius, length = 0.3, 4.8
    return revolved([(-length / 2, 0), (-length / 2, radius), (length / 2, radius), (length / 2, 0)], radius, chord_error)


def m5a(chord_error):
    return joined(placed(cylinder(chord_error), lambda x, y, z, h=h: (x, y, z + h)) for h in (-0.5, 0.5))


def m5b(chord_error):
    return joined(placed(cylinder(chord_error), lambda x, y, z, h=h: (y + h, z, x)) for h in (-0.5, 0.5))


def write(file, title, mesh):
    vertices, faces = mesh
    with open(file, "w", newline="\n") as out:
        out.write(f"# {title}, in metres; written by make_models.py\n")
        for v in vertices:
            out.write("v {:.6f} {:.6f} {:.6f}\n".format(*(x + 0.0 if abs(x) > 5e-7 else 0.0 for x in v)))
        for f in faces:
            out.write("f {} {} {}\n".format(*(corner + 1 for corner in f)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent,
                        help="folder of the meshes (default: the folder of this script)")
    parser.add_argument("--refine", type=float, default=1, help="divisor of the chord errors (default: 1)")
    options = parser.parse_args()
    if not 0.01 <= options.refine <= 1000:
        parser.error(f"--refine {options.refine:g}: expected a number from 0.01 to 1000")
    options.output.mkdir(parents=True, exist_ok=True)
    for name, chord_error, model in (("m3", 1e-3, m3), ("m5a", 1e-4, m5a), ("m5b", 1e-4, m5b)):
        chord_error /= options.refine
        write(options.output / f"{name}.obj", f"BeTSSi model {name.upper()}, chord error {1e3 * chord_error:g} mm",
              model(chord_error))


if __name__ == "__main__":
    main()
