# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of results of the program: scattering models, footprints in plan, sampling by rays, closure of tubes."""
import csv
import json
import math
import re

import netCDF4
import numpy as np

import raster
from geometry_drawings import Transmission, cross, dot, sub, unit
from sheet import BLUE, FAINT, GREEN, GRID, INK, ORANGE, PURPLE, RED, SAND, STEEL, WATER, Sheet

SCATTERING_SCENE = """title = "One material"

[water]
sound_speed_m_s = 1500
absorption_db_per_km = 0

[[materials]]
name = "seabed"
{keys}

[[terrain]]
kind = "flat"
material = "seabed"
width_m = 4000
length_m = 100

[trajectory]
kind = "fixed"
position_m = [0, 0, 10]

[[sensors]]
name = "beams"
kind = "multibeam"
frequency_khz = 300
beam_angles_deg = [{angles}]
beam_across_deg = 0.1
along_track_deg = 0.1
range_max_m = 1500
"""
MODELS = [  # name, keys, colour, dashes
    ("Lambert's law, -20 dB", 'lambert_db = -20', BLUE, ""),
    ("GSAB", 'law = "gsab"\nspecular_db = -6\nspecular_width_deg = 6\noblique_db = -22\noblique_exponent = 2\n'
     'transition_db = -17\ntransition_width_deg = 18', ORANGE, "9 3"),
    ("table of 6 rows", 'law = "table"\ntable_grazing_deg = [5, 15, 30, 50, 70, 85]\n'
     'table_db = [-38, -31, -27, -25, -21, -15]', GREEN, "2 3"),
    ("sediment: coarse sand, 300 kHz", 'law = "sediment"\nsediment = "coarse sand"', PURPLE, "9 3 2 3"),
    ("sediment: silt, 300 kHz", 'law = "sediment"\nsediment = "silt"', RED, "5 3"),
]
TABLE_ROWS = [(5, -38), (15, -31), (30, -27), (50, -25), (70, -21), (85, -15)]


def backscattering_strength(tools, keys, name):
    """(grazing angle in degrees, dB) of a level seabed, from energies of narrow footprints."""
    angles = ", ".join(f"{90 - grazing:g}" for grazing in sorted([1.5, 2, 2.5, *np.arange(3, 90.5, 1)], reverse=True))
    folder = tools.folder("scattering")
    (folder / f"{name}.toml").write_text(SCATTERING_SCENE.format(keys=keys, angles=angles))
    tools.tubefoot("footprints", folder / f"{name}.toml", "--sensor", "beams", "-o", folder / f"{name}.csv")
    sums = {}
    csv.field_size_limit(1 << 30)
    with open(folder / f"{name}.csv", newline="") as file:
        for row in csv.DictReader(file):
            spread = (float(row["slant_range_min_m"]) * float(row["slant_range_max_m"])) ** 2
            known = sums.setdefault(int(row["beam"]), [0.0, 0.0, 0.0])
            known[0] += float(row["energy_j"]) * spread
            known[1] += float(row["area_m2"])
            known[2] += float(row["area_m2"]) * float(row["grazing_deg"])
    return sorted((angle / area, 10 * math.log10(energy / area)) for energy, area, angle in sums.values() if energy > 0)


def scattering_models(tools):
    sheet = Sheet(700, 430)
    left, top, wide, tall, low, high = 66, 22, 600, 344, -50.0, 0.0

    def at(angle, level):
        return left + wide * angle / 90, top + tall * (high - level) / (high - low)
    sheet.rectangle(left, top, wide, tall, "white", FAINT)
    for angle in range(0, 91, 10):
        x, _ = at(angle, 0)
        sheet.line([(x, top), (x, top + tall)], GRID, 1)
        sheet.text((x, top + tall + 18), f"{angle}°", "middle", size=12)
    for level in range(int(low), int(high) + 1, 10):
        _, y = at(0, level)
        sheet.line([(left, y), (left + wide, y)], GRID, 1)
        sheet.text((left - 8, y + 4), f"{level}", "end", size=12)
    sheet.text((left + wide / 2, top + tall + 42), "grazing angle", "middle")
    sheet.text((20, top + tall / 2), "backscattering strength (dB re 1 sr⁻¹)", "middle", turn=-90)
    for k, (name, keys, colour, dashes) in enumerate(MODELS):
        points = [(a, s) for a, s in backscattering_strength(tools, keys, f"model-{k}") if s >= low]
        sheet.line([at(*p) for p in points], colour, 2.2, dashes)
        y = top + 20 + 19 * k
        sheet.line([(left + 16, y - 4), (left + 56, y - 4)], colour, 2.2, dashes)
        sheet.text((left + 64, y), name, size=12.5)
    for row in TABLE_ROWS:
        sheet.dot(at(*row), 3.6, GREEN, "white")
    return sheet.svg()


def css(rgb):
    return "#" + "".join(f"{round(255 * c):02x}" for c in rgb)


def polygons_of(wkt):
    """Rings of the polygons of a WKT geometry, as lists of (east, north)."""
    for ring in re.findall(r"\(([^()]+)\)", wkt):
        points = [tuple(map(float, p.split()[:2])) for p in ring.split(",")]
        yield points


def footprints_in_plan(tools, path):
    """Footprints of the camera's first ping on the well head, by level of their energy per solid angle."""
    folder = tools.folder("footprints-wellhead")
    tools.tubefoot("footprints", tools.root / "scenes/wellhead/scene.toml", "--sensor", "camera", "--pings", "0", "-o",
                   folder / "camera.csv")
    csv.field_size_limit(1 << 30)
    with open(folder / "camera.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    shape = next(name for name in rows[0] if rows[0][name].upper().startswith(("MULTI", "POLYGON", "GEOMETRY", "LINE")))
    rows.sort(key=lambda row: float(row["centroid_up_m"]))
    levels = [10 * math.log10(max(float(r["energy_j"]) / float(r["solid_angle_sr"]), 1e-30)) for r in rows]
    low, high = 5 * math.floor(np.percentile(levels, 2) / 5), 5 * math.ceil(np.percentile(levels, 99.5) / 5)
    easts, norths = zip(*[p for row in rows for ring in polygons_of(row[shape]) for p in ring])
    west, east, south, north = min(easts), max(easts), min(norths), max(norths)
    sheet = Sheet(790, 690)
    left, top, scale = 64, 56, 560 / (east - west + 0.6)
    x0, y1 = west - 0.3, north + 0.3
    wide, tall = 560, (y1 - south + 0.3) * scale

    def at(p):
        return left + (p[0] - x0) * scale, top + (y1 - p[1]) * scale
    sheet.text((left, 22), "Footprints of an acoustic camera on a well head, one ping, in plan", bold=True, size=14)
    sheet.text((left, 41), f"{len(rows)} footprints; facets without a footprint are in shadow or outside of the beams", colour=FAINT, size=12)
    sheet.rectangle(left, top, wide, tall, "white", FAINT)
    for row, level in zip(rows, levels):
        fill = css(raster.colours(np.array((level - low) / (high - low)), raster.COPPER))
        for ring in polygons_of(row[shape]):
            sheet.polygon([at(p) for p in ring], fill, "#20242a", 0.12)
    for value in range(math.ceil(x0), math.floor(x0 + wide / scale) + 1):
        x, _ = at((value, 0))
        sheet.line([(x, top + tall), (x, top + tall + 6)], FAINT, 1)
        sheet.text((x, top + tall + 20), f"{value}", "middle", size=12)
    for value in range(math.ceil(y1 - tall / scale), math.floor(y1) + 1):
        _, y = at((0, value))
        sheet.line([(left - 6, y), (left, y)], FAINT, 1)
        sheet.text((left - 10, y + 4), f"{value}", "end", size=12)
    sheet.text((left + wide / 2, top + tall + 40), "east (m)", "middle")
    sheet.text((22, top + tall / 2), "north (m)", "middle", turn=-90)
    bar, y = left + wide + 26, top + 34
    sheet.text((bar, top + 12), "energy per solid angle", size=12)
    sheet.text((bar, top + 27), "(dB re 1 J/(m² sr))", size=12)
    for k in range(200):
        sheet.rectangle(bar, y + k, 20, 1.5, css(raster.colours(np.array(1 - k / 199), raster.COPPER)))
    step = 10 if high - low > 25 else 5
    for level in range(int(math.ceil(low / step) * step), int(high) + 1, step):
        at_y = y + 200 * (high - level) / (high - low)
        sheet.line([(bar + 20, at_y), (bar + 26, at_y)], FAINT, 1)
        sheet.text((bar + 30, at_y + 4), f"{level}", size=12)
    y += 236
    sheet.rectangle(bar, y - 12, 20, 14, "white", FAINT)
    sheet.text((bar + 28, y), "not seen", size=12)
    y += 34
    sheet.line([(bar, y), (bar + scale, y)], INK, 3)
    sheet.text((bar, y + 18), "1 m", size=12)
    sheet.height = int(top + tall + 56)
    raster.rasterise(sheet.svg(), path, sheet.width, sheet.height, 1.5)


def fan_of(energy, azimuths, ranges, width=232):
    """Energies (beams, bins) on a picture in true geometry; NaN outside of the fan."""
    half, far, near = azimuths[-1], ranges[-1], ranges[0]
    scale = width / (2 * far * math.sin(half))
    height = math.ceil((far - near * math.cos(half)) * scale)
    x = (np.arange(width) + 0.5) / scale - far * math.sin(half)
    y = far - (np.arange(height) + 0.5) / scale
    slant, angle = np.hypot(x[None, :], y[:, None]), np.arctan2(x[None, :], y[:, None])
    beam = np.floor((angle - azimuths[0]) / (azimuths[-1] - azimuths[0]) * energy.shape[0]).astype(int)
    bin_ = np.floor((slant - near) / (far - near) * energy.shape[1]).astype(int)
    inside = (beam >= 0) & (beam < energy.shape[0]) & (bin_ >= 0) & (bin_ < energy.shape[1])
    out = np.full((height, width), np.nan)
    out[inside] = energy[beam[inside], bin_[inside]]
    return out


def sampling_comparison(tools, path):
    """The well head by rays in one column per beam, by dense rays, and exactly; errors in dB."""
    scene = tools.root / "scenes/wellhead/scene.toml"
    runs = [("a column of 500 rays per beam", ["--engine", "ray", "--sampling", "column", "--rays-per-beam", "500"]),
            ("20 000 stratified rays per beam", ["--engine", "ray", "--sampling", "stratified", "--rays-per-beam", "20000"]),
            ("exact footprints (tube engine)", [])]
    folder, energies, errors = tools.folder("sampling"), [], []
    for k, (_, options) in enumerate(runs):
        tools.tubefoot("run", scene, "-o", folder / f"run-{k}", "--sensor", "camera", "--pings", "0", "--pictures", "none",
                       *options)
        with netCDF4.Dataset(folder / f"run-{k}" / "echoes.nc") as file:
            group = next(iter(file.groups.values()), file)
            energies.append(np.asarray(group["energy"][0].filled(0)))
            bounds = np.asarray(group["slant_range_bounds"][:])
            centres = np.asarray(group["beam_azimuth"][:])
    for k in range(2):
        tools.tubefoot("compare", folder / "run-2/echoes.nc", folder / f"run-{k}/echoes.nc", "--json", folder / f"{k}.json")
        errors.append(json.loads((folder / f"{k}.json").read_text()))
    step = centres[1] - centres[0]
    azimuths = np.radians([centres[0] - step / 2, centres[-1] + step / 2]) if abs(centres[-1]) > 3 else np.array(
        [centres[0] - step / 2, centres[-1] + step / 2])
    ranges = [bounds[0, 0], bounds[-1, 1]]
    exact = energies[2]
    top_level = np.percentile(exact[exact > 0], 99.9)
    sheet = Sheet(800, 640)
    wide, gap, left = 232, 14, 16
    pictures = []
    for energy in energies:
        fan = fan_of(energy, azimuths, ranges, 3 * wide)
        level = 1 + 10 * np.log10(np.maximum(fan, 1e-30) / top_level) / 50
        rgb = raster.colours(np.nan_to_num(level), raster.COPPER)
        rgb[fan == 0] = raster.NO_ECHO
        rgb[np.isnan(fan)] = 1
        pictures.append(rgb)
    high = wide * pictures[0].shape[0] / pictures[0].shape[1]
    faint = 1e-3 * exact[exact > 0].mean()
    for k, (words, _) in enumerate(runs):
        x = left + k * (wide + gap)
        sheet.text((x + wide / 2, 20), words, "middle", bold=True, size=12, halo=False)
        sheet.picture(x, 30, wide, high, raster.uri(pictures[k]))
        if k == 2:
            continue
        ratio = np.full(exact.shape, np.nan)
        shown = (exact > faint) | (energies[k] > faint)
        ratio[shown] = np.clip(10 * np.log10(np.maximum(energies[k][shown], 1e-30) / np.maximum(exact[shown], 1e-30)), -10, 10)
        fan = fan_of(np.nan_to_num(ratio, nan=99.0), azimuths, ranges, 3 * wide)
        rgb = raster.colours(np.nan_to_num(fan) / 20 + 0.5, raster.DIFFERENCE)
        rgb[fan == 99.0] = 0.78
        rgb[np.isnan(fan)] = 1
        sheet.picture(x, 44 + high, wide, high, raster.uri(rgb))
        found = errors[k]["sensors"][0] if "sensors" in errors[k] else errors[k]
        l1, rms = found.get("l1_error"), found.get("rms_db_error")
        sheet.text((x + wide / 2, 62 + 2 * high), f"relative L1 error {l1:.3g}, RMS {rms:.2g} dB", "middle", size=12)
    x, y = left + 2 * (wide + gap) + 30, 44 + high + 40
    sheet.text((x, y - 14), "energy (dB)", size=12)
    for j in range(120):
        for column, stops in ((0, raster.COPPER), (110, raster.DIFFERENCE)):
            sheet.rectangle(x + column, y + j, 18, 1.5, css(raster.colours(np.array(1 - j / 119), stops)))
    for level in (0, -10, -20, -30, -40, -50):
        sheet.text((x + 24, y + 120 * -level / 50 + 4), f"{level}", size=11)
    sheet.text((x + 110, y - 14), "error (dB)", size=12)
    for level in (10, 5, 0, -5, -10):
        sheet.text((x + 134, y + 60 - 6 * level + 4), f"{level:+d}" if level else "0", size=11)
    sheet.rectangle(x, y + 140, 18, 14, "#0d1233", FAINT)
    sheet.text((x + 26, y + 152), "no echo", size=12)
    sheet.rectangle(x + 110, y + 140, 18, 14, "#c7c7c7", FAINT)
    sheet.text((x + 136, y + 152), "no echo in both", size=12)
    sheet.text((x, y + 186), "Upper row: one frame of an", size=12)
    sheet.text((x, y + 202), "acoustic camera. Lower row:", size=12)
    sheet.text((x, y + 218), "error of the rays.", size=12)
    sheet.height = int(76 + 2 * high)
    raster.rasterise(sheet.svg(), path, sheet.width, sheet.height, 1.75)


class Drawing:
    """Polygons and lines in metres or degrees, as an SVG."""
    def __init__(self, box, width):
        (self.left, self.bottom), (right, top) = box
        self.scale = width / (right - self.left)
        self.top = top
        self.sheet = Sheet(width, round((top - self.bottom) * self.scale))

    def at(self, p):
        return (p[0] - self.left) * self.scale, (self.top - p[1]) * self.scale

    def polygon(self, points, fill, line="none", thick=0.5):
        self.sheet.polygon(list(map(self.at, points)), fill, line, thick)

    def line(self, points, colour, thick=1.0, dashes=""):
        self.sheet.line(list(map(self.at, points)), colour, thick, dashes)

    def text(self, p, words, anchor="start"):
        self.sheet.text(self.at(p), words, anchor)


def tutorial_scene(tools, **changed):
    """The tutorial's scene with wider beams and a coarser sphere, so that there is something to see in one."""
    text = tools.tutorial.replace("chord_error_m = 0.001", "chord_error_m = 0.02")
    return text.replace("tilt_deg = 17", "tilt_deg = 17\n" + "\n".join(f"{key} = {value}" for key, value in changed.items()))


def closure(tools):
    """Tubes cut square to their middle: the visible pieces and the open water fill each of them."""
    folder = tools.folder("closure")
    (folder / "scene.toml").write_text(tutorial_scene(tools, beams=8, horizontal_deg=16, vertical_deg=28))
    tools.tubefoot("footprints", folder / "scene.toml", "--sensor", "camera", "-o", folder / "fan.txt")
    shot = Transmission(folder / "fan.txt")
    axis = unit(tuple(sum(float(tube["axis"][k]) / math.hypot(*map(float, tube["axis"])) for tube in shot.tubes)
                      for k in range(3)))
    right = unit(cross(axis, (0, 0, 1)))
    up = cross(right, axis)

    def flat(direction):
        d = unit(direction)
        return tuple(math.degrees(math.atan(dot(d, side) / dot(d, axis))) for side in (right, up))
    corners = [flat(ray) for tube in shot.tubes for ray in tube["rays"]]
    low, high = [min(c[k] for c in corners) for k in (0, 1)], [max(c[k] for c in corners) for k in (0, 1)]
    drawing = Drawing(((low[0] - 0.5, low[1] - 0.5), (high[0] + 9, high[1] + 0.5)), 560)
    for tube in shot.tubes:
        for facet, points in tube["pieces"]:
            drawing.polygon([flat(sub(p, shot.apex)) for p in points], SAND if facet < 2 else STEEL, INK, 0.5)
        for directions in tube["open"]:
            drawing.polygon([flat(d) for d in directions], WATER, INK, 0.5)
    for tube in shot.tubes:
        drawing.polygon([flat(ray) for ray in tube["rays"]], "none", INK, 1.8)
    for height, words in ((12.4, "unobstructed region"), (7.5, "seabed behind the sphere"), (-3.5, "facets of the sphere"),
                          (-12.5, "seabed before the sphere")):
        drawing.text((high[0] + 0.6, height), words)
    return drawing.sheet.svg()


def plan_of_a_fan(tools):
    """Footprints of a fan from above, cut by the arcs of equal range."""
    folder = tools.folder("plan")
    (folder / "scene.toml").write_text(tutorial_scene(tools, beams=12, horizontal_deg=30))
    tools.tubefoot("footprints", folder / "scene.toml", "--sensor", "camera", "-o", folder / "fan.txt")
    shot = Transmission(folder / "fan.txt")
    apex = tuple(map(float, shot.apex))
    drawing = Drawing(((-3, -0.4), (3, 9.4)), 480)
    for tube in shot.tubes:
        pieces = sorted(tube["pieces"], key=lambda piece: sum(p[2] for p in piece[1]) / len(piece[1]))
        for facet, points in pieces:
            drawing.polygon([(float(p[0]), float(p[1])) for p in points], SAND if facet < 2 else STEEL, INK, 0.4)
    reach, first, step = 9.2, 2.5, 0.5
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
    drawing.text((0.2, -0.05), f"camera, height {apex[2]:g} m")
    return drawing.sheet.svg()
