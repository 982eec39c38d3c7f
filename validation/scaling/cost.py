# SPDX-License-Identifier: GPL-3.0-or-later
"""What a ping costs: one thing is varied at a time."""
import math
import pathlib
import re

import numpy

from runs import Run, with_pings

HERE = pathlib.Path(__file__).resolve().parent
FAN, WALL, UNSEEN = ((HERE / f"{name}.toml").read_text() for name in ("fan", "wall", "unseen"))


def edited(text, **changes):
    """The text of a scene with other values of these keys, each at its first occurrence."""
    for key, value in changes.items():
        text, number = re.subn(rf"^{key} = .*$", f"{key} = {value}", text, count=1, flags=re.M)
        if number != 1:
            raise ValueError(f"no key '{key}' in the scene")
    return text


def unseen(side, middle, facets):
    """Facets that no ping sees."""
    return edited(UNSEEN, width_m=side, length_m=side, centre_m=[0, middle, 0], cell_m=side / math.sqrt(facets / 2))


def series(quick):
    """{name: (what is varied, its values, value -> scene text)}"""
    some = lambda values: values[::3] if quick else values
    outside = lambda n: FAN + unseen(200, -110, n)
    hidden = lambda n: FAN + WALL + unseen(12, 15, n)
    counts = [1e3, 3e3, 1e4, 3e4, 1e5, 3e5, 1e6]
    return {
        "seen": ("seabed facets, by cell size", [2, 1, 0.5, 0.3, 0.2, 0.1, 0.06, 0.04][:6 if quick else 8],
                 lambda cell: edited(FAN, cell_m=cell)),
        "outside": ("facets outside the fan", some(counts + [3e6]), outside),
        "hidden": ("facets in the fan, hidden by a wall", some(counts), hidden),
        "beams": ("beams in the same fan", some([2**k for k in range(11)]), lambda n: edited(FAN, beams=n)),
        "samples": ("range samples", some([2**k for k in range(6, 17)]), lambda n: edited(FAN, samples=n)),
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
