#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the figures of docs/theory.md and docs/tutorial.md: draw.py PROGRAM FOLDER.

Everything in them is what the program wrote: pictures of runs, and exact corners of `tubefoot footprints -o
X.txt`, converted to doubles on drawing. The scenes are those of the tutorial, read from its page.
"""
import math
import pathlib
import re
import subprocess
import sys
import tempfile
from fractions import Fraction

PAGE = pathlib.Path(__file__).resolve().parents[1] / "tutorial.md"
SAND, STEEL, WATER, INK = "#d9c48c", "#7f93a8", "#bfe0f2", "#223344"


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
            if kind in ("transmission", "shot"):  # version 2, version 1
                [self.apex] = points(words[2:])
            elif kind == "tube":
                axis, *rays = points(words[2:])
                self.tubes.append({"axis": axis, "rays": rays, "pieces": [], "open": []})
            elif kind == "piece":
                self.tubes[-1]["pieces"].append((int(words[0]), points(words[2:])))
            elif kind == "open":
                self.tubes[-1]["open"].append(points(words[1:]))


class Drawing:
    def __init__(self, box, width):
        (self.left, self.bottom), (right, top) = box
        self.scale = width / (right - self.left)
        self.height, self.width, self.top, self.rows = (top - self.bottom) * self.scale, width, top, []

    def place(self, p):
        return f"{(p[0] - self.left) * self.scale:.2f},{(self.top - p[1]) * self.scale:.2f}"

    def polygon(self, points, fill, line="none", thick=0.5):
        self.rows.append(f'<polygon points="{" ".join(map(self.place, points))}" fill="{fill}" stroke="{line}" '
                         f'stroke-width="{thick}" stroke-linejoin="round"/>')

    def line(self, points, colour, thick=1.0, dashes=""):
        self.rows.append(f'<polyline points="{" ".join(map(self.place, points))}" fill="none" stroke="{colour}" '
                         f'stroke-width="{thick}" stroke-dasharray="{dashes}"/>')

    def text(self, p, words, anchor="start"):
        x, y = self.place(p).split(",")
        self.rows.append(f'<text x="{x}" y="{y}" text-anchor="{anchor}">{words}</text>')

    def write(self, path):
        path.write_text(
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{self.width:.0f}" height="{self.height:.0f}" '
            f'viewBox="0 0 {self.width:.0f} {self.height:.0f}" font-family="sans-serif" font-size="13" fill="{INK}">\n'
            '<rect width="100%" height="100%" fill="white"/>\n' + "\n".join(self.rows) + "\n</svg>\n")


def closure(shot, path):
    """Tubes cut square to their middle: the visible pieces and the open water fill each of them."""
    axis = unit(tuple(sum(float(tube["axis"][k]) / math.hypot(*map(float, tube["axis"])) for tube in shot.tubes)
                      for k in range(3)))
    right = unit(cross(axis, (0, 0, 1)))
    up = cross(right, axis)

    def flat(direction):
        d = unit(direction)
        return tuple(math.degrees(math.atan(dot(d, side) / dot(d, axis))) for side in (right, up))
    corners = [flat(ray) for tube in shot.tubes for ray in tube["rays"]]
    low, high = [min(c[k] for c in corners) for k in (0, 1)], [max(c[k] for c in corners) for k in (0, 1)]
    drawing = Drawing(((low[0] - 0.5, low[1] - 0.5), (high[0] + 8, high[1] + 0.5)), 520)
    for tube in shot.tubes:
        for facet, points in tube["pieces"]:
            drawing.polygon([flat(sub(p, shot.apex)) for p in points], SAND if facet < 2 else STEEL, INK, 0.5)
        for directions in tube["open"]:
            drawing.polygon([flat(d) for d in directions], WATER, INK, 0.5)
    for tube in shot.tubes:
        drawing.polygon([flat(ray) for ray in tube["rays"]], "none", INK, 1.8)
    for height, words in ((12.4, "open water"), (7.5, "bed beyond the ball"), (-3.5, "facets of the ball"),
                          (-12.5, "bed before it")):
        drawing.text((high[0] + 0.6, height), words)
    drawing.write(path)


def plan(shot, path, first, step):
    """Footprints of a fan from above, cut by the arcs of equal range."""
    apex = tuple(map(float, shot.apex))
    drawing = Drawing(((-3, -0.4), (3, 9.4)), 480)
    for tube in shot.tubes:
        pieces = sorted(tube["pieces"], key=lambda piece: sum(p[2] for p in piece[1]) / len(piece[1]))
        for facet, points in pieces:
            drawing.polygon([(float(p[0]), float(p[1])) for p in points], SAND if facet < 2 else STEEL, INK, 0.4)
    reach = 9.2
    for k in range(40):
        slant = first + k * step
        if slant <= apex[2]:
            continue
        radius = math.sqrt(slant**2 - apex[2]**2)
        if radius > reach:
            break
        arc = [(radius * math.sin(a), radius * math.cos(a)) for a in (math.radians(d / 2) for d in range(-31, 32))]
        drawing.line(arc, "#b03030", 0.5, "3 3")
        drawing.text((arc[-1][0] + 0.06, arc[-1][1]), f"{slant:g} m")
    drawing.line([(-0.12, 0), (0, 0.2), (0.12, 0), (-0.12, 0)], INK, 1.5)
    drawing.text((0.2, -0.05), f"camera, {apex[2]:g} m up")
    drawing.write(path)


def main():
    program, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    page = PAGE.read_text()
    scene = re.search(r"```toml\n(.*?)```", page, re.S)[1]
    box = re.search(r"<<'END'\n(.*?)END\n", page, re.S)[1]
    higher = (scene + box).replace("[0, 0, 2]", "[0, 0, 3]").replace("tilt_deg = 17", "tilt_deg = 27")
    # Wider beams for the drawings, so that there is something to see in one.
    drawn = scene.replace("chord_error_m = 0.001", "chord_error_m = 0.02")
    high_fan = drawn.replace("tilt_deg = 17", "tilt_deg = 17\nbeams = 8\nhorizontal_deg = 16\nvertical_deg = 28")
    few_beams = drawn.replace("tilt_deg = 17", "tilt_deg = 17\nbeams = 12\nhorizontal_deg = 30")
    with tempfile.TemporaryDirectory() as name:
        scratch = pathlib.Path(name)

        def tubefoot(text, *arguments):
            (scratch / "scene.toml").write_text(text)
            subprocess.run([program, arguments[0], scratch / "scene.toml", "--quiet", *arguments[1:]], check=True,
                           stdout=subprocess.DEVNULL)
        for text, figure in ((scene + box, "tutorial-low.png"), (higher, "tutorial-high.png")):
            tubefoot(text, "run", "-o", scratch / "run")
            subprocess.run(["oiiotool", scratch / "run/camera-0000.png", "--nosoftwareattrib", "--resize", "500x0",
                            "-d", "uint8", "-o", folder / figure], check=True)
        tubefoot(high_fan, "footprints", "--sensor", "camera", "-o", scratch / "high.txt")
        closure(Transmission(scratch / "high.txt"), folder / "closure.svg")
        tubefoot(few_beams, "footprints", "--sensor", "camera", "-o", scratch / "fan.txt")
        plan(Transmission(scratch / "fan.txt"), folder / "footprints-in-plan.svg", 2.5, 0.5)


if __name__ == "__main__":
    main()
