#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Holds a candidate's echoes against a reference, as `tubefoot compare` does (docs/compare.md), without tubefoot.

    compare.py REFERENCE.nc CANDIDATE.nc [--json]

Needs NumPy and netCDF4. Exit codes: 0 compared, 2 the files cannot be compared."""
import argparse
import json
import sys

import netCDF4
import numpy as np

LIT_SHARE_OF_MEAN = 1e-3
LARGEST_ERROR_DB = 30.0
SAMPLE_SHARE, AZIMUTH_TOLERANCE_DEG = 0.01, 1e-3


class Refused(Exception):
    """The two files cannot be compared; the message says why and what to do."""


def values_of(file, sensor, name, dimensions, units):
    if name not in sensor.variables:
        raise Refused(f"{file}: there is no variable '{name}'")
    variable = sensor[name]
    if variable.dimensions != dimensions:
        raise Refused(f"{file}: '{name}' has dimensions {variable.dimensions}, not {dimensions}")
    if getattr(variable, "units", None) != units:
        raise Refused(f"{file}: '{name}' must have units '{units}', not '{getattr(variable, 'units', None)}'")
    values = np.ma.filled(variable[:].astype(np.float64), np.nan)
    if not np.all(np.isfinite(values)):
        raise Refused(f"{file}: '{name}' has values that are missing or not finite: write zeros where there is no echo")
    return values


def sensors_of(path):
    """Name, energies and axes of every sensor; a sensor is a group, or the whole file if there are no groups."""
    bins = ("ping", "beam", "sample")
    try:
        file = netCDF4.Dataset(path)
    except OSError as error:
        raise Refused(f"{path}: cannot be read: {error}") from error
    sensors = {}
    with file:
        for sensor in list(file.groups.values()) or [file]:
            name = getattr(sensor, "sensor_name", "sensor" if sensor is file else sensor.name)
            echoes = {"energy": values_of(path, sensor, "energy", bins, "J"),
                      "range": values_of(path, sensor, "slant_range", ("sample",), "m"),
                      "azimuth": values_of(path, sensor, "beam_azimuth", ("beam",), "degree"),
                      "bound": None}
            if "energy_bound" in sensor.variables:
                echoes["bound"] = values_of(path, sensor, "energy_bound", bins, "J")
            if np.any(echoes["energy"] < 0):
                raise Refused(f"{path}: 'energy' has negative values")
            sensors[name] = echoes
        return sensors, getattr(file, "scene_hash", "")


def check(reference, candidate):
    if reference["energy"].shape != candidate["energy"].shape:
        raise Refused(f"the reference has {reference['energy'].shape} pings, beams and samples, the candidate "
                      f"{candidate['energy'].shape}: compute the same")
    ranges = reference["range"]
    step = ranges[1] - ranges[0] if len(ranges) > 1 else ranges[0]
    if np.any(np.abs(candidate["range"] - ranges) > SAMPLE_SHARE * step):
        raise Refused("'slant_range' differs by more than 1 % of a sample: use the reference's range samples")
    turn = (candidate["azimuth"] - reference["azimuth"] + 180) % 360 - 180
    if np.any(np.abs(turn) > AZIMUTH_TOLERANCE_DEG):
        raise Refused("'beam_azimuth' differs by more than 0.001 degree: use the reference's beams in its order")


def ratio(part, whole, candidate_total, if_both_silent):
    """None where the reference is silent and the candidate is not."""
    if whole > 0:
        return part / whole
    return None if candidate_total > 0 else if_both_silent


def first_return_errors(ranges, reference, candidate, threshold):
    """Of every beam of every ping: its first lit sample, candidate minus reference."""
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
        "first_return": first_return_errors(reference["range"], r, c, threshold),
        "within_bound": None, "worst_bins": []}
    if bound is not None:
        heard, off = (r > 0) | (c > 0), difference.sum()
        errors["within_bound"] = {
            "bound_l1": ratio(bound.sum(), total_r, bound.sum(), 0.0),
            "share_of_difference": np.minimum(difference, bound).sum() / off if off > 0 else 1.0,
            "share_of_bins": (heard & (difference <= bound)).sum() / heard.sum() if heard.any() else 1.0}
    for k in np.argsort(-difference, axis=None, kind="stable")[:worst]:
        ping, beam, sample = (int(i) for i in np.unravel_index(k, r.shape))
        at = ping, beam, sample
        if difference[at] > 0:
            errors["worst_bins"].append({
                "ping": ping, "beam": beam, "sample": sample, "slant_range_m": reference["range"][sample],
                "reference_j": r[at], "candidate_j": c[at], "error_db": decibels[at],
                "share_of_difference": difference[at] / difference.sum()})
    return errors


def main():
    parser = argparse.ArgumentParser(description="Hold a candidate's echoes against a reference.")
    parser.add_argument("reference")
    parser.add_argument("candidate")
    parser.add_argument("--json", action="store_true", help="print all measures, named as tubefoot compare names them")
    options = parser.parse_args()
    (references, hash_r), (candidates, hash_c) = sensors_of(options.reference), sensors_of(options.candidate)
    if hash_r and hash_c and hash_r != hash_c:
        raise Refused(f"scene_hash is {hash_c}, the reference's {hash_r}: compute the same scene")
    if len(references) == len(candidates) == 1:  # whatever they are called
        candidates = dict(zip(references, candidates.values()))
    if missing := set(references) - set(candidates):
        raise Refused(f"{options.candidate}: there is no sensor {', '.join(sorted(missing))}")
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
            print("  worst bin: ping {ping}, beam {beam}, sample {sample} at {slant_range_m:.3f} m: {candidate_j:.4g} J "
                  "for {reference_j:.4g} J, {error_db:+.3g} dB".format(**place))


if __name__ == "__main__":
    try:
        main()
    except Refused as refused:
        print(refused, file=sys.stderr)
        sys.exit(2)
