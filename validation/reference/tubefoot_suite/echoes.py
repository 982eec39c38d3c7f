# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads echoes from NumPy and netCDF files, and measures the errors of a candidate as `tubefoot compare` does."""
import numpy as np

LIT_SHARE_OF_MEAN = 1e-3
LARGEST_ERROR_DB = 30.0
SAMPLE_SHARE, AZIMUTH_TOLERANCE_DEG = 0.01, 1e-3


class Refused(Exception):
    """Files cannot be compared. The message states the reason and a remedy."""


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


def array_in(path, first="ping"):
    try:
        values = np.load(path, allow_pickle=False, mmap_mode="r")  # the header of a damaged file cannot ask for memory
    except (OSError, ValueError, EOFError) as error:
        raise Refused(f"{path}: cannot read the file: {error}") from error
    if not isinstance(values, np.ndarray) or values.ndim != 3 or values.dtype.kind != "f":
        found = f"{values.ndim} dimensions and the type {values.dtype}" if isinstance(values, np.ndarray) else "another content"
        raise Refused(f"{path}: expected floating-point numbers with the dimensions {first}, beam and sample, but the array has "
                      f"{found}")
    return np.array(values, dtype=np.float64)


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
    if reference["azimuth"] is None:
        return
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
