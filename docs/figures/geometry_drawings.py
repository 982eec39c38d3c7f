# SPDX-License-Identifier: GPL-3.0-or-later
"""A beam on facets, seen from its side; axes and angles; footprints and tubes of the tutorial's scene.

Visible polygons are exact corners of `tubefoot footprints -o X.txt`, converted to doubles on drawing.
"""
import math
from fractions import Fraction

from sheet import (BLUE, FAINT, GREEN, INK, ORANGE, PURPLE, RED, SAND, SAND_EDGE, SHADOW, STEEL, WATER, Sheet, polar,
                   towards)


def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    size = math.sqrt(dot(a, a))
    return tuple(float(x) / size for x in a)


class Transmission:
    """Tubes of one transmission: axis, rays, pieces (facet, corners) and open water (directions), in rationals."""
    def __init__(self, path):
        def points(words):
            numbers = [Fraction(word) for word in words]
            return [tuple(numbers[k:k + 3]) for k in range(0, len(numbers), 3)]
        self.tubes = []
        for line in path.read_text().splitlines():
            kind, *words = line.split() if line.strip() else ["#"]
            if kind in ("transmission", "shot"):  # "shot" in version 1 of the format
                [self.apex] = points(words[2:])
            elif kind == "tube":
                axis, *rays = points(words[2:])
                self.tubes.append({"axis": axis, "rays": rays, "pieces": [], "open": []})
            elif kind == "piece":
                self.tubes[-1]["pieces"].append((int(words[0]), points(words[2:])))
            elif kind == "open":
                self.tubes[-1]["open"].append(points(words[1:]))


class Map:
    """Metres to pixels: equal scales, up is up."""
    def __init__(self, left, bottom, top, scale):
        self.left, self.top, self.scale = left, top, scale
        self.height = (top - bottom) * scale

    def __call__(self, p):
        return (float(p[0]) - self.left) * self.scale, (self.top - float(p[1])) * self.scale


BEAM_SCENE = """title = "One beam"

[[materials]]
name = "sand"
lambert_db = -20

[[terrain]]
kind = "raster"
file = "level.asc"
material = "sand"

[[objects]]
name = "box"
material = "sand"
shape = "box"
size_m = [0.8, 0.8, 0.7]
position_m = [0.15, 6.2, 0.35]
heading_deg = 24

[trajectory]
kind = "fixed"
position_m = [0, 0, 3.2]

[[sensors]]
name = "beam"
kind = "imaging"
beams = 1
horizontal_deg = 15
vertical_deg = 17
tilt_deg = 27
range_max_m = 30
cone_tolerance = 0.01
"""
CELL_M, CELLS = 1.5, (8, 12)  # east and north; corners of facets are at the centres of cells
SOUTH_WEST = (-5.3, -3.2)


def seabed_facets():
    """Corners of the facets of the level raster, as the program divides cells."""
    for row in range(CELLS[1] - 1):
        for column in range(CELLS[0] - 1):
            (x, y), c = (SOUTH_WEST[0] + column * CELL_M, SOUTH_WEST[1] + row * CELL_M), CELL_M
            a, b, c, d = (x, y, 0), (x + c, y, 0), (x + c, y + c, 0), (x, y + c, 0)
            yield [a, b, c]
            yield [a, c, d]


def beam_geometry(tools):
    folder = tools.folder("beam")
    (folder / "level.asc").write_text(
        f"ncols {CELLS[0]}\nnrows {CELLS[1]}\nxllcorner {SOUTH_WEST[0] - CELL_M / 2}\n"
        f"yllcorner {SOUTH_WEST[1] - CELL_M / 2}\ncellsize {CELL_M}\nNODATA_value -9999\n" + ("0 " * CELLS[0] + "\n") * CELLS[1])
    (folder / "beam.toml").write_text(BEAM_SCENE)
    tools.tubefoot("footprints", folder / "beam.toml", "--sensor", "beam", "-o", folder / "beam.txt")
    shot = Transmission(folder / "beam.txt")
    [tube] = shot.tubes
    sheet = Sheet(700, 404)
    high = float(shot.apex[2])

    def at(p):
        x, y, z = (float(v) for v in p)
        return 44 + 57 * y - 17 * x, 286 - 74 * z + 31 * x + 2 * y
    # The seabed as far as the sheet shows it, and its facets.
    corner = [(-2.5, -0.5, 0), (2.5, -0.5, 0), (2.5, 11.5, 0), (-2.5, 11.5, 0)]
    sheet.add('<defs><clipPath id="ground"><polygon points="'
              + " ".join("{:.1f},{:.1f}".format(*at(p)) for p in corner) + '"/></clipPath></defs>')
    sheet.polygon([at(p) for p in corner], SAND)
    sheet.add('<g clip-path="url(#ground)">')
    for facet in seabed_facets():
        sheet.polygon([at(p) for p in facet], "none", "#c3b17c", 0.7)
    sheet.add("</g>")
    # The footprint of the beam without the box: where it is not visible, it is in shadow.
    ground = []
    for ray in tube["rays"]:
        share = -high / float(ray[2])
        ground.append((float(ray[0]) * share, float(ray[1]) * share, 0.0))
    sheet.polygon([at(p) for p in ground], SHADOW, "none")
    facets = list(seabed_facets())
    seen = [(facet, [tuple(map(float, p)) for p in points]) for facet, points in tube["pieces"]]
    ground_pieces = [(f, p) for f, p in seen if all(abs(q[2]) < 1e-9 for q in p)]
    box_pieces = [(f, p) for f, p in seen if any(abs(q[2]) > 1e-9 for q in p)]
    for _, points in ground_pieces:
        sheet.polygon([at(p) for p in points], "#a9d3ec", "#3f88b5", 0.8)
    sheet.add('<defs><clipPath id="visible">' + "".join(
        '<polygon points="' + " ".join("{:.1f},{:.1f}".format(*at(p)) for p in points) + '"/>'
        for _, points in ground_pieces) + "</clipPath></defs>")

    def arc(slant):
        flat = math.sqrt(slant ** 2 - high ** 2)
        return [(flat * math.sin(math.radians(d / 2)), flat * math.cos(math.radians(d / 2)), 0) for d in range(-17, 18)]
    first, step = 5.6, 0.4
    bins = [first + step * k for k in range(12)]
    shown = bins[6]
    sheet.add('<g clip-path="url(#visible)">')
    sheet.polygon([at(p) for p in arc(shown) + arc(shown + step)[::-1]], ORANGE, "none", opacity=0.75)
    for slant in bins:
        sheet.line([at(p) for p in arc(slant)], RED, 1, "4 3")
    sheet.add("</g>")
    # The facet that is named: the one whose visible part is nearest to a half, of those at the shadow.
    def area(points):
        return abs(sum(p[0] * q[1] - q[0] * p[1] for p, q in zip(points, points[1:] + points[:1]))) / 2
    by_facet = {}
    for number, points in ground_pieces:
        by_facet.setdefault(number, []).append(points)
    centre = {n: tuple(sum(p[k] for q in ps for p in q) / sum(len(q) for q in ps) for k in (0, 1))
              for n, ps in by_facet.items()}
    named = min((n for n in by_facet if 5.5 < centre[n][1] < 8.5 and centre[n][0] > 0),
                key=lambda n: abs(sum(map(area, by_facet[n])) - CELL_M ** 2 / 4))
    inside = centre[named]

    def holds(facet):
        return all((q[0] - p[0]) * (inside[1] - p[1]) - (q[1] - p[1]) * (inside[0] - p[0]) >= 0
                   for p, q in zip(facet, facet[1:] + facet[:1]))
    outline = next(f for f in facets if holds(f))
    for points in by_facet[named]:
        sheet.polygon([at(p) for p in points], GREEN, "none", opacity=0.85)
    sheet.polygon([at(p) for p in outline], "none", INK, 1.8)
    # The box: its faces that the reader sees, then those that the beam sees.
    turn, middle, half = math.radians(-24), (0.15, 6.2), (0.4, 0.4)

    def post(a, b, z):
        x, y = a * half[0], b * half[1]
        return (middle[0] + x * math.cos(turn) - y * math.sin(turn), middle[1] + x * math.sin(turn) + y * math.cos(turn), z)
    faces = [[post(1, -1, 0), post(1, 1, 0), post(1, 1, 0.7), post(1, -1, 0.7)],
             [post(-1, 1, 0), post(1, 1, 0), post(1, 1, 0.7), post(-1, 1, 0.7)],
             [post(-1, -1, 0.7), post(1, -1, 0.7), post(1, 1, 0.7), post(-1, 1, 0.7)]]
    for face in faces:
        sheet.polygon([at(p) for p in face], STEEL, INK, 0.9)
    for _, points in box_pieces:
        sheet.polygon([at(p) for p in points], "#c9e2f2", "#3f88b5", 0.8, 0.9)
    # The tube.
    for corner_at in ground:
        sheet.line([at(shot.apex), at(corner_at)], BLUE, 1.3)
    sheet.polygon([at(p) for p in ground], "none", BLUE, 1.8)
    for a, b in ((0, 1), (1, 2), (2, 3), (3, 0)):
        sheet.polygon([at(shot.apex), at(ground[a]), at(ground[b])], BLUE, "none", opacity=0.05)
    sheet.dot(at(shot.apex), 6, INK, "white")
    sheet.text((at(shot.apex)[0] + 12, at(shot.apex)[1] - 2), "sonar (apex)")

    def name(label, target, *lines, anchor="start"):
        side = {"start": 16, "end": -16}[anchor]
        rises = target[1] > label[1]
        sheet.line([(label[0] + side, label[1] + (5 + 15 * (len(lines) - 1) if rises else -12)), target], INK, 0.9)
        sheet.dot(target, 2.2, INK)
        for k, line in enumerate(lines):
            sheet.text((label[0], label[1] + 15 * k), line, anchor)
    name((270, 52), towards(at(shot.apex), at(ground[2]), 0.5), "beam: here one tube, the frustum of four border rays")
    name((34, 372), at(inside + (0,)), "visible polygon: the part of the facet", "that the beam sees first")
    name((370, 394), at(outline[1]), "facet of the seabed")
    name((400, 120), at((0.25, 7.55, 0)), "acoustic shadow of the box")
    name((692, 168), at(arc(shown + step / 2)[6]), "range bin: slant ranges", "from r to r + step", anchor="end")
    name((690, 372), at(arc(bins[10])[30]), "borders of range bins", anchor="end")
    return sheet.svg()


def hull_from_above(sheet, at, turn, size=1.0):
    """A vehicle; its bow is at `turn` degrees, counter-clockwise from the right."""
    shape = [(34, 0), (26, 7), (10, 10), (-26, 10), (-32, 6), (-32, -6), (-26, -10), (10, -10), (26, -7)]
    angle = math.radians(turn)
    sheet.polygon([(at[0] + size * (x * math.cos(angle) - y * math.sin(angle)),
                    at[1] - size * (x * math.sin(angle) + y * math.cos(angle))) for x, y in shape], "#f4c95d", INK, 1.2)


def hull_from_the_side(sheet, at, turn, size=1.0):
    shape = [(36, 2), (30, 9), (-24, 9), (-30, 5), (-40, 10), (-40, -10), (-30, -5), (-24, -9), (30, -9), (36, -2)]
    angle = math.radians(turn)
    sheet.polygon([(at[0] + size * (x * math.cos(angle) - y * math.sin(angle)),
                    at[1] - size * (x * math.sin(angle) + y * math.cos(angle))) for x, y in shape], "#f4c95d", INK, 1.2)


def hull_from_behind(sheet, at, turn, size=1.0):
    angle = math.radians(turn)

    def place(x, y):
        return (at[0] + size * (x * math.cos(angle) - y * math.sin(angle)),
                at[1] - size * (x * math.sin(angle) + y * math.cos(angle)))
    sheet.polygon([place(24 * math.cos(k * math.pi / 18), 15 * math.sin(k * math.pi / 18)) for k in range(36)],
                  "#f4c95d", INK, 1.2)
    for sign in (-1, 1):
        sheet.line([place(24 * sign, 0), place(48 * sign, 0)], INK, 3)
    sheet.line([place(0, 15), place(0, 30)], INK, 3)


def axes():
    sheet = Sheet(700, 500)
    wide, tall, tops = 218, 190, (34, 270)
    lefts = (10, 241, 472)

    def panel(column, row, title):
        sheet.panel(lefts[column], tops[row], wide, tall, title)
        return lefts[column], tops[row]
    # Heading.
    x, y = panel(0, 0, "Heading, from above")
    corner = (x + 22, y + tall - 20)
    sheet.arrow(corner, (corner[0] + 60, corner[1]))
    sheet.text((corner[0] + 66, corner[1] + 4), "x: east", size=12)
    sheet.arrow(corner, (corner[0], corner[1] - 60))
    sheet.text((corner[0] - 12, corner[1] - 66), "y: north", size=12)
    sheet.dot(corner, 6, "white", INK)
    sheet.dot(corner, 2)
    sheet.text((corner[0] + 10, corner[1] - 12), "z: up", size=12)
    at = (x + 116, y + 98)
    sheet.line([at, (at[0], at[1] - 78)], FAINT, 1, "5 4")
    sheet.text((at[0], at[1] - 82), "north", "middle", FAINT, size=11)
    sheet.line([at, polar(at, 76, 45)], INK, 1, "8 3 2 3")
    hull_from_above(sheet, at, 45)
    sheet.angle(at, 60, 90, 45, ORANGE, both=False)
    sheet.key((x + wide - 6, at[1] - 30), "heading_deg", "end", ORANGE)
    # Pitch.
    x, y = panel(1, 0, "Pitch, from starboard")
    at = (x + 92, y + 112)
    sheet.line([(x + 12, at[1]), (x + wide - 12, at[1])], FAINT, 1, "5 4")
    sheet.text((x + wide - 10, at[1] + 15), "level", "end", FAINT, size=11)
    sheet.line([at, polar(at, 112, 18)], INK, 1, "8 3 2 3")
    hull_from_the_side(sheet, at, 18)
    sheet.angle(at, 96, 0, 18, ORANGE, both=False)
    sheet.key((x + wide - 8, y + 66), "pitch_deg", "end", ORANGE)
    sheet.text((x + 10, y + tall - 12), "positive: bow up", size=12)
    # Roll.
    x, y = panel(2, 0, "Roll, from behind")
    at = (x + wide / 2 - 8, y + 98)
    sheet.line([(x + 12, at[1]), (x + wide - 12, at[1])], FAINT, 1, "5 4")
    hull_from_behind(sheet, at, -20)
    sheet.angle(at, 82, 0, -20, ORANGE, both=False)
    sheet.key((x + wide - 8, at[1] + 44), "roll_deg", "end", ORANGE)
    sheet.text((x + 10, at[1] - 28), "port", size=12)
    sheet.text((x + wide - 10, at[1] - 8), "starboard", "end", size=12)
    sheet.text((x + 10, y + tall - 12), "positive: starboard side down", size=12)
    # Mounting, from above.
    x, y = panel(0, 1, "Sensor yaw, from above")
    at = (x + 84, y + 116)
    hull_from_above(sheet, at, 90, 1.4)
    sensor = (at[0] + 34, at[1] - 42)
    sheet.line([at, (at[0], sensor[1])], BLUE, 1.4)
    sheet.arrow(at, (at[0], sensor[1]), BLUE, 1.4)
    sheet.arrow((at[0], sensor[1]), sensor, BLUE, 1.4)
    sheet.text((at[0] - 6, at[1] - 24), "forward", "end", BLUE, size=12)
    sheet.text((at[0] + 22, sensor[1] + 16), "starboard", "start", BLUE, size=12)
    sheet.dot(at, 3.5, INK, "white")
    sheet.text((at[0] + 22, at[1] + 12), "reference point", size=12)
    sheet.line([sensor, (sensor[0], sensor[1] - 60)], FAINT, 1, "5 4")
    sheet.line([sensor, polar(sensor, 66, 90 - 42)], INK, 1, "8 3 2 3")
    sheet.wedge(sensor, 0, 60, 90 - 42 - 12, 90 - 42 + 12, BLUE, "none", opacity=0.25)
    sheet.angle(sensor, 46, 90, 48, ORANGE, both=False)
    sheet.key((sensor[0] + 10, sensor[1] - 56), "yaw_deg", colour=ORANGE)
    sheet.dot(sensor, 4, INK, "white")
    sheet.key((x + 10, y + tall - 12), "lever_arm_m", colour=BLUE)
    # Mounting, from the side.
    x, y = panel(1, 1, "Sensor tilt, from starboard")
    at = (x + 66, y + 62)
    hull_from_the_side(sheet, at, 0, 1.3)
    sensor = (at[0] + 34, at[1] + 36)
    sheet.arrow((sensor[0], at[1]), sensor, BLUE, 1.4)
    sheet.dot(at, 3.5, INK, "white")
    sheet.line([at, (sensor[0], at[1])], BLUE, 1.4)
    sheet.text((sensor[0] - 8, sensor[1] + 2), "up < 0", "end", BLUE, size=12)
    sheet.line([sensor, (x + wide - 8, sensor[1])], FAINT, 1, "5 4")
    sheet.wedge(sensor, 0, 96, -30 - 11, -30 + 11, BLUE, "none", opacity=0.25)
    sheet.line([sensor, polar(sensor, 104, -30)], INK, 1, "8 3 2 3")
    sheet.angle(sensor, 70, 0, -30, ORANGE, both=False)
    sheet.key((x + wide - 8, sensor[1] + 22), "tilt_deg", "end", ORANGE)
    sheet.dot(sensor, 4, INK, "white")
    sheet.text((x + 10, y + tall - 12), "positive: downwards", size=12)
    # Mounting, from behind.
    x, y = panel(2, 1, "Sensor roll, from behind")
    at = (x + wide / 2 - 8, y + 80)
    sheet.line([(x + 12, at[1]), (x + wide - 12, at[1])], FAINT, 1, "5 4")
    sheet.wedge(at, 10, 84, -90 - 16 - 34, -90 - 16 + 34, BLUE, "none", opacity=0.25)
    sheet.line([polar(at, 84, -16), polar(at, 84, 164)], INK, 1, "8 3 2 3")
    sheet.polygon([polar(polar(at, 20, -16), 6, 74), polar(polar(at, 20, -16), 6, -106),
                   polar(polar(at, 20, 164), 6, -106), polar(polar(at, 20, 164), 6, 74)], STEEL, INK, 1.2)
    sheet.angle(at, 72, 0, -16, ORANGE, both=False)
    sheet.key((x + wide - 8, at[1] + 40), "roll_deg", "end", ORANGE)
    sheet.text((x + wide - 10, at[1] - 8), "starboard", "end", size=12)
    sheet.text((x + 10, at[1] - 34), "port", size=12)
    sheet.text((x + 10, y + tall - 12), "positive: starboard side down", size=12)
    sheet.text((10, 484), "The rotations of the carrier apply in the order roll, pitch, heading. A lever arm is "
               "[starboard, forward, up].", size=12)
    return sheet.svg()

