# SPDX-License-Identifier: GPL-3.0-or-later
"""What a ping costs: one thing is varied at a time."""
import math

import numpy

from runs import Run, with_pings

# An imaging sonar over rough ground, all of its fan on the bed. `{more}`: what a series adds.
SCENE = """
[water]
sound_speed_m_s = 1500
[[materials]]
name = "bed"
lambert_db = -25
[[terrain]]
name = "seen"
kind = "fractal"
width_m = 24
length_m = 24
centre_m = [0, 14, 0]
cell_m = {cell_m}
rms_height_m = 0.3
hurst = 0.7
seed = 5
[trajectory]
kind = "fixed"
position_m = [0, 0, 5]
[[sensors]]
name = "sonar"
kind = "imaging"
tilt_deg = 29
horizontal_deg = 40
vertical_deg = 24
beams = {beams}
samples = {samples}
range_min_m = 1
range_max_m = 25
pings = 3
{more}
"""
# Facets that no ping sees: behind the sonar, or behind a wall that closes the fan. Rough ones: those of a plane
# would be merged.
BEHIND = """
[[terrain]]
name = "unseen"
kind = "fractal"
rms_height_m = 0.05
hurst = 0.7
seed = 6
width_m = {side}
length_m = {side}
centre_m = [0, {middle}, 0]
cell_m = {cell}
"""
WALL = """
[[objects]]
name = "wall"
shape = "box"
size_m = [40, 0.2, 40]
position_m = [0, 8, 0]
"""
USUAL = {"cell_m": 0.2, "beams": 64, "samples": 512, "more": ""}


def scene(**changes):
    return SCENE.format(**{**USUAL, **changes})


def series(quick):
    """{name: (what is varied, its values, value -> scene text)}"""
    some = lambda values: values[::3] if quick else values
    outside = lambda n: scene(more=BEHIND.format(side=200, middle=-110, cell=200 / math.sqrt(n / 2)))
    hidden = lambda n: scene(more=WALL + BEHIND.format(side=12, middle=15, cell=12 / math.sqrt(n / 2)))
    counts = [1e3, 3e3, 1e4, 3e4, 1e5, 3e5, 1e6]
    return {
        "seen": ("seabed facets, by cell size", [2, 1, 0.5, 0.3, 0.2, 0.1, 0.06, 0.04][:6 if quick else 8],
                 lambda cell: scene(cell_m=cell)),
        "outside": ("facets outside the fan", some(counts + [3e6]), outside),
        "hidden": ("facets in the fan, hidden by a wall", some(counts), hidden),
        "beams": ("beams in the same fan", some([2**k for k in range(11)]), lambda n: scene(beams=n)),
        "samples": ("range samples", some([2**k for k in range(6, 17)]), lambda n: scene(samples=n)),
        "orders": ("order of paths", [1, 2, 3] if quick else [1, 2, 3, 4, 5, 6], None),
    }


def shallow_water(order, folder):
    path = with_pings("paths/shallow-water.toml", 2, folder)
    path.write_text(path.read_text().replace("order = 3", f"order = {order}"))
    return path


def measure(program, folder, rounds, quick=False):
    """{series: [row]}; a row has the value varied, counts of a ping, and seconds of its cheapest of all rounds."""
    rows = {}
    for turn in range(rounds):
        for name, (words, values, text) in series(quick).items():
            for value in values:
                path = folder / f"{name}.toml"
                if text is None:
                    path = shallow_water(value, folder)
                else:
                    path.write_text(text(value))
                run = Run(program, path, ["--threads", "1"])
                stats, pings = run.stats, len(run.pings)
                best = run.pings[run.pings.sum(axis=1).argmin()]
                row = rows.setdefault(name, {}).setdefault(value, {
                    "value": value, "facets": stats["facets"], "candidates": stats["candidates"] / pings,
                    "footprints": stats["footprints"] / pings, "pieces": stats["pieces"] / pings,
                    "images": stats.get("paths", {}).get("images", 0) / pings, "seconds": math.inf})
                if best.sum() < row["seconds"]:
                    row.update(visibility=best[0], echo=best[1], seconds=best.sum())
            print(f"round {turn + 1} of {rounds}: {words}", flush=True)
    return {name: list(by_value.values()) for name, by_value in rows.items()}


def exponent(x, y, last=3):
    """Slope of log y over log x, least squares, of the last few points."""
    return float(numpy.polyfit(numpy.log(x[-last:]), numpy.log(y[-last:]), 1)[0])
