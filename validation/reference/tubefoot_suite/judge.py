# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares a folder of results with the answers of a suite, scene by scene."""
import json

import numpy as np

from .echoes import Refused, array_in, errors_of, sensors_of
from .measures import MEASURES, measures_of
from .strength import strength_entry

STRENGTH_MEASURES = "kirchhoff_db", "boundary_db"
FIRST = "range-law"  # its gain and power of range are removed from the other scenes, which then show other errors


def about(pack):
    """Version, set and seed of a suite; version 1 has no pack.json."""
    file = pack / "pack.json"
    if not file.exists():
        return {"version": "1", "set": "debug"}
    try:
        content = json.loads(file.read_text())
        float(content["version"])
        secret = pack / "answers" / "seed.json"  # since version 3; participants do not get the answers
        if secret.exists():
            content["seed"] = json.loads(secret.read_text())["seed"]
        return {key: content[key] for key in ("version", "set", "seed") if key in content}
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise Refused(f"{file}: does not describe a benchmark suite: {error!r}: write the suite again") from error


def scene_in(pack, name):
    """Content of scene.json, with the arrays that measures need."""
    file = pack / "scenes" / name / "scene.json"
    try:
        scene = json.loads(file.read_text())
        scene["limits"] = {judged["measure"]: judged["limit"] for judged in scene["judged_by"]}
        if "body" in scene:
            known = STRENGTH_MEASURES
            scene["azimuths_deg"], scene["frequencies_hz"] = ([float(value) for value in scene[key]]
                                                              for key in ("azimuths_deg", "frequencies_hz"))
        else:
            known, samples = MEASURES, scene["samples"]
            scene["range"] = samples["first_m"] + (np.arange(samples["count"]) + 0.5) * samples["step_m"]
            # Beams across the track have no azimuths.
            scene["azimuth"] = None if "sectors" in scene["beams"] else np.array(scene["beams"]["axes_deg"])
        unknown = scene["limits"].keys() - set(known)
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise Refused(f"{file}: not a scene of a benchmark suite: {error!r}") from error
    if unknown:
        raise Refused(f"{pack}: unknown measure {', '.join(sorted(unknown))} of scene {name}: use the checker of this suite")
    answers = pack / "answers" / name
    if (answers / "sharp.npy").exists():
        scene["sharp"] = array_in(answers / "sharp.npy")
    if "gradient" in scene:
        scene["gradient_reference"] = array_in(answers / "gradient.npy", "parameter")
    return scene


def pack_scenes(pack):
    """Name and echoes of each scene with an answer, and the content of scene.json that measures need."""
    files = sorted((pack / "answers").glob("*/energy.npy")) or sorted(pack.glob("*/echoes.nc"))
    if not files and not strength_scenes(pack):
        raise Refused(f"{pack}: found no answers: expected answers/NAME/energy.npy (v2, v3) or NAME/echoes.nc (v1)")
    for file in sorted(files, key=lambda file: (file.parent.name != FIRST, file.parent.name)):
        name = file.parent.name
        if file.suffix == ".nc":
            sensors, _ = sensors_of(file)
            yield name, next(iter(sensors.values())), None
            continue
        scene = scene_in(pack, name)
        bound = file.parent / "bound.npy"
        yield name, {"energy": array_in(file), "range": scene["range"], "azimuth": scene["azimuth"],
                     "bound": array_in(bound) if bound.exists() else None}, scene


def strength_scenes(pack):
    return sorted(file.parent.name for file in (pack / "answers").glob("*/strength.csv"))


def result_of(results, name):
    found = [file for file in (results / f"{name}.npy", results / f"{name}.nc", results / name / "energy.npy",
                               results / name / "echoes.nc") if file.exists()]
    if not found:
        return None
    sensors, _ = sensors_of(found[0])
    if len(sensors) != 1:
        raise Refused(f"{found[0]}: expected one sensor, found {len(sensors)}")
    return next(iter(sensors.values()))


def gradient_of(results, name, shape):
    found = [file for file in (results / f"{name}-gradient.npy", results / name / "gradient.npy") if file.exists()]
    if not found:
        return None
    gradient = array_in(found[0], "parameter")
    if gradient.shape != shape or not np.all(np.isfinite(gradient)):
        raise Refused(f"{found[0]}: expected finite derivatives by {shape[0]} parameters, {shape[1]} beams and {shape[2]} samples, "
                      f"but the array has the shape {gradient.shape}: use the parameters of scene.json")
    return gradient


def judged(scene, r, c, version, relative):
    """Measures of a scene by name: value, standard error, limit, and whether the value is within the limit."""
    found = {}
    for name, limit in scene["limits"].items():
        value, error = measures_of(version)[name](scene, r, c)
        kept = bool(abs(value) - 2 * error <= limit) or relative and name == "gain_db"
        value = float(value) if np.isfinite(value) else None  # too few samples for an estimate
        found[name] = {"value": value, "standard_error": float(error), "limit": limit, "kept": kept}
    return found


def compare_suite(pack, results, relative=False):
    """Returns the report on a folder of results. Throws Refused if nothing can be compared."""
    suite = about(pack)
    scenes, missing, first = [], [], None
    for name, reference, scene in pack_scenes(pack):
        try:
            candidate = result_of(results, name)
            errors = candidate and errors_of(name, reference, candidate)
            gradient = None
            if scene is not None and "gradient" in scene:
                gradient = gradient_of(results, name, scene["gradient_reference"].shape)
        except Refused as refused:
            scenes.append({"scene": name, "agrees": False, "refused": str(refused)})
            continue
        if candidate is None or scene is not None and "gradient" in scene and gradient is None:
            missing.append(name)
            continue
        entry = {"scene": name, "errors": errors}
        if scene is not None:
            law = 10 ** (first["gain_db"] / 10) * scene["range"] ** first["range_exponent"] if first else 1.0
            if gradient is not None:
                scene["gradient_candidate"] = gradient / law
            measures = judged(scene, reference["energy"], candidate["energy"] / law, float(suite["version"]), relative)
            entry.update(tests=scene["tests"], measures=measures)
            entry["agrees"] = all(measure["kept"] for measure in entry["measures"].values())
            if name == FIRST and (relative or not entry["agrees"]):
                law, gain = entry["measures"]["range_exponent"], entry["measures"]["gain_db"]["value"]
                if law["value"] is not None and gain is not None:
                    first = {"gain_db": gain, "range_exponent": 0.0 if law["kept"] else law["value"]}
        scenes.append(entry)
    for name in strength_scenes(pack):
        scene = scene_in(pack, name)
        try:
            entry = strength_entry(pack, results, name, scene)
        except Refused as refused:
            entry = {"scene": name, "agrees": False, "refused": str(refused)}
        missing.append(name) if entry is None else scenes.append(entry)
    if not scenes:
        raise Refused(f"{results}: found no result of any scene of {pack}: --help lists the file names")
    return {"suite": suite, "taken_off": first, "missing": missing, "scenes": scenes}


def summary(entry):
    if "aspects" in entry:
        levels = [f"{level:+.2f} dB from {name.replace('_', ' ')}" for name, level in entry["level_db"].items() if level is not None]
        return "median " + ", ".join(levels)
    errors = entry["errors"]
    share = errors["energy_ratio_db"]
    return (f"L1 {errors['l1_error'] or 0:8.2g}, {errors['rms_db_error']:5.2f} dB RMS, energy "
            + ("none" if share is None else f"{share:+.2f} dB"))


def print_report(report):
    for entry in report["scenes"]:
        verdict = {True: "agrees", False: "DIFFERS", None: ""}[entry.get("agrees")]
        if "refused" in entry:
            print(f"{entry['scene']:<17} {verdict:<8} cannot be compared: {entry['refused']}")
            continue
        print(f"{entry['scene']:<17} {verdict:<8} " + summary(entry))
        for name, measure in entry.get("measures", {}).items():
            error = f" +- {measure['standard_error']:.2g}" if measure["standard_error"] > 0 else ""
            value = "unknown" if measure["value"] is None else f"{measure['value']:+.4g}"
            print(f"    {name:<15} {value}{error} (at most {measure['limit']:g})"
                  + ("" if measure["kept"] or entry["agrees"] else f": error in {entry['tests']}"))
    if report["taken_off"]:
        print("removed from all other scenes: {gain_db:+.2f} dB and r^{range_exponent:+.3f}, found in ".format(**report["taken_off"])
              + FIRST)
    if report["missing"]:
        print("no result of: " + ", ".join(report["missing"]))
    wrong = [entry["scene"] for entry in report["scenes"] if entry.get("agrees") is False]
    if any("agrees" in entry for entry in report["scenes"]):
        print("differs in: " + (", ".join(wrong) or "nothing"))
