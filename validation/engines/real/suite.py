#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs engines of others on the benchmark suite: suite.py PROGRAM SUITE FOLDER [--engine NAME]... [--entries FOLDER]

SUITE is a folder that `tubefoot suite` wrote. FOLDER gets, for each engine, its pictures and the results that the checker of the
suite reads. The values of a picture are taken as energies in one unit for all scenes. From the answers, `tubefoot import` uses only
the beams and range bins. With --entries, each engine gets an entry for the folder of results. Scenes that the input of these
engines cannot describe are left out, with the reason."""
import argparse
import datetime
import importlib
import json
import os
import pathlib
import platform
import shutil
import sys
import time
import types

import netCDF4
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path[:0] = [str(HERE.parent), str(HERE.parents[1] / "reference")]
from real_engine import Absent, call  # noqa: E402
from sonar import Sonar  # noqa: E402
from tubefoot_suite import compare_suite  # noqa: E402
from tubefoot_suite.__main__ import text_of  # noqa: E402
from tubefoot_suite.judge import print_report  # noqa: E402
from tubefoot_suite.submission import submission  # noqa: E402

ENGINES = ["stonefish", "stonefish_near", "stonefish_default", "simple_sonar"]


def left_out(scene):
    """Why the input of these engines cannot describe a scene, from its scene.json; None if it can."""
    if "body" in scene:
        return "no target strengths"
    water, beams = scene["water"], scene["beams"]
    reasons = {
        "no derivatives": "gradient" in scene,
        "no absorption": water["absorption_db_per_km"] > 0,
        "no sound speed profile": "gradient" in water,
        "no scattering in the water": "volume_scattering_per_m" in water,
        "no reflections at the sea surface": "sea_surface" in scene,
        "one scattering per path": scene.get("bounces", {}).get("scatterings", 1) > 1,
        "no side lobes": "receive" in beams,
        "no diffraction": "shadow" in beams,
        "no transmit sectors": "sectors" in beams,
        "no separate receiver": any("receiver_m" in ping for ping in scene["pings"]),
        "equiangular beams only": not np.allclose(np.diff(beams["axes_deg"]), np.diff(beams["axes_deg"])[0], atol=1e-9),
    }
    return next((reason for reason, applies in reasons.items() if applies), None)


def energies_of(engine, folder, answer, scene_file, pings, strengths, tools):
    """Numbers of the engine with the dimensions ping, beam, sample."""
    pictures = folder / "pictures"
    pictures.mkdir(parents=True)
    for ping in range(pings):
        place = folder / f"ping-{ping}"
        place.mkdir()
        sonar = Sonar(answer, ping)
        engine.render(types.SimpleNamespace(path=scene_file), sonar, place / engine.PICTURE, tools)
        shutil.copy(place / engine.PICTURE, pictures / f"{ping:04d}{pathlib.Path(engine.PICTURE).suffix}")
    call([tools.program, "import", pictures, "--like", answer, *engine.declared(sonar), "-o", folder / "echoes.nc"])
    with netCDF4.Dataset(folder / "echoes.nc") as file:
        return np.ma.filled(file["energy"][:], 0) * engine.unit(strengths)


def run(engine, suite, folder, tools):
    """Returns the reasons of scenes left out, and the seconds of all pictures."""
    results, reasons, seconds = folder / "results", {}, 0
    results.mkdir(parents=True)
    for file in sorted((suite / "scenes").glob("*/scene.json")):
        scene, name = json.loads(file.read_text()), file.parent.name
        if reason := left_out(scene):
            reasons[name] = reason
            continue
        started = time.monotonic()
        energy = energies_of(engine, folder / name, suite / "answers" / name / "echoes.nc", file.parent / "scene.toml",
                             len(scene["pings"]), [surface["mu"] for surface in scene["surfaces"]], tools)
        np.save(results / f"{name}.npy", energy)
        seconds += time.monotonic() - started
        print(f"{engine.TITLE}: {name}: {time.monotonic() - started:.1f} s", flush=True)
    return reasons, seconds


def description(engine, name, reasons, seconds):
    system = platform.freedesktop_os_release()["PRETTY_NAME"]
    named = "; ".join(f"{scene} ({reason})" for scene, reason in reasons.items())
    about = {"engine": engine.TITLE, "engine_version": engine.version().split(None, 1)[1],
             "submitted_by": "The tubefoot developers", "date": datetime.date.today().isoformat(),
             "machine": f"{os.cpu_count()} cores, {platform.machine()}, {system}",
             "how": f"validation/engines/real/suite.py build/release/tubefoot SUITE FOLDER --engine {name}", "url": engine.URL,
             "seconds": round(seconds),
             "remarks": "Run by the tubefoot developers, and not reviewed by those of the engine. The values of its pictures are taken "
             f"as energies. Scenes that its input cannot describe are left out: {named}."}
    return about | ({"licence": engine.LICENCE} if hasattr(engine, "LICENCE") else {})


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name in ("program", "suite", "folder"):
        parser.add_argument(name, type=lambda word: pathlib.Path(word).resolve())
    parser.add_argument("--engine", action="append", choices=ENGINES, help="(default: all)")
    parser.add_argument("--entries", type=lambda word: pathlib.Path(word).resolve(), help="folder of entries, validation/results/entries")
    asked = parser.parse_args()
    tools = types.SimpleNamespace(program=asked.program)
    for name in asked.engine or ENGINES:
        engine, folder = importlib.import_module(name), asked.folder / name
        shutil.rmtree(folder, ignore_errors=True)
        try:
            engine.version()
        except Absent as error:
            print(f"omitted: {name}: {error}", flush=True)
            continue
        reasons, seconds = run(engine, asked.suite, folder, tools)
        report = compare_suite(asked.suite, folder / "results", relative=True)
        print_report(report)
        if asked.entries:
            entry = submission(report, description(engine, name, reasons, seconds), True)
            file = f"{name.replace('_', '-')}-{report['suite']['version']}-{report['suite']['set']}.json"
            (asked.entries / file).write_text(text_of(entry) + "\n")


if __name__ == "__main__":
    main()
