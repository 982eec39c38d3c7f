#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Engines of others on scenes of ours: run.py PROGRAM HURRIED_RAYS FOLDER [--page PAGE --results FILE] [--scene DIR]...

Makes FOLDER: for each scene the certified truth and its solid angles, for each engine its picture as it leaves it, the
echo file that `tubefoot import` makes of that, a recipe of the engine's measure, and what `tubefoot compare` says of it, twice: as if the numbers
were energies, fitted, and in the engine's own measure. PAGE and FILE get what was found, held against what is known to be
wrong by construction (each engine's known()). An engine whose Python library is missing is left out, and that is told.
"""
import argparse
import importlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time
import types

import netCDF4

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import report  # noqa: E402
from real_engine import Absent  # noqa: E402
from sonar import Scene, Sonar, Unsupported  # noqa: E402

ENGINES = ["embree_hurry", "stonefish_like", "dave_like", "holoocean_like", "holoocean_noisy", "simple_rays"]
# Engines of others, built from folders that the environment names: real_engine.py.
REAL_ENGINES = ["stonefish", "stonefish_near", "stonefish_default", "simple_sonar"]
PACK = HERE.parent / "reference" / "v1"
SCENES = [HERE / "yard", PACK / "sphere", PACK / "box-and-wall", PACK / "terrain"]
REAL_SCENES = [*SCENES, HERE / "cornice"]
TOLERANCE = "1e-6"


def without_objects(text, names):
    """The scene file without these objects."""
    for name in names:
        text, removed = re.subn(r'\[\[objects\]\]\s*\nname = "%s"\n(?:[^\[\n][^\n]*\n)*' % re.escape(name), "", text)
        if removed != 1:
            raise Unsupported(f"no single object '{name}' in the scene file")
    return text


def of_solid_angles(text):
    """docs/engine-validation.md: every material scatters by the cosine of incidence, and nothing is absorbed."""
    text = re.sub(r"^lambert_db = .*$", 'law = "gsab"\noblique_db = 0\noblique_exponent = 1\nunbounded = true', text, flags=re.M)
    return re.sub(r"^absorption_db_per_km = .*$", "absorption_db_per_km = 0", text, flags=re.M)


class Truth:
    """Certified echoes of a scene, made when they are asked for."""

    def __init__(self, program, scene, folder):
        self.program, self.scene, self.folder = program, scene, folder
        self.made, self.scenes = {}, {}

    def file(self, without=(), angles=False, options=("--reference", "--tolerance", TOLERANCE)):
        key = (tuple(without), angles, tuple(options))
        if key not in self.made:
            text = without_objects((self.scene / "scene.toml").read_text(), without)
            text = re.sub(r'^file = "([^/].*)"$', lambda m: f'file = "{(self.scene / m[1]).resolve()}"', text, flags=re.M)
            name = f"truth{len(self.made)}"
            path = self.folder / f"{name}.toml"
            text = of_solid_angles(text) if angles else text
            # With --again, the reference of the same scene is present.
            if not (path.exists() and path.read_text() == text and (self.folder / name / "echoes.nc").exists()):
                path.write_text(text)
                call([self.program, "run", path, "-o", self.folder / name, "--quiet", "--pictures", "none", *options])
            self.made[key] = self.folder / name / "echoes.nc"
            self.scenes[key] = path
        return self.made[key]

    def scene_file(self):
        """The scene of the reference, with absolute names of its meshes."""
        self.file()
        return next(iter(self.scenes.values()))

    def __call__(self, without=(), angles=False):
        with netCDF4.Dataset(self.file(without, angles)) as file:
            file.set_auto_mask(False)
            energy = file["energy"][0]
            return energy * file["slant_range"][:] ** 2 if angles else energy


def call(words):
    # As a reader would call it from here: pictures bear the names of their files.
    words = [os.path.relpath(word) if isinstance(word, pathlib.Path) else str(word) for word in words]
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"{' '.join(words)}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done


def imported(words):
    """What `tubefoot import` says against what was declared."""
    return re.findall(r"^warning: (.*)$", call(words).stderr, re.M)


def write_recipe(path, title, solid_angles, steps):
    lines = [f'title = "{title}"', f'solid_angles = "{solid_angles}"']
    for step in steps:
        lines += ["", "[[steps]]"] + [f"{key} = {json.dumps(value)}" for key, value in step.items()]
    path.write_text("\n".join(lines) + "\n")


def figures(path):
    """What of a comparison's JSON the results keep."""
    sensor = json.loads(path.read_text())["sensors"][0]
    kept = {name: sensor[name] for name in ("l1_error", "rms_db_error", "energy_ratio_db", "empty_where_lit", "lit_bins",
                                            "lit_where_shadow", "shadow_bins")}
    kept["first_return_m"] = sensor["first_return"]["mean_m"]
    kept["bound_l1"] = (sensor["within_bound"] or {}).get("bound_l1")
    kept["shadow_overlap"] = sensor["geometry"]["shadow"]["iou"]
    if "fit" in sensor:
        kept["rank_correlation"] = sensor["unitless"]["rank_correlation"]
        kept["fit"] = {name: sensor["fit"][name]["value"] for name in ("gain_db", "range_exponent", "offset")
                       if isinstance(sensor["fit"].get(name), dict)}
    kept["l1"] = sensor["diagnosis"]["l1"]
    kept["findings"] = [{key: value for key, value in finding.items() if key != "look_for"}
                        for finding in sensor["diagnosis"]["findings"]]
    if "ideal" in sensor:
        kept["ideal"] = {name: sensor["ideal"][name] for name in ("sampling", "l1_error", "explains")}
    return rounded(kept)


def rounded(value):
    """Four digits: the results do not change with the last bits of a library."""
    if isinstance(value, dict):
        return {key: rounded(v) for key, v in value.items()}
    if isinstance(value, list):
        return [rounded(v) for v in value]
    return float(f"{value:.4g}") if isinstance(value, float) else value


def run_engine(name, scene_folder, truth, tools, folder, quick):
    """What one engine makes of one scene, and what is said of it; None if the engine cannot run here."""
    try:
        engine = importlib.import_module(name)
        scene, sonar = Scene(scene_folder / "scene.toml"), Sonar(truth.file())
        started = time.monotonic()
        if not (folder / engine.PICTURE).exists():
            engine.render(scene, sonar, folder / engine.PICTURE, tools)
    except Unsupported as error:
        print(f"omitted: {name}: {error}", flush=True)
        return None
    except ImportError as error:
        print(f"omitted: {name}: {error}" + ("" if isinstance(error, Absent) else " (see packages.txt for the packages of Debian)"),
              flush=True)
        return None
    seconds = time.monotonic() - started
    candidate, recipe = folder / "echoes.nc", folder / "recipe.toml"
    options = engine.declared(sonar)
    write_recipe(recipe, engine.TITLE, truth.file(angles=True), engine.recipe(scene, sonar))
    said = imported([tools.program, "import", folder / engine.PICTURE, "--like", truth.file(), *options, "--output-model", recipe,
                     "-o", candidate])
    with netCDF4.Dataset(candidate) as file:
        number = len(file.dimensions["ping"])
    common = [tools.program, "compare", truth.file(), candidate, "--scene", truth.scene_file(), "--geometry", "--diagnose", "--worst", 0]
    common += ["--frames", number] if number > 1 else []
    ideal = ["--ideal", engine.IDEAL] if engine.IDEAL and not quick else []
    call([*common, "--output-model", recipe, *ideal, "--json", folder / "own.json", "--html", folder / "own.html",
          "--png", folder / "own.png"])
    result = {"import": {"options": " ".join(options), "said": said}, "own": figures(folder / "own.json"), "known": [] if quick else [vars(k) for k in engine.known(scene, sonar, truth)]}
    if not quick:
        try:
            call([*common, "--fit", "gain,range,offset", "--json", folder / "joules.json", "--html", folder / "joules.html"])
            result["joules"] = figures(folder / "joules.json")
        except RuntimeError as error:
            # A scene of a single strip has too few echoes for a fit. Its page has no figures as energies.
            if "--fit is not possible" not in str(error):
                raise
    if hasattr(engine, "version"):
        result["version"] = engine.version()
    result = rounded(result)
    print(f"{scene_folder.name:14} {engine.TITLE}: rendered in {seconds:.1f} s; "
          f"found {', '.join(f['fault'] for f in result['own']['findings']) or 'nothing'}", flush=True)
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=lambda word: pathlib.Path(word).resolve())
    parser.add_argument("hurried_rays", type=lambda word: pathlib.Path(word).resolve(), help="tubefoot_hurried_rays.so")
    parser.add_argument("folder", type=lambda word: pathlib.Path(word).resolve(), help="output folder, which is replaced")
    parser.add_argument("--scene", type=pathlib.Path, action="append", help="folders with scene.toml (default: yard and three scenes of the suite)")
    parser.add_argument("--engine", action="append", choices=ENGINES + REAL_ENGINES,
                        help="(default: all that are written here)")
    parser.add_argument("--real", action="store_true", help="default: engines of others, built from given sources, and their scenes")
    parser.add_argument("--results", type=pathlib.Path, help="write the results into this JSON file")
    parser.add_argument("--page", type=pathlib.Path, help="write this page, with its pictures in the folder pictures/")
    parser.add_argument("--again", action="store_true", help="keep the pictures and references of FOLDER, and repeat the comparison only")
    parser.add_argument("--quick", action="store_true", help="only in the units of the engine, without --ideal")
    asked = parser.parse_args()
    scenes, engines = asked.scene or (REAL_SCENES if asked.real else SCENES), asked.engine or (REAL_ENGINES if asked.real else ENGINES)
    if not asked.again:
        shutil.rmtree(asked.folder, ignore_errors=True)
    tools = types.SimpleNamespace(program=asked.program, hurried_rays=asked.hurried_rays)
    results = {}
    for scene in scenes:
        scene = scene.resolve()
        place = asked.folder / scene.name
        place.mkdir(parents=True, exist_ok=True)
        truth = Truth(asked.program, scene, place)
        for name in engines:
            (place / name).mkdir(exist_ok=True)
            found = run_engine(name, scene, truth, tools, place / name, asked.quick)
            if found:
                results.setdefault(name, {})[scene.name] = found
                if asked.results:
                    asked.results.write_text(json.dumps(results, indent=1) + "\n")
    if asked.page:
        report.write_page(asked.page, HERE / ("real" if asked.real else "") / "page.md", results, asked.folder, scenes[0].name)


if __name__ == "__main__":
    main()
