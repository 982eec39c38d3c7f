#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the eigenrays of tubefoot with the arrivals and rays of BELLHOP or bellhopcxx.

bellhop.py TUBEFOOT [ENGINE...] [--page FILE] [--quick]: ENGINE is a program of build_bellhop.py, or a folder of sources,
which is built first. The default is the environment variable TUBEFOOT_BELLHOP_SOURCES, with colons between folders. Writes the page validation/bellhop.md with --page. With --quick, only short cases are run, and the exit code is
1 if a difference exceeds what the steps and the file of the engine explain. Exit code 77: no ENGINE is present."""

import argparse
import collections
import csv
import datetime
import math
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
BUILD = HERE.parent / "engines" / "real" / "build_bellhop.py"
SOURCES = "TUBEFOOT_BELLHOP_SOURCES"
DEPTHS = "200,800,1500,2500,4000"

INTRODUCTION = """
# Comparison with BELLHOP

This page compares eigenrays of [`tubefoot rays`](../docs/rays.md) with BELLHOP (Fortran) and with its C++ translation bellhopcxx.
It is for readers who need to know the errors of both methods.

```text
python3 validation/engines/real/build_bellhop.py SOURCES out/bellhop
python3 validation/rays/bellhop.py build/release/tubefoot out/bellhop/sources/Bellhop/bellhop.exe --page validation/bellhop.md
```

`tubefoot rays --environment` writes the environment files. The source is at a depth of 1000 m. The points are at depths of 200,
800, 1500, 2500 and 4000 m, over a rigid bottom at 5000 m. Rays have up to two reflections. The last rows show the scene
`layered-water` of the [benchmark suite](../docs/reference-results.md), whose points lie on its seabed.

- *Found* counts the eigenrays for which the engine has an arrival with the same reflections. The launch angle of the arrival
  differs by at most three steps of the beams.
- *Time*, *launch*, *arrival* and *loss* are absolute differences between these arrivals and tubefoot. The loss excludes absorption.
- *Miss* is the distance of the point from a ray of the engine that is launched at the angle of tubefoot.

Each cell contains the median and the largest value. The automatic step of BELLHOP is a tenth of the water depth, here 500 m.

## Findings

- Both engines converge to tubefoot with the square of the step. In the gradient at 100 km, the misses are 0.25, 0.010 and 0.0001 m.
- The miss at the automatic step depends on the profile. It is 0.25 m in the gradient at 100 km. In the Munk profile, bellhopcxx
  misses by 0.05 m, and BELLHOP by 22 m.
- Arrival files contain times in single precision. Neighbouring numbers are 0.5 µs apart at 6.7 s, and 7.6 µs apart at 67 s. With
  steps of 10 m, this spacing explains the differences in time.
- In the Munk profile with the automatic step, BELLHOP finds three of eight eigenrays at 100 km, and bellhopcxx finds all. Both
  programs agree with steps of 10 m. With large steps, use a smooth profile with few points.
- The arrival angle of BELLHOP is the direction of the last step. Its error is proportional to the step.
- The largest differences in loss occur near false caustics, which the borders of layers cause.
"""

Case = collections.namedtuple("Case", "name water source ranges depths bottom reflections steps beams")


def munk(depth):
    eta = 2 * (depth - 1300) / 1300
    return 1500 * (1 + 0.00737 * (eta + math.exp(-eta) - 1))


def table(points):
    return "depth_m,sound_speed_m_s\n" + "".join(f"{z!r},{c!r}\n" for z, c in points)


def cases(quick):
    deep = [("isovelocity, 1500 m/s", table([(0, 1500), (5000, 1500)])),
            ("gradient, 1500 + 0.016 z", table([(0, 1500), (5000, 1580)])),
            ("Munk, layers of 10 m", table([(z, munk(z)) for z in range(0, 5001, 10)]))]
    if quick:
        return [Case(name, water, "0,0,-1000", ["10km"], DEPTHS, 5000, 2, [0, 10], 4001) for name, water in deep[:2]]
    found = []
    for name, water in deep:
        steps = [0] if name.startswith("iso") else [0, 100, 10]  # straight rays do not depend on the step
        found += [Case(name, water, "0,0,-1000", [place], DEPTHS, 5000, 2, steps, beams)
                  for place, beams in (("10km", 10001), ("100km", 4001))]
    return found + [Case("suite, layered-water", None, None, ["16", "32", "48"], "20", None, 0, [0, 0.1], 4001)]


def tubefoot(program, *words):
    done = subprocess.run([program, *words], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"bellhop.py: {' '.join(map(str, words))}: {done.stderr}")
    return done


def engine_run(engine, env, text):
    """Runs an engine on an environment and returns the lines of its result."""
    root = env.with_suffix("")
    env.write_text(text)
    for old in (root.with_suffix(".arr"), root.with_suffix(".ray")):
        old.unlink(missing_ok=True)
    words = ["-mem=1GiB"] if "bellhopcxx" in pathlib.Path(engine).name else []
    subprocess.run([engine, *words, root.name], cwd=root.parent, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    for result in (root.with_suffix(".arr"), root.with_suffix(".ray")):
        if result.exists():
            return result.read_text().split("\n")
    sys.exit(f"bellhop.py: {engine} wrote no result for {env}:\n{root.with_suffix('.prt').read_text()[-2000:]}")


Arrival = collections.namedtuple("Arrival", "amplitude time launch arrival top bottom")


def arrivals(lines, depths, ranges):
    """Arrivals by (depth index, range index)."""
    numbers = iter(" ".join(lines[2:]).split())  # after dimension and frequency
    for _ in range(3):  # depths of the source, depths and ranges of the points
        for _ in range(int(next(numbers))):
            next(numbers)
    next(numbers)  # largest number of arrivals
    found = {}
    for depth in range(depths):
        for place in range(ranges):
            here = found[depth, place] = []
            for _ in range(int(next(numbers))):
                amplitude, _, time, _, launch, arrival = (float(next(numbers)) for _ in range(6))
                here.append(Arrival(amplitude, time, launch, arrival, int(next(numbers)), int(next(numbers))))
    return found


def last_depths(lines):
    """(launch angle, depth at the end) of each ray."""
    numbers = iter(" ".join(lines[7:]).split())
    ends = []
    for launch in numbers:
        count, _, _ = (int(next(numbers)) for _ in range(3))
        for _ in range(count):
            _, depth = float(next(numbers)), float(next(numbers))
        ends.append((float(launch), depth))
    return ends


def joined(here, ray, width):
    """The arrivals that belong to an eigenray, as one: neighbouring beams share its amplitude."""
    same = [a for a in here if abs(a.launch - float(ray["launch_down_deg"])) < width
            and a.top == int(ray["surface_reflections"]) and a.bottom == int(ray["bottom_reflections"])]
    total = sum(a.amplitude for a in same)
    if not total > 0:
        return None
    mean = lambda value: sum(value(a) * a.amplitude for a in same) / total
    return Arrival(total, mean(lambda a: a.time), mean(lambda a: a.launch), mean(lambda a: a.arrival), 0, 0)


def compare(program, engine, case, folder):
    """One row of figures for each range and step."""
    if case.water:
        (folder / "water.csv").write_text(case.water)
        water = ["--profile", folder / "water.csv", "--from", case.source]
    else:
        shutil.rmtree(folder / "suite", ignore_errors=True)
        tubefoot(program, "suite", "--scenes", "layered-water", "--without-answers", "-o", folder / "suite", "--quiet")
        water = [next((folder / "suite").rglob("scene.toml"))]
    if case.bottom:
        water += ["--bottom", str(case.bottom)]
    for place in case.ranges:
        env, rays_file = folder / "run.env", folder / "rays.csv"
        tubefoot(program, "rays", *water, "--ranges", place, "--depths", case.depths, "--reflections", str(case.reflections),
                 "-o", rays_file, "--environment", env, "--quiet")
        rays = [r for r in csv.DictReader(rays_file.open()) if r["eigenray"]]
        arrivals_env = env.read_text().split("\n")
        first, last = map(float, arrivals_env[-3].split()[:2])
        arrivals_env[-4] = str(case.beams)
        width = 3 * (last - first) / (case.beams - 1)
        angles = sorted({r["launch_down_deg"] for r in rays}, key=float)
        tubefoot(program, "rays", *water, "--angles=" + ",".join(angles), "--ranges", place, "-o", folder / "fan.csv",
                 "--environment", env, "--quiet")
        fan_env = env.read_text().split("\n")
        for step in case.steps:
            for lines in (arrivals_env, fan_env):
                lines[-2] = " ".join([repr(float(step)), *lines[-2].split()[1:]])
            found = arrivals(engine_run(engine, env, "\n".join(arrivals_env)), len(case.depths.split(",")), 1)
            ends = last_depths(engine_run(engine, env, "\n".join(fan_env)))
            row = collections.defaultdict(list)
            for ray in rays:
                launch, depth = float(ray["launch_down_deg"]), float(ray["depth_m"])
                end = min(ends, key=lambda e: abs(e[0] - launch))
                row["miss_m"].append(abs(end[1] - depth) * math.cos(math.radians(float(ray["arrival_down_deg"]))))
                index = sorted(map(float, case.depths.split(","))).index(depth)
                arrival = joined(found[index, 0], ray, width)
                if not arrival:
                    continue
                row["time_us"].append(abs(arrival.time - float(ray["time_s"])) * 1e6)
                row["launch_deg"].append(abs(arrival.launch - launch))
                row["arrival_deg"].append(abs(arrival.arrival - float(ray["arrival_down_deg"])))
                row["loss_db"].append(abs(-20 * math.log10(arrival.amplitude) - float(ray["spreading_loss_db"])))
            yield {"case": case.name, "range": place, "step": step, "rays": len(rays), "found": len(row["time_us"]),
                   **{k: (statistics.median(v), max(v)) for k, v in row.items()}}


def shown(pair, digits=2):
    return " / ".join(f"{value:.{digits}g}" for value in pair) if pair else "-"


def page(results, revisions):
    commit = subprocess.run(["git", "-C", HERE, "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()
    text = [INTRODUCTION.strip("\n"), "", f"Figures of {datetime.date.today()}, commit {commit}. No figure depends on the speed "
            "of the machine.", ""]
    for engine, rows in results.items():
        text += [f"## {revisions[engine][0]}", "", f"Revision {revisions[engine][1]}, built by "
                 "`validation/engines/real/build_bellhop.py`.", "",
                 "| water | range | step | eigenrays, found | time, µs | launch, degrees | arrival, degrees | loss, dB | miss, m |",
                 "|---|---|---|---|---|---|---|---|---|"]
        for row in rows:
            where = row["range"].replace("km", " km") if "km" in row["range"] else row["range"] + " m"
            step = f"{row['step']:g} m" if row["step"] else "automatic"
            text.append(f"| {row['case']} | {where} | {step} | {row['rays']}, {row['found']} | {shown(row.get('time_us'))} | "
                        f"{shown(row.get('launch_deg'))} | {shown(row.get('arrival_deg'))} | {shown(row.get('loss_db'))} | "
                        f"{shown(row.get('miss_m'))} |")
        text.append("")
    return "\n".join(text).rstrip("\n") + "\n"


def failures(rows):
    """What exceeds the known errors of the engine: single precision of times, second order in the step."""
    for row in rows:
        place = f"{row['case']}, {row['range']}, step {row['step']}"
        if row["found"] < row["rays"]:
            yield f"{place}: found {row['found']} of {row['rays']} eigenrays"
        if row["step"] and row["time_us"][0] > 3:
            yield f"{place}: median difference of {row['time_us'][0]:.2f} us"
        if row["step"] and row["miss_m"][1] > 0.01:
            yield f"{place}: a ray misses by {row['miss_m'][1]:.3f} m"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("tubefoot", type=pathlib.Path)
    parser.add_argument("engines", nargs="*")
    parser.add_argument("--page", type=pathlib.Path)
    parser.add_argument("--quick", action="store_true")
    asked = parser.parse_args()
    program, results, revisions, wrong = asked.tubefoot.resolve(), {}, {}, []
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        for number, engine in enumerate(asked.engines or filter(None, os.environ.get(SOURCES, "").split(":"))):
            engine = pathlib.Path(engine).resolve()
            if engine.is_dir():
                built = subprocess.run([sys.executable, BUILD, engine, folder / f"engine{number}"], capture_output=True, text=True)
                if built.returncode != 0:
                    print(f"bellhop.py: skipped: {built.stderr.strip()}")
                    continue
                engine = pathlib.Path(built.stdout.strip())
            if not engine.is_file():
                print(f"bellhop.py: skipped: there is no {engine}")
                continue
            version = next((p / "version.txt" for p in engine.parents if (p / "version.txt").is_file()), None)
            revisions[engine] = version.read_text().split("\n") if version else [engine.name, "unknown"]
            results[engine] = []
            for case in cases(asked.quick):
                for row in compare(program, engine, case, folder):
                    print(revisions[engine][0], row, flush=True)
                    results[engine].append(row)
            wrong += failures(results[engine]) if asked.quick else []
    if not results:
        print("bellhop.py: skipped: no engine is present; name a folder of sources in " + SOURCES)
        return 77
    if asked.page:
        asked.page.write_text(page(results, revisions))
    for words in wrong:
        print("FAIL", words)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
