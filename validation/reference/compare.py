#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the echoes of a candidate with a reference, as `tubefoot compare` does, without tubefoot.

    compare.py REFERENCE CANDIDATE [--json]   two files of echoes: netCDF or NumPy's .npy (ping, beam, sample)
    compare.py SUITE RESULTS [--json]         a benchmark suite (v1 or v2) and a folder of results; the result of scene
                                              NAME is NAME.npy, NAME.nc, NAME/energy.npy or NAME/echoes.nc

For a suite, compare.py prints which scenes agree, and which measures of the others exceed their limits. With --relative,
energies may be in any one unit. The program needs NumPy, and netCDF4 for netCDF files. Exit status: 0 all scenes agree;
3 some scenes differ; 2 the files cannot be compared."""
import argparse
import json
import pathlib
import sys

import numpy as np

LIT_SHARE_OF_MEAN = 1e-3
LARGEST_ERROR_DB = 30.0
SAMPLE_SHARE, AZIMUTH_TOLERANCE_DEG = 0.01, 1e-3


class Refused(Exception):
    """The two files cannot be compared; the message says why and what to do."""


# Units of energy density. Files of version 0.1 and earlier say J and mean J/m^2.
ENERGY_UNITS = "J m-2", "J"


def values_of(file, sensor, name, dimensions, *units):
    if name not in sensor.variables:
        raise Refused(f"{file}: no variable '{name}'")
    variable = sensor[name]
    if variable.dimensions != dimensions:
        raise Refused(f"{file}: '{name}' has dimensions {variable.dimensions}, not {dimensions}")
    if getattr(variable, "units", None) not in units:
        raise Refused(f"{file}: '{name}' must have units '{units[0]}', not '{getattr(variable, 'units', None)}'")
    values = np.ma.filled(variable[:].astype(np.float64), np.nan)
    if not np.all(np.isfinite(values)):
        raise Refused(f"{file}: '{name}' has missing or infinite values: write zeros into samples without an echo")
    return values


def array_in(path):
    try:
        energy = np.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError) as error:
        raise Refused(f"{path}: cannot read the file: {error}") from error
    if energy.ndim != 3 or energy.dtype.kind != "f":
        raise Refused(f"{path}: expected floating-point numbers with the dimensions ping, beam and sample, but the array has "
                      f"{energy.ndim} dimensions and the type {energy.dtype}")
    return energy.astype(np.float64)


def sensors_of(path):
    """Name, energies and axes of every sensor; a sensor is a group, or the whole file if there are no groups."""
    if str(path).endswith(".npy"):
        energy = array_in(path)
        if not np.all(np.isfinite(energy)) or np.any(energy < 0):
            raise Refused(f"{path}: has negative values or values that are not finite: write zeros into samples without an echo")
        return {"sensor": {"energy": energy, "range": None, "azimuth": None, "bound": None}}, ""
    try:
        import netCDF4
    except ImportError as error:
        raise Refused(f"{path}: netCDF files need Python's netCDF4 (Debian: python3-netcdf4)") from error
    bins = ("ping", "beam", "sample")
    try:
        file = netCDF4.Dataset(path)
    except OSError as error:
        raise Refused(f"{path}: cannot read the file: {error}") from error
    sensors = {}
    with file:
        for sensor in list(file.groups.values()) or [file]:
            name = getattr(sensor, "sensor_name", "sensor" if sensor is file else sensor.name)
            echoes = {"energy": values_of(path, sensor, "energy", bins, *ENERGY_UNITS),
                      "range": values_of(path, sensor, "slant_range", ("sample",), "m"),
                      "azimuth": values_of(path, sensor, "beam_azimuth", ("beam",), "degree"),
                      "bound": None}
            if "energy_bound" in sensor.variables:
                echoes["bound"] = values_of(path, sensor, "energy_bound", bins, *ENERGY_UNITS)
            if np.any(echoes["energy"] < 0):
                raise Refused(f"{path}: 'energy' has negative values")
            sensors[name] = echoes
        return sensors, getattr(file, "scene_hash", "")


def check(reference, candidate):
    if reference["energy"].shape != candidate["energy"].shape:
        raise Refused(f"the reference has {reference['energy'].shape} pings, beams and samples, but the candidate has "
                      f"{candidate['energy'].shape}: use the numbers of the reference")
    if reference["range"] is None or candidate["range"] is None:
        return  # an array has a shape only
    ranges = reference["range"]
    step = ranges[1] - ranges[0] if len(ranges) > 1 else ranges[0]
    if np.any(np.abs(candidate["range"] - ranges) > SAMPLE_SHARE * step):
        raise Refused("'slant_range' differs by more than 1 % of a sample: use the range samples of the reference")
    turn = (candidate["azimuth"] - reference["azimuth"] + 180) % 360 - 180
    if np.any(np.abs(turn) > AZIMUTH_TOLERANCE_DEG):
        raise Refused("'beam_azimuth' differs by more than 0.001 degree: use the beams of the reference in the same order")


def ratio(part, whole, candidate_total, if_both_zero):
    """Returns None if the reference is 0 and the candidate is not."""
    if whole > 0:
        return part / whole
    return None if candidate_total > 0 else if_both_zero


def first_return_errors(ranges, reference, candidate, threshold):
    """The first sample with an echo of each beam of each ping, candidate minus reference."""
    lit_r, lit_c = (e.reshape(-1, e.shape[-1]) > threshold for e in (reference, candidate))
    in_r, in_c = lit_r.any(axis=1), lit_c.any(axis=1)
    both = np.flatnonzero(in_r & in_c)
    result = {"in_both": both.size, "only_in_reference": int((in_r & ~in_c).sum()),
              "only_in_candidate": int((~in_r & in_c).sum()), "in_neither": int((~in_r & ~in_c).sum())}
    if both.size == 0:
        return result
    first_r, first_c = lit_r[both].argmax(axis=1), lit_c[both].argmax(axis=1)
    metres, samples = ranges[first_c] - ranges[first_r], first_c - first_r
    worst = int(np.abs(metres).argmax())
    ping, beam = divmod(int(both[worst]), reference.shape[1])
    result.update(mean_m=metres.mean(), mean_absolute_m=np.abs(metres).mean(),
                  mean_absolute_samples=np.abs(samples).mean(), largest_m=metres[worst],
                  largest_samples=int(samples[worst]), largest_ping=ping, largest_beam=beam)
    return result


def errors_of(name, reference, candidate, worst=5):
    check(reference, candidate)
    ranges = reference["range"]
    if ranges is None:
        ranges = np.arange(reference["energy"].shape[2]) if candidate["range"] is None else candidate["range"]
    r, c, bound = reference["energy"], candidate["energy"], reference["bound"]
    difference, total_r, total_c = np.abs(c - r), r.sum(), c.sum()
    threshold = LIT_SHARE_OF_MEAN * r[r > 0].mean() if np.any(r > 0) else 0.0
    lit, shadow = r > threshold, r == 0
    with np.errstate(divide="ignore", invalid="ignore"):
        decibels = np.clip(10 * np.log10(c / r), -LARGEST_ERROR_DB, LARGEST_ERROR_DB)
    decibels[c == r] = 0
    energy_ratio = ratio(total_c, total_r, total_c, 1.0)
    errors = {
        "name": name, "pings": r.shape[0], "beams": r.shape[1], "samples": r.shape[2],
        "l1_error": ratio(difference.sum(), total_r, total_c, 0.0),
        "rms_db_error": np.sqrt(np.mean(decibels[lit] ** 2)) if lit.any() else 0.0,
        "energy_ratio": energy_ratio,
        "energy_ratio_db": 10 * np.log10(energy_ratio) if energy_ratio else None,
        "reference_total_j": total_r, "candidate_total_j": total_c, "lit_threshold_j": threshold,
        "lit_bins": int(lit.sum()), "shadow_bins": int(shadow.sum()),
        "empty_where_lit": int((lit & (c == 0)).sum()),
        "lit_where_shadow": int((shadow & (c > threshold)).sum()),
        "first_return": first_return_errors(ranges, r, c, threshold),
        "within_bound": None, "worst_bins": []}
    if bound is not None:
        received, off = (r > 0) | (c > 0), difference.sum()
        errors["within_bound"] = {
            "bound_l1": ratio(bound.sum(), total_r, bound.sum(), 0.0),
            "share_of_difference": np.minimum(difference, bound).sum() / off if off > 0 else 1.0,
            "share_of_bins": (received & (difference <= bound)).sum() / received.sum() if received.any() else 1.0}
    for k in np.argsort(-difference, axis=None, kind="stable")[:worst]:
        ping, beam, sample = (int(i) for i in np.unravel_index(k, r.shape))
        at = ping, beam, sample
        if difference[at] > 0:
            errors["worst_bins"].append({
                "ping": ping, "beam": beam, "sample": sample, "slant_range_m": ranges[sample],
                "reference_j": r[at], "candidate_j": c[at], "error_db": decibels[at],
                "share_of_difference": difference[at] / difference.sum()})
    return errors


# ---- Packs: what a scene's class is judged by. Each measure is a value and its standard error.

def parts_of(scene, r, c):
    """Energies of reference and candidate, and their ranges: per plate if each beam has one range, else per block of samples."""
    ranges, by_beam = scene["range"], r.sum(axis=0)
    lit = by_beam.sum(axis=1) > 0
    mean = (by_beam @ ranges)[lit] / by_beam[lit].sum(axis=1)
    spread = np.sqrt(np.maximum((by_beam @ ranges**2)[lit] / by_beam[lit].sum(axis=1) - mean**2, 0))
    if np.all(spread < 0.03 * mean):
        of_beam = by_beam.sum(axis=1)
        parts = []
        for first, end in groups(lit):  # of beams that the plate fills: at edges, the sampling decides
            filled = [k for k in range(first, end) if of_beam[k] > 0.98 * of_beam[first:end].max()]
            parts.append((r[:, filled].sum(), c[:, filled].sum(), (by_beam[filled] @ ranges).sum() / of_beam[filled].sum()))
    else:
        sums = [x.sum(axis=(0, 1)) for x in (r, c)]
        parts = [(sums[0][k:k + 8].sum(), sums[1][k:k + 8].sum(), ranges[k:k + 8].mean()) for k in range(0, ranges.size, 8)]
        parts = [part for part in parts if part[0] > 1e-6 * r.sum()]
    return np.array([part for part in parts if part[1] > 0]).reshape(-1, 3)


def range_fit(scene, r, c, of_range):
    """ln(c / r) = a + b of_range(range): a, b and their standard errors."""
    parts = parts_of(scene, r, c)
    if len(parts) < 3:
        return 0.0, 0.0, np.inf, np.inf  # too few points for a fit
    return fit(np.stack([np.ones(len(parts)), of_range(parts[:, 2])], axis=1), np.log(parts[:, 1] / parts[:, 0]))


def fit(design, values):
    """Least-squares fit of two terms: the terms and their standard errors."""
    solution, _, _, _ = np.linalg.lstsq(design, values, rcond=None)
    left = values - design @ solution
    variance = left @ left / max(len(values) - design.shape[1], 1) * np.linalg.inv(design.T @ design)
    return (*solution, *np.sqrt(np.diag(variance)))


def groups(lit):
    """[first, end) of each run of adjacent beams."""
    steps = np.flatnonzero(np.diff(np.concatenate([[False], lit, [False]]).astype(int)))
    return list(zip(steps[::2], steps[1::2]))


def gain_db(scene, r, c):
    """Gain in dB; at 1 m if the power of range is wrong."""
    a, b, error, _ = range_fit(scene, r, c, np.log)
    parts = parts_of(scene, r, c)
    if len(parts) == 0:
        return -np.inf, 0.0
    if abs(b) <= scene["limits"]["range_exponent"]:
        a, error = np.log(parts[:, 1] / parts[:, 0]).mean(), 0.0
    return a * 10 / np.log(10), error * 10 / np.log(10)


def range_exponent(scene, r, c):
    _, b, _, error = range_fit(scene, r, c, np.log)
    return (b, error) if np.isfinite(error) else (np.inf, 0.0)


def db_per_km(scene, r, c):
    _, b, _, error = range_fit(scene, r, c, lambda x: x)
    scale = -1000 * 10 / (2 * np.log(10))  # there and back
    return (b * scale, error * abs(scale)) if np.isfinite(error) else (np.inf, 0.0)


def beams_off(scene, r, c):
    """Displacement of posts in beams: the largest value of a smooth curve over the fan (shift, scale, bend)."""
    by_beam = [x.sum(axis=(0, 2)) for x in (r, c)]
    runs = groups(by_beam[0] > 0)
    borders = [0] + [(a[1] + b[0]) // 2 for a, b in zip(runs, runs[1:])] + [len(by_beam[0])]
    beam, off = np.arange(len(by_beam[0])), []
    for (first, end), low, high in zip(runs, borders, borders[1:]):
        own, theirs = by_beam[0][low:high], by_beam[1][low:high]
        off.append((theirs @ beam[low:high] / theirs.sum() - own @ beam[low:high] / own.sum()) if theirs.sum() > 0
                   else (high - low) / 2)
    x = np.array([(a + b - 1) / 2 for a, b in runs]) / len(beam) * 2 - 1
    terms = np.stack([np.ones(x.size), x, x**3], axis=1)[:, :max(1, min(3, x.size - 2))]
    solution, _, _, _ = np.linalg.lstsq(terms, np.array(off), rcond=None)
    curve, left = terms @ solution, np.array(off) - terms @ solution
    return np.abs(curve).max(), np.sqrt(left @ left / max(x.size - terms.shape[1], 1) * terms.shape[1] / x.size)


def side_lobes_db(scene, r, c):
    beams = [x.sum(axis=(0, 2)) for x in (r, c)]
    beside = np.abs(np.arange(len(beams[0])) - beams[0].argmax()) > scene["main_lobe_beams"]
    return ratio_db(*beams, beside), 0.0


def bounces_db(scene, r, c):
    return ratio_db(r.sum(axis=(0, 1)), c.sum(axis=(0, 1)), scene["range"] > scene["later_from_m"]), 0.0


def ratio_db(r, c, part):
    """Energy of a part relative to the rest, in dB; limited to 60 dB if one of the two is 0."""
    shares = [max(x[part].sum(), 1e-300) / max(x[~part].sum(), 1e-300) for x in (r, c)]
    return np.clip(10 * np.log10(shares[1] / shares[0]), -60.0, 60.0)


def lit_in_shadow(scene, r, c):
    """Share of the energy in bins that are 0 in the reference, as are their neighbours."""
    near = r > 0
    for axis in (1, 2):
        near = near | np.roll(near, 1, axis) | np.roll(near, -1, axis)
    return c[~near].sum() / r.sum(), 0.0


def edges_off(scene, r, c):
    """Share of bins with an echo that have no echo in the other file."""
    threshold = LIT_SHARE_OF_MEAN * r[r > 0].mean()
    both, either = np.sum((r > threshold) & (c > threshold)), np.sum((r > threshold) | (c > threshold))
    return 1 - both / either, 0.0


def samples_moved(scene, r, c):
    """Mean distance by which the energy of a beam would have to move along range, in samples."""
    r, c = (x.reshape(-1, x.shape[-1]) for x in (r, c))
    total, theirs = r.sum(axis=1), c.sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        way = np.abs(np.cumsum(r, axis=1) / total[:, None] - np.cumsum(c, axis=1) / theirs[:, None]).sum(axis=1)
    way = np.where(theirs > 0, way, r.shape[1])[total > 0]
    return way @ total[total > 0] / total.sum(), 0.0


def coarse_l1(scene, r, c):
    """Relative L1 error of blocks of 4 beams and 8 samples, in which most sampling noise averages out."""
    beams, samples = np.arange(0, r.shape[1], 4), np.arange(0, r.shape[2], 8)
    blocks = [np.add.reduceat(np.add.reduceat(x, beams, axis=1), samples, axis=2) for x in (r, c)]
    return np.abs(blocks[1] - blocks[0]).sum() / r.sum(), 0.0


def pings_off(scene, r, c):
    """Difference between the number of a ping and that of the most similar ping of the reference."""
    r, c = (x / np.maximum(x.sum(axis=(1, 2), keepdims=True), 1e-300) for x in (r, c))
    nearest = [np.abs(r - ping).sum(axis=(1, 2)).argmin() for ping in c]
    return float(np.abs(np.array(nearest) - np.arange(len(r))).max()), 0.0


MEASURES = {f.__name__: f for f in (gain_db, range_exponent, db_per_km, beams_off, side_lobes_db, bounces_db, lit_in_shadow,
                                    edges_off, samples_moved, coarse_l1, pings_off)}
FIRST = "range-law"  # its gain and power of range are removed from the other scenes, which then show other errors


def pack_scenes(pack):
    """Name and echoes of each scene with an answer, and the content of scene.json that measures need."""
    folders = sorted((pack / "answers").glob("*/energy.npy")) or sorted(pack.glob("*/echoes.nc"))
    if not folders:
        raise Refused(f"{pack}: found no answers: expected answers/NAME/energy.npy (v2) or NAME/echoes.nc (v1)")
    for file in sorted(folders, key=lambda file: (file.parent.name != FIRST, file.parent.name)):
        name = file.parent.name
        if file.suffix == ".nc":
            (echoes,), _ = [list(part.values()) if isinstance(part, dict) else part for part in sensors_of(file)]
            yield name, echoes, None
            continue
        try:
            scene = json.loads((pack / "scenes" / name / "scene.json").read_text())
            samples = scene["samples"]
            scene["range"] = samples["first_m"] + (np.arange(samples["count"]) + 0.5) * samples["step_m"]
            scene["limits"] = {judged["measure"]: judged["limit"] for judged in scene["judged_by"]}
            azimuth = np.array(scene["beams"]["axes_deg"])
            unknown = scene["limits"].keys() - MEASURES.keys()
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise Refused(f"{pack}/scenes/{name}/scene.json: not a scene of a benchmark suite: {error!r}") from error
        if unknown:
            raise Refused(f"{pack}: unknown measure {', '.join(sorted(unknown))} of scene {name}: use the compare.py of this "
                          "suite")
        bound = file.parent / "bound.npy"
        yield name, {"energy": array_in(file), "range": scene["range"], "azimuth": azimuth,
                     "bound": array_in(bound) if bound.exists() else None}, scene


def result_of(results, name):
    found = [file for file in (results / f"{name}.npy", results / f"{name}.nc", results / name / "energy.npy",
                               results / name / "echoes.nc") if file.exists()]
    if not found:
        return None
    sensors, _ = sensors_of(found[0])
    if len(sensors) != 1:
        raise Refused(f"{found[0]}: expected one sensor, found {len(sensors)}")
    return next(iter(sensors.values()))


def judged(scene, r, c, relative):
    """Measures of a scene by name: value, standard error, limit, and whether the value is within the limit."""
    found = {}
    for name, limit in scene["limits"].items():
        value, error = MEASURES[name](scene, r, c)
        kept = bool(abs(value) - 2 * error <= limit) or relative and name == "gain_db"
        value = float(value) if np.isfinite(value) else None  # too few samples for an estimate
        found[name] = {"value": value, "standard_error": float(error), "limit": limit, "kept": kept}
    return found


def compare_pack(pack, results, relative):
    scenes, missing, first = [], [], None
    for name, reference, scene in pack_scenes(pack):
        try:
            candidate = result_of(results, name)
            errors = candidate and errors_of(name, reference, candidate)
        except Refused as refused:
            scenes.append({"scene": name, "agrees": False, "refused": str(refused)})
            continue
        if candidate is None:
            missing.append(name)
            continue
        entry = {"scene": name, "errors": errors}
        if scene is not None:
            c = candidate["energy"]
            if first:
                c = c / (10 ** (first["gain_db"] / 10) * scene["range"] ** first["range_exponent"])
            entry.update(tests=scene["tests"], measures=judged(scene, reference["energy"], c, relative))
            entry["agrees"] = all(measure["kept"] for measure in entry["measures"].values())
            if name == FIRST and (relative or not entry["agrees"]):
                law, gain = entry["measures"]["range_exponent"], entry["measures"]["gain_db"]["value"]
                if law["value"] is not None and gain is not None:
                    first = {"gain_db": gain, "range_exponent": 0.0 if law["kept"] else law["value"]}
        scenes.append(entry)
    if not scenes:
        raise Refused(f"{results}: found no result of any scene of {pack}: --help lists the file names")
    return {"taken_off": first, "missing": missing, "scenes": scenes}


def print_pack(report):
    for entry in report["scenes"]:
        verdict = {True: "agrees", False: "DIFFERS", None: ""}[entry.get("agrees")]
        if "refused" in entry:
            print(f"{entry['scene']:<17} {verdict:<8} cannot be compared: {entry['refused']}")
            continue
        errors = entry["errors"]
        share = errors["energy_ratio_db"]
        print(f"{entry['scene']:<17} {verdict:<8} L1 {errors['l1_error'] or 0:8.2g}, {errors['rms_db_error']:5.2f} dB RMS, energy "
              + ("none" if share is None else f"{share:+.2f} dB"))
        for name, measure in entry.get("measures", {}).items():
            error = f" +- {measure['standard_error']:.2g}" if measure["standard_error"] > 0 else ""
            value = "unknown" if measure["value"] is None else f"{measure['value']:+.4g}"
            print(f"    {name:<15} {value}{error} (at most {measure['limit']:g})"
                  + ("" if measure["kept"] else f": error in {entry['tests']}"))
    if report["taken_off"]:
        print("removed from all other scenes: {gain_db:+.2f} dB and r^{range_exponent:+.3f}, found in ".format(**report["taken_off"])
              + FIRST)
    if report["missing"]:
        print("no result of: " + ", ".join(report["missing"]))
    wrong = [entry["scene"] for entry in report["scenes"] if entry.get("agrees") is False]
    if any("agrees" in entry for entry in report["scenes"]):
        print("differs in: " + (", ".join(wrong) or "nothing"))


def main():
    parser = argparse.ArgumentParser(description="Compare the echoes of a candidate with a reference.")
    parser.add_argument("reference", help="file of echoes, or folder of a benchmark suite")
    parser.add_argument("candidate", help="file of echoes, or folder of results")
    parser.add_argument("--json", action="store_true", help="print all measures, named as tubefoot compare names them")
    parser.add_argument("--relative", action="store_true", help="for a suite: accept energies in any one unit")
    options = parser.parse_args()
    if pathlib.Path(options.reference).is_dir():
        report = compare_pack(pathlib.Path(options.reference), pathlib.Path(options.candidate), options.relative)
        if options.json:
            print(json.dumps(report, indent=2, default=lambda number: number.item()))
        else:
            print_pack(report)
        sys.exit(3 if any(entry.get("agrees") is False for entry in report["scenes"]) else 0)
    if options.relative:
        raise Refused(f"--relative needs the folder of a suite, but {options.reference} is a file")
    (references, hash_r), (candidates, hash_c) = sensors_of(options.reference), sensors_of(options.candidate)
    if hash_r and hash_c and hash_r != hash_c:
        raise Refused(f"scene_hash is {hash_c}, but the reference has {hash_r}: compute the same scene")
    if len(references) == len(candidates) == 1:  # their names may differ
        candidates = dict(zip(references, candidates.values()))
    if missing := set(references) - set(candidates):
        raise Refused(f"{options.candidate}: no sensor {', '.join(sorted(missing))}")
    results = [errors_of(name, echoes, candidates[name]) for name, echoes in references.items()]
    if options.json:
        print(json.dumps({"sensors": results}, indent=2, default=lambda number: number.item()))
        return
    for result in results:
        print(f"{result['name']}: {result['pings']} pings x {result['beams']} beams x "
              f"{result['samples']} samples")
        for key in ("l1_error", "rms_db_error", "energy_ratio", "empty_where_lit", "lit_bins", "lit_where_shadow",
                    "shadow_bins", "first_return", "within_bound"):
            measures = result[key].items() if isinstance(result[key], dict) else [("", result[key])]
            for part, value in measures:
                print(f"  {(key + ' ' + part).strip():<38} {value if value is None else format(value, '.6g')}")
        for place in result["worst_bins"]:
            print("  worst bin: ping {ping}, beam {beam}, sample {sample} at {slant_range_m:.3f} m: {candidate_j:.4g} J/m2 "
                  "for {reference_j:.4g} J/m2, {error_db:+.3g} dB".format(**place))


if __name__ == "__main__":
    try:
        main()
    except Refused as refused:
        print(refused, file=sys.stderr)
        sys.exit(2)
