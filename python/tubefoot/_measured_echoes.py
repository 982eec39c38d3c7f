# SPDX-License-Identifier: GPL-3.0-or-later
"""Echoes of a fan in an echo file, and the seabed that they show. Part of :mod:`tubefoot.measured`."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Optional

import numpy as np

from ._errors import InputError

TRACK_SPAN_DEG = 8.0  # half-width of the neighbourhood of a beam in the fit of the seabed
ECHO_HALF_WIDTH_DEG = 3.0  # half-width of the echo of a beam, as an angle across the track
MOST_LOADED_BYTES = 2**28  # larger energies of a sensor are read ping by ping
LARGEST_DEVIATION_DEG = 5.0  # a beam whose strongest echo deviates more from the fitted seabed shows no seabed echo


def library(name: str, purpose: str) -> Any:
    """Imports an optional library, for example ``"matplotlib.pyplot"``."""
    import importlib
    try:
        return importlib.import_module(name)
    except ImportError:
        package = name.split(".")[0]
        raise InputError(f"{package} is missing: {purpose} needs it; install python3-{package.lower()}") from None


def _filled(variable: Any, part: Any) -> np.ndarray:
    """Reads a part of a variable as float64, with NaN for missing values."""
    return np.ma.filled(np.ma.asarray(variable[part]).astype(float), np.nan)


@dataclass
class Echoes:
    """One multibeam of an echo file. :meth:`energy` returns one ping at a time. Large energies stay in the file.

    ``P`` is the number of pings, ``B`` of beams, ``K`` of range bins and ``S`` of transmit sectors.
    """

    name: str  # name of the sensor, for example "mode-190-220"
    file: str
    variable: str  # "received" if the file contains it, else "energy"
    pings: int
    slant_range: np.ndarray  # (K,) m
    step: float  # m, length of a range bin
    angle: np.ndarray  # (B,) degrees across the track from straight down, positive to starboard
    sector: np.ndarray  # (B,) int
    frequency_khz: np.ndarray  # (S,)
    pulse_m: np.ndarray  # (S,) m, half the length of the pulse in water
    recorded: Optional[tuple[np.ndarray, np.ndarray]]  # (P, B) m each, ends of the recorded ranges
    detected: Optional[np.ndarray]  # (P, B) bool, the sonar itself detected the seabed; None if the file does not state it
    has_speckle: bool  # the energies contain the speckle of a receiver
    group: Any = field(repr=False)
    loaded: Optional[np.ndarray] = field(default=None, repr=False)  # (P, B, K) J/m², all energies, unless they are too large

    def energy(self, ping: int) -> tuple[np.ndarray, np.ndarray]:
        """Returns the energies of a ping in J/m², (B, K), and where they were recorded, (B, K) bool.

        The energies are 0 where the level was below the lowest code, and where nothing was recorded.
        """
        energy = _filled(self.group[self.variable], ping) if self.loaded is None else self.loaded[ping]
        known = np.isfinite(energy)
        if self.recorded is not None:
            near, far = (end[ping][:, None] for end in self.recorded)
            known &= (self.slant_range >= near) & (self.slant_range <= far)
        return np.where(known, np.maximum(np.nan_to_num(energy), 0), 0), known


def open_file(path: str) -> Any:
    """Opens an echo file for reading."""
    netcdf = library("netCDF4", "the comparison")
    name = os.path.join(path, "echoes.nc") if os.path.isdir(path) else path
    if not os.path.exists(name):
        raise InputError(f"{name}: the file does not exist: expected an echo file; check the name", name)
    try:
        return netcdf.Dataset(name)
    except OSError as error:
        raise InputError(f"{name}: the file is not a netCDF-4 file ({error.strerror or error}): expected an echo file; "
                         "create it with tubefoot", name) from None


def sensors_of(file: Any) -> dict[str, Any]:
    """Returns the groups of the sensors by name. The root group is the group of a single sensor."""
    if file.groups:
        return dict(file.groups)
    return {str(getattr(file, "sensor_name", "sensor")): file}


def echoes_of(file: Any, name: str, group: Any) -> Echoes:
    """Reads all variables of a sensor except its energies.

    Raises:
        InputError: a variable is missing, or it has a wrong shape.
    """
    path = file.filepath()

    def value(variable: str, *dimensions: str) -> np.ndarray:
        if variable not in group.variables:
            raise InputError(f"{path}: sensor {name!r} has no variable {variable!r}: expected an echo file of a multibeam; "
                             "create the file again, or choose another sensor", path)
        if group[variable].dimensions != dimensions:
            raise InputError(f"{path}: the variable {variable!r} of sensor {name!r} has the dimensions "
                             f"{group[variable].dimensions}: expected {dimensions}; create the file again", path)
        return _filled(group[variable], slice(None))

    variable = "received" if "received" in group.variables else "energy"
    value_of_sector = {n: value(n, "sector") for n in ("sector_frequency_khz", "sector_pulse_length")
                       if n in group.variables}
    azimuth, elevation = (np.radians(value(n, "beam")) for n in ("beam_azimuth", "beam_elevation"))
    starboard, up = np.sin(azimuth) * np.cos(elevation), np.sin(elevation)
    slant_range, bounds = value("slant_range", "sample"), value("slant_range_bounds", "sample", "bound")
    if variable not in group.variables or group[variable].dimensions != ("ping", "beam", "sample"):
        value(variable, "ping", "beam", "sample")
    pings = len(group.dimensions["ping"])
    if not pings:
        raise InputError(f"{path}: sensor {name!r} has no ping: expected at least 1; choose another sensor", path)
    if len(slant_range) < 8:
        raise InputError(f"{path}: sensor {name!r} has {len(slant_range)} range bins: expected at least 8; choose another "
                         "sensor", path)
    sector = value("beam_sector", "beam").astype(int) if "beam_sector" in group.variables else np.zeros(len(azimuth), int)
    sectors = 1 + int(sector.max())
    frequency = value_of_sector.get("sector_frequency_khz", np.full(sectors, float(getattr(group, "frequency_khz", np.nan))))
    speed = float(getattr(group, "sound_speed_m_s", 1500))
    pulse = value_of_sector.get("sector_pulse_length", np.zeros(sectors)) * speed / 2
    if len(frequency) < sectors or len(pulse) < sectors:
        raise InputError(f"{path}: 'beam_sector' of sensor {name!r} refers to sector {sectors - 1}: expected sectors 0 to "
                         f"{len(frequency) - 1}; create the file again", path)
    recorded = None
    if "recorded_range_min" in group.variables:
        recorded = (value("recorded_range_min", "ping", "beam"), value("recorded_range_max", "ping", "beam"))
    detected = np.isfinite(value("detected_range", "ping", "beam")) if "detected_range" in group.variables else None
    has_speckle = "speckle" in str(getattr(group[variable], "receiver", ""))
    loaded = _filled(group[variable], slice(None)) if group[variable].size * 8 <= MOST_LOADED_BYTES else None
    step = float(np.median(bounds[:, 1] - bounds[:, 0]))
    return Echoes(name, path, variable, pings, slant_range, step, np.degrees(np.arctan2(starboard, -up)), sector, frequency,
                  np.maximum(pulse, step), recorded, detected, has_speckle, group, loaded)


def matching(measured: Echoes, simulated: Echoes) -> None:
    """Checks that two sensors have the same beams, sectors and range bins.

    Raises:
        InputError: they differ.
    """
    for what, mine, other, tolerance in (
            ("number of beams", len(measured.angle), len(simulated.angle), 0),
            ("number of range bins", len(measured.slant_range), len(simulated.slant_range), 0),
            ("angles of the beams in degrees", measured.angle, simulated.angle, 0.05),
            ("sectors of the beams", measured.sector, simulated.sector, 0),
            ("ranges of the bins in m", measured.slant_range, simulated.slant_range, 0.1 * measured.step)):
        difference = np.abs(np.asarray(mine, float) - np.asarray(other, float))
        if difference.max() > tolerance:
            k = int(difference.argmax())
            where = f" of number {k}" if difference.ndim else ""
            mine, other = np.atleast_1d(mine)[k], np.atleast_1d(other)[k]
            raise InputError(f"{simulated.file}: sensor {simulated.name!r} differs in the {what}{where}: {other:.6g} instead of "
                             f"{mine:.6g} in {measured.file}; simulate the beams and range bins of the measured file",
                             simulated.file)


@dataclass
class Seabed:
    """The seabed as a multibeam shows it: range and slope of range per ping and beam, (P, B) each."""

    range: np.ndarray  # m
    rate: np.ndarray  # m per degree, |dR/dtheta|
    incidence: np.ndarray  # degrees between the beam and the normal of the seabed, in the plane of the fan
    centroid: np.ndarray  # m, centroid of the beam's own echo; NaN without a seabed echo
    valid: np.ndarray  # bool, the beam shows a seabed echo


def echo_half_width(rate: np.ndarray, pulse_m: np.ndarray, ranges: np.ndarray) -> np.ndarray:
    """Returns half the length of the echo in m, for a rate in m per degree. The last term is that of a beam at nadir."""
    return ECHO_HALF_WIDTH_DEG * rate + 3 * pulse_m + ranges * (1 / np.cos(np.radians(ECHO_HALF_WIDTH_DEG)) - 1)


def _local_planes(angle: np.ndarray, ranges: np.ndarray, good: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Fits a plane to the ranges around each beam. Returns R and dR/dtheta in m and m per radian.

    A plane has 1/R = A cos(theta) + B sin(theta), which is linear in A and B. The weights are tricube in the angle, and
    Tukey's biweight makes the fit robust (Cleveland 1979).
    """
    theta = np.radians(angle)
    c, s = np.cos(theta), np.sin(theta)
    q = np.where(good, 1 / np.where(good, ranges, 1), 0)
    near = np.clip(1 - (np.abs(angle[:, None] - angle) / TRACK_SPAN_DEG) ** 3, 0, None) ** 3 * good
    robust = np.ones(len(angle))
    for _ in range(5):
        w = near * robust
        cc, ss, cs, cq, sq = (w @ v for v in (c * c, s * s, c * s, c * q, s * q))
        determinant = cc * ss - cs * cs
        determinant = np.where(determinant > 1e-12 * np.maximum(cc, 1e-300) ** 2, determinant, np.nan)
        a, b = (ss * cq - cs * sq) / determinant, (cc * sq - cs * cq) / determinant
        fit = a * c + b * s
        residual = np.where(good, q - fit, np.nan) / fit
        scale = 1.4826 * np.nanmedian(np.abs(residual)) if np.isfinite(residual).any() else np.nan
        # The range error of a beam grows with its rate. 1 degree of beam is the smallest scale that can reject a beam.
        limit = np.maximum(6 * scale, np.radians(1) * np.abs(np.tan(np.abs(theta) + 0.1)))
        robust = np.nan_to_num(np.clip(1 - (residual / limit) ** 2, 0, None) ** 2)
    r = 1 / fit
    return r, r * r * (a * s - b * c)


def seabed_of(echoes: Echoes) -> Seabed:
    """Finds the seabed in each ping, by the same steps for measured and simulated echoes.

    The strongest echo per beam, for energies times range cubed, gives the start. A running median over 15 beams removes
    outliers. Local planes then fit the strongest echoes, and twice the centroids of the energy around the fit.
    """
    ndimage = library("scipy.ndimage", "the comparison")
    shape = echoes.pings, len(echoes.angle)
    out = Seabed(*(np.full(shape, np.nan) for _ in range(4)), np.zeros(shape, bool))
    r, angle = echoes.slant_range, echoes.angle
    pulse = echoes.pulse_m[echoes.sector]
    cosine = np.cos(np.radians(angle))
    width = max(3, int(round(0.15 / echoes.step)) | 1)
    for ping in range(echoes.pings):
        energy, _ = echoes.energy(ping)
        loud = ndimage.uniform_filter1d(energy * np.where(r > 0.5, r, 0) ** 3, width, axis=1, mode="constant")
        peak = r[loud.argmax(axis=1)]
        good = loud.max(axis=1) > 0
        if good.sum() < 8:
            continue
        depth = np.interp(angle, angle[good], ndimage.median_filter(peak[good] * cosine[good], 15, mode="nearest"))
        fit, rate = depth / cosine, depth / cosine * np.tan(np.radians(angle))
        ranges = peak
        for step in range(4):
            half = echo_half_width(np.abs(rate) * np.pi / 180, pulse, fit)
            limit = LARGEST_DEVIATION_DEG / ECHO_HALF_WIDTH_DEG * half
            valid = good & np.isfinite(fit) & (np.abs(peak - fit) < limit)
            if step:
                inside = np.abs(r - fit[:, None]) <= half[:, None]
                total = (energy * inside).sum(axis=1)
                valid &= total > 0
                ranges = np.where(valid, (energy * inside * r).sum(axis=1) / np.where(valid, total, 1), np.nan)
            if step == 3 or valid.sum() < 8:
                break
            fit, rate = _local_planes(angle, ranges, valid)
        out.range[ping], out.rate[ping] = fit, np.abs(rate) * np.pi / 180
        out.incidence[ping] = np.degrees(np.arctan2(np.abs(rate), fit))
        out.centroid[ping], out.valid[ping] = ranges, valid & np.isfinite(rate)
    return out


def pings_of(echoes: Echoes, seabed: Seabed) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
    """Yields the pings that show a seabed: number, energies and where they were recorded."""
    for ping in range(echoes.pings):
        if seabed.valid[ping].any():
            yield (ping, *echoes.energy(ping))
