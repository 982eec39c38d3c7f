#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact gradients beside other estimates: study.py PAGE FIGURES [--draws N] [--quick].

The scene is a wall on a flat seabed, whose derivatives are known in closed form. The study compares the exact gradient
with central differences of the ray engine, and with derivatives that omit the motion of the shadow's border. It needs
the Python module (make python). --quick: fewer rays and draws.
"""
import argparse
import datetime
import math
import os
import pathlib
import subprocess
import sys
import time

import numpy
import tubefoot

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scaling"))
import plot  # noqa: E402

MU = 10**-2.7
HEIGHT_M, WALL_M, DISTANCE_M, END_M = 3.0, 0.5, 4.0, 6.0  # sonar, height and distance of the wall, end of the bin
WIDTH_RAD = 0.01
STEP_M = 0.01  # of central differences
PARAMETERS = {"height of the sonar": "sonar.position.up", "distance of the wall": "wall.position.north"}
RAYS = [1000, 3000, 10000, 30000, 100000, 300000, 1000000]


def scene(height_m=HEIGHT_M, distance_m=DISTANCE_M, wall_m=WALL_M, seed=1):
    """The wall scene: a narrow fan, and one range bin behind the wall that contains the end of its shadow."""
    seabed = {"name": "seabed", "material": "sand", "vertices": numpy.array(
        [[-20.0, -20, 0], [20, -20, 0], [20, 20, 0], [-20, 20, 0]]), "facets": numpy.array([[0, 1, 2], [0, 2, 3]])}
    wall = {"name": "wall", "material": "sand", "position_m": [0, distance_m, 0], "vertices": numpy.array(
        [[-1.0, 0, 0], [1, 0, 0], [1, 0, wall_m], [-1, 0, wall_m]]), "facets": numpy.array([[0, 1, 2], [0, 2, 3]])}
    return tubefoot.Scene.from_dict({
        "run": {"seed": seed},
        "water": {"sound_speed_m_s": 1500, "absorption_db_per_km": 0},
        "materials": [{"name": "sand", "lambert_db": -27}],
        "objects": [seabed, wall],
        "trajectory": {"kind": "fixed", "position_m": [0, 0, height_m]},
        "sensors": [{"name": "sonar", "kind": "imaging", "beams": 1, "horizontal_deg": math.degrees(WIDTH_RAD),
                     "vertical_deg": 160, "samples": 1, "range_min_m": 5.2, "range_max_m": END_M}],
    }, name="wall")


def closed_form():
    """Energy and its derivatives, for a fan of a small width: E = mu H^2 w (r_s^-4 - r_1^-4) / 4."""
    h, w, d, mu = HEIGHT_M, WALL_M, DISTANCE_M, MU * WIDTH_RAD
    x = d * h / (h - w)
    r = math.hypot(h, x)
    energy = mu * h**2 * (r**-4 - END_M**-4) / 4
    by_end = -mu * h**2 * r**-5  # by the range at which the shadow ends
    by = {"height of the wall": by_end * x / r * d * h / (h - w)**2,
          "distance of the wall": by_end * x / r * h / (h - w),
          "height of the sonar": 2 * energy / h + by_end * (h - x * d * w / (h - w)**2) / r}
    # The interior integral of the density's derivative, over the range and over the place on the seabed.
    by_range = 2 * energy / h
    by_place = by_range - mu * h**3 * (r**-6 - END_M**-6)
    return energy, by, {"integral over range": by_range, "integral over the seabed": by_place}


def timed(call):
    began = time.process_time()
    result = call()
    return result, time.process_time() - began


def exact():
    """{parameter: derivative}, and processor seconds of one run with gradients."""
    def run():
        sonar = tubefoot.run(scene(), gradient=list(PARAMETERS.values()), threads=1)["sonar"]
        return {name: float(sonar.gradient[key].sum()) for name, key in PARAMETERS.items()}
    run()
    found = [timed(run) for _ in range(9)]
    return found[0][0], min(seconds for _, seconds in found)


def difference(rays, seed, name):
    """Central difference of the ray engine, and its processor seconds."""
    argument = {"height of the sonar": "height_m", "distance of the wall": "distance_m"}[name]
    middle = {"height_m": HEIGHT_M, "distance_m": DISTANCE_M}[argument]

    def energy(value):
        return float(tubefoot.run(scene(**{argument: value}, seed=seed), engine="ray", rays_per_beam=rays,
                                  threads=1)["sonar"].energy.sum())
    return timed(lambda: (energy(middle + STEP_M) - energy(middle - STEP_M)) / (2 * STEP_M))


def measure(rays, draws):
    exact_values, exact_seconds = exact()
    rows = []
    for name in PARAMETERS:
        for count in rays:
            found = [difference(count, seed, name) for seed in range(1, draws + 1)]
            truth = exact_values[name]
            error = math.sqrt(sum((value - truth)**2 for (value, _) in found) / draws) / abs(truth)
            wrong = sum(value * truth < 0 for (value, _) in found)
            rows.append((name, count, error, wrong, min(seconds for (_, seconds) in found)))
    return exact_values, exact_seconds, rows


def at_equal_time(rows, seconds):
    """A sentence on the differences that take no more time than the exact gradient."""
    best = [max((row for row in rows if row[0] == name and row[4] <= seconds), key=lambda row: row[1], default=None)
            for name in PARAMETERS]
    if not any(best):
        return "Each difference takes longer than the exact gradient, which has both derivatives at once."
    return " ".join(f"At the time of the exact gradient, the error by the {row[0]} is {row[2]:.2g}." for row in best if row)


def revision():
    return subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True,
                          cwd=pathlib.Path(__file__).parent).stdout.strip() or "unknown"


def page(exact_values, exact_seconds, rows, draws):
    energy, truth, without = closed_form()
    lines = ["# Gradients: the shadow of a wall", "",
             "This page compares derivatives of one range bin with their closed form. It is for users of gradients and developers of",
             "differentiable simulators. `make gradients` repeats the study.", "",
             f"Date: {datetime.date.today()}, revision: {revision()}, {os.cpu_count()} cores, one thread.", "",
             f"A sonar at a height of {HEIGHT_M:g} m views a flat seabed. A thin wall of {WALL_M:g} m at a distance of {DISTANCE_M:g} m casts a shadow. The range bin",
             f"contains the end of the shadow and ends at {END_M:g} m. Its energy is {energy:.6e} J/m². The fan is {WIDTH_RAD:g} rad wide.", "",
             "## Boundary terms", "",
             "A derivative of an integral over the visible surface contains the motion of the border. Estimates that differentiate only",
             "the integrand have the wrong sign here:", "",
             "| estimate | by the height of the sonar [J m⁻² m⁻¹] | by the distance of the wall [J m⁻² m⁻¹] |", "|---|---|---|",
             *(f"| {name} | {values['height of the sonar']:.6e} | {values['distance of the wall']:.6e} |"
               for name, values in (("closed form", truth), ("tubefoot", exact_values)))]
    lines += [f"| without the border, {name} | {value:+.2e} | 0 |" for name, value in without.items()]
    lines += ["", "The closed form is for a narrow fan. Its relative error is about the square of the fan's width.", "",
              "## Finite differences of rays", "",
              f"The ray engine computes energies for two values of the height or distance that differ by {2 * STEP_M * 100:g} cm. Both runs use",
              f"the same seed. The error is the root mean square of {draws} seeds, relative to the exact derivative. It includes the error of the step.", "",
              "![Error of central differences of the ray engine over the number of rays](pictures/gradients-rays.svg)", "",
              "| derivative by | rays | relative error | wrong signs | processor time / exact gradient |", "|---|---|---|---|---|"]
    for name, count, error, wrong, seconds in rows:
        lines.append(f"| {name} | {count} | {error:.2g} | {wrong} of {draws} | {seconds / exact_seconds:.2f} |")
    lines += ["", at_equal_time(rows, exact_seconds), "", "## Certified answers", "",
              "[answers.json](gradients/answers.json) contains certified derivatives of two small scenes, which `answers.py` writes. Engines",
              "with derivatives can be compared with them."]
    return "\n".join(lines) + "\n"


def chart(rows, folder):
    lines = {name: ([r[1] for r in rows if r[0] == name], [r[2] for r in rows if r[0] == name]) for name in PARAMETERS}
    panel = plot.panel("Central differences of rays", "rays per beam", "relative error of the derivative", lines,
                       log=(True, True), size=(560, 340), corner="low left")
    plot.sheet(folder / "gradients-rays.svg", [panel], columns=1)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("page", "figures"):
        parser.add_argument(name, type=lambda word: pathlib.Path(word).resolve())
    parser.add_argument("--draws", type=int, default=16)
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    rays, draws = (RAYS[:2], 2) if options.quick else (RAYS, options.draws)
    values, seconds, rows = measure(rays, draws)
    chart(rows, options.figures)
    options.page.write_text(page(values, seconds, rows, draws))


if __name__ == "__main__":
    main()
