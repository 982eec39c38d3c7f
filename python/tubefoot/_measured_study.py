# SPDX-License-Identifier: GPL-3.0-or-later
"""The figures of the comparison of a measured with a simulated water column. Part of :mod:`tubefoot.measured`."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Optional, Union

import numpy as np

from . import _measured_echoes as _echoes
from . import _measured_figures as _figures
from ._errors import InputError, UsageError, whole

PathLike = Union[str, "os.PathLike[str]"]

COLUMNS = ("quantity", "mode", "sector", "frequency_khz", "angle_from_deg", "angle_to_deg", "unit", "measured", "measured_low",
           "measured_high", "simulated", "simulated_low", "simulated_high", "kind", "overlap")
"""Columns of ``table.csv`` and keys of the rows of :func:`compare_measured`."""

# Meaning of each quantity, in the order of the report.
QUANTITIES = {
    "extent_3db": "Extent of the seabed echo over angle at -3 dB: (r - R) / |dR/dtheta|",
    "extent_10db": "Extent of the seabed echo over angle at -10 dB",
    "equivalent_width": "Equivalent width of the seabed echo over angle: integral over peak",
    "side_lobe_inner": "Mean level at -5 to -3 degrees in the same curve, relative to its peak",
    "side_lobe_outer": "Mean level at 3 to 5 degrees in the same curve, relative to its peak",
    "side_lobe": "Mean level at 3 to 5 degrees on both sides of the peak",
    "range_extent_3db": "Extent of the seabed echo over range at -3 dB: r - R",
    "range_extent_10db": "Extent of the seabed echo over range at -10 dB",
    "range_equivalent_width": "Equivalent width of the seabed echo over range",
    "bottom_range": "Mean range R of the fitted seabed",
    "alignment": "Root mean square deviation of the centroids of single beams from R",
    "arc": "Side-lobe arc: level in the range bins of the first return, by the angle from its beam, relative to its beam",
    "water_level": "Mean level between 1 m and the first return, relative to the seabed echo",
    "empty_fraction": "Fraction of these range bins with energy 0 (below the lowest code)",
    "intensity_moment": "Second normalised moment of the samples in the seabed echo: 2 for Rayleigh amplitudes",
    "k_inverse_shape": "Inverse shape 1/nu of the K distribution of these samples: 0 for Rayleigh amplitudes",
    "exponential_distance": "Kolmogorov distance of these samples from the exponential distribution",
    "relative_level": "Mean energy of the seabed echo by incidence, relative to the mean over these intervals of the sector",
    "level_offset": "Fitted: level a of measured over simulated echoes; contains the unknown calibration",
    "cosine_exponent": "Fitted: change b of the exponent of cos(incidence)",
    "specular_level": "Fitted: level c of an additional specular lobe",
    "specular_width": "Fitted: width w of this lobe: c exp(-i^2 / (2 w^2))",
}
FITTED = ("bottom_range", "level_offset", "cosine_exponent", "specular_level", "specular_width")
"""Quantities that a scene takes from the measured file, or that the comparison fits. All others are predicted."""

_SIGNED = ("k_inverse_shape", "cosine_exponent")  # can be negative, besides levels in decibels


@dataclass
class Comparison:
    """Result of :func:`compare_measured`.

    Attributes:
        rows: one dict per figure, with the keys :data:`COLUMNS`. Unknown numbers are NaN. ``overlap`` is ``"yes"`` if both
            95 % intervals overlap, ``"no"`` if not, and empty if a figure or an interval is unknown.
        material: one dict per mode, sector and grazing angle: ``mode``, ``sector``, ``frequency_khz``, ``grazing_deg``,
            ``ratio_db`` (measured over simulated echo energy), ``ratio_low_db``, ``ratio_high_db``, and ``strength_db`` if the
            material of the simulation is known.
        curves: mean echo curves by (mode, sector, from, to): ``x`` in degrees, and ``measured`` and ``simulated`` power relative
            to the peak, with ``_low`` and ``_high``.
        fans: first ping by mode: ``angle`` in degrees, ``range`` in m, ``measured`` and ``simulated`` energies, (beams, range
            bins).
        notes: what the comparison left out, and why.
        seed: seed of the bootstrap.
        resamples: number of resamples per figure.
    """

    rows: list[dict[str, Any]] = field(default_factory=list)
    material: list[dict[str, Any]] = field(default_factory=list)
    curves: dict[tuple[str, int, float, float], dict[str, np.ndarray]] = field(default_factory=dict)
    fans: dict[str, dict[str, Any]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    seed: int = 0
    resamples: int = 0


class _Study:
    """The comparison of one mode."""

    def __init__(self, out: Comparison, pair: tuple[_echoes.Echoes, _echoes.Echoes], rng: np.random.Generator,
                 lambert_db: Optional[float]) -> None:
        self.out, self.pair, self.rng, self.lambert_db = out, pair, rng, lambert_db
        self.seabeds = tuple(_echoes.seabed_of(echoes) for echoes in pair)
        if pair[0].detected is not None:
            # Most beams outside of the swath of the sonar receive no seabed echo, and others a weak one.
            outside = pair[0].detected.mean(axis=0) < 0.5
            for seabed in self.seabeds:
                seabed.valid[:, outside] = False
        for echoes, seabed in zip(pair, self.seabeds):
            if not seabed.valid.any():
                raise InputError(f"{echoes.file}: sensor {echoes.name!r} shows no seabed echo: expected an echo above all other "
                                 "echoes in at least 8 beams; choose another sensor", echoes.file)
            pings = int(seabed.valid.any(axis=1).sum())
            if pings < echoes.pings:
                self.note(f"{echoes.pings - pings} of {echoes.pings} pings of {echoes.file} show no seabed echo")

    def note(self, text: str) -> None:
        self.out.notes.append(f"{self.pair[0].name}: {text}")

    def intervals(self, blocks: _figures.Sums, estimator: Any) -> Any:
        return _figures.intervals(blocks, estimator, self.rng, self.out.resamples)

    def add(self, quantities: Sequence[str], units: Sequence[str], sector: Optional[int], band: tuple[float, float],
            measured: Any, simulated: Any) -> None:
        """Adds one row per quantity. ``measured`` and ``simulated`` are results of :func:`intervals`."""
        nothing = np.full((3, len(quantities)), np.nan)
        measured, simulated = (nothing if x is None else np.asarray(x) for x in (measured, simulated))
        frequency = np.nan if sector is None else self.pair[0].frequency_khz[sector]
        for k, (quantity, unit) in enumerate(zip(quantities, units)):
            mine, other = measured[:, k].copy(), simulated[:, k].copy()
            if unit != "dB" and quantity not in _SIGNED:
                mine[1], other[1] = np.maximum(mine[1], 0), np.maximum(other[1], 0)
            overlap = ""
            if np.isfinite([*mine, *other]).all():
                overlap = "yes" if mine[1] <= other[2] and other[1] <= mine[2] else "no"
            values = (quantity, self.pair[0].name, "" if sector is None else sector, float(frequency), *map(float, band), unit,
                      *map(float, mine), *map(float, other), "fitted" if quantity in FITTED else "predicted", overlap)
            self.out.rows.append(dict(zip(COLUMNS, values)))

    def run(self) -> None:
        sectors = sorted(set(self.pair[0].sector.tolist()))
        self.echo_curves(sectors)
        self.arcs()
        for sector in sectors:
            sums = [_figures.water_sums(e, s, sector) for e, s in self.both()]
            # Simulated water without scattering and noise has no level.
            self.add(("water_level", "empty_fraction"), ("dB", "1"), sector, (np.nan, np.nan),
                     *(self.intervals(one, _figures.water_figures) if one["power"].any() else None for one in sums))
            self.angular_response(sector)
        self.out.fans[self.pair[0].name] = {
            "angle": self.pair[0].angle, "range": self.pair[0].slant_range,
            "measured": self.pair[0].energy(0)[0], "simulated": self.pair[1].energy(0)[0]}

    def both(self) -> Any:
        return zip(self.pair, self.seabeds)

    def echo_curves(self, sectors: Sequence[int]) -> None:
        bands, absent = [], []
        for sector in sectors:
            for band in (_figures.NADIR_BAND_DEG, *_figures.BANDS_DEG):
                beams = _figures.beams_in(self.pair[0], sector, band)
                if len(beams) >= 3:
                    bands.append((sector, band, beams))
                elif band in _figures.BANDS_DEG:
                    absent.append(f"sector {sector}, {band[0]:g} to {band[1]:g} degrees")
        if absent:
            self.note(f"less than 3 beams in some incidence bands, which have no rows: {'; '.join(absent)}")
        sums = [_figures.curve_sums(e, s, [(sector, beams) for sector, _, beams in bands]) for e, s in self.both()]
        for (sector, band, beams), *pair in zip(bands, *sums):
            if not all(pair):
                self.note(f"sector {sector} shows no seabed echo from {band[0]:g} to {band[1]:g} degrees in "
                          f"{self.pair[0 if not pair[0] else 1].file}: no row")
                continue

            def figures(estimator: Any, pair: Any = pair) -> list[Any]:
                return [self.intervals(blocks, estimator) for blocks in pair]

            self.add(("range_extent_3db", "range_extent_10db", "range_equivalent_width"), "mmm", sector, band,
                     *figures(_figures.range_figures))
            names = ("bottom_range",) if band == _figures.NADIR_BAND_DEG else ("bottom_range", "alignment")
            self.add(names, ("m", "degree"), sector, band,
                     *([x[: len(names)] for x in result] for result in figures(_figures.alignment_figures)))
            if band == _figures.NADIR_BAND_DEG:
                continue
            self.add(("extent_3db", "extent_10db", "equivalent_width", "side_lobe_inner", "side_lobe_outer", "side_lobe"),
                     ("degree", "degree", "degree", "dB", "dB", "dB"), sector, band, *figures(_figures.angle_figures))
            curves = figures(_figures.relative_curve)
            kept = {"x": _figures.ANGLES_DEG}
            for name, values in zip(("measured", "simulated"), curves):
                kept.update(zip((name, name + "_low", name + "_high"), values))
            self.out.curves[(self.pair[0].name, sector, *band)] = kept
            samples = [_figures.sample_sums(e, s, beams, c[0]) for (e, s), c in zip(self.both(), curves)]
            # Without speckle, the simulation predicts Rayleigh amplitudes.
            statistics = [self.intervals(blocks, _figures.sample_figures) for blocks in samples]
            if not self.pair[1].has_speckle:
                statistics[1] = np.tile([2.0, 0.0, np.nan], (3, 1))
            self.add(("intensity_moment", "k_inverse_shape", "exponential_distance"), "111", sector, band, *statistics)

    def arcs(self) -> None:
        sums = [_figures.arc_sums(e, s) for e, s in self.both()]
        for band, *pair in zip(_figures.ARCS_DEG, *sums):
            if all(len(blocks["count"]) for blocks in pair):
                self.add(("arc",), ("dB",), None, band, *(self.intervals(blocks, _figures.arc_figures) for blocks in pair))
            else:
                self.note(f"no beam is {band[0]:g} to {band[1]:g} degrees from the first return: no row")

    def angular_response(self, sector: int) -> None:
        measured, simulated = (_figures.response_sums(e, s, sector) for e, s in self.both())
        if not measured or not simulated:
            self.note(f"sector {sector} shows no seabed echo: no angular response")
            return
        known = (measured["count"].sum(axis=0) > 0) & (simulated["count"].sum(axis=0) > 0)
        weight = np.minimum(measured["count"].sum(axis=0), simulated["count"].sum(axis=0))
        edges = np.arange(0, 90, 10)
        band_of = (_figures.INCIDENCES_DEG / 10).astype(int)
        bands = [k for k in range(len(edges)) if known[band_of == k].any()]

        def levels(total: _figures.Sums) -> np.ndarray:
            energy = _figures.response(total)
            of_band = [_figures.decibels(np.nanmean(energy[known & (band_of == k)])) if
                       np.isfinite(energy[known & (band_of == k)]).any() else np.nan for k in bands]
            return np.array(of_band) - np.nanmean(of_band)

        if len(bands) > 1:
            pair = [np.asarray(self.intervals(blocks, levels)) for blocks in (measured, simulated)]
            for k, band in enumerate(bands):
                self.add(("relative_level",), ("dB",), sector, (edges[band], edges[band] + 10), *(x[:, [k]] for x in pair))

        def ratio(mine: _figures.Sums, other: _figures.Sums) -> np.ndarray:
            return _figures.decibels(_figures.response(mine) / np.where(known, _figures.response(other), np.nan))

        def smooth(ratio_db: np.ndarray) -> np.ndarray:
            w = np.where(np.isfinite(ratio_db), weight, 0.0)
            kernel = np.array([0.5, 1, 0.5])
            total = np.convolve(w, kernel, "same")
            return np.where(known & (total > 0), np.convolve(w * np.nan_to_num(ratio_db), kernel, "same")
                            / np.where(total > 0, total, 1), np.nan)

        draws = []
        blocks = [len(sums["count"]) for sums in (measured, simulated)]
        for _ in range(self.out.resamples if min(blocks) >= _figures.FEWEST_BLOCKS else 0):
            pair = []
            for sums, n in zip((measured, simulated), blocks):
                drawn = np.bincount(self.rng.integers(n, size=n), minlength=n).astype(float)
                pair.append({name: np.tensordot(drawn, values, 1) for name, values in sums.items()})
            one = ratio(*pair)
            draws.append(np.concatenate([_figures.fitted_response(one, weight), smooth(one)]))
        central = ratio(*({name: values.sum(axis=0) for name, values in sums.items()} for sums in (measured, simulated)))
        value = np.concatenate([_figures.fitted_response(central, weight), smooth(central)])
        unknown = (np.full(value.shape, np.nan),) * 2
        low, high = _figures.widened(value, np.array(draws), min(blocks)) if draws else unknown
        away = _figures.INCIDENCES_DEG[known]
        half = _figures.RESPONSE_BIN_DEG / 2
        names, units = ("level_offset", "cosine_exponent", "specular_level", "specular_width"), ("dB", "1", "dB", "degree")
        fitted = [k for k in range(4) if np.isfinite(value[k])]
        self.add([names[k] for k in fitted], [units[k] for k in fitted], sector, (away.min() - half, away.max() + half),
                 [x[fitted] for x in (value, low, high)], None)
        for k in np.flatnonzero(known):
            grazing = 90 - _figures.INCIDENCES_DEG[k]
            row = {"mode": self.pair[0].name, "sector": sector, "frequency_khz": float(self.pair[0].frequency_khz[sector]),
                   "grazing_deg": float(grazing), "ratio_db": value[4 + k], "ratio_low_db": low[4 + k],
                   "ratio_high_db": high[4 + k]}
            if self.lambert_db is not None:
                row["strength_db"] = self.lambert_db + 20 * np.log10(np.sin(np.radians(grazing))) + value[4 + k]
            self.out.material.append(row)


def seabed_table(material: Sequence[dict[str, Any]]) -> list[tuple[float, float]]:
    """Returns a table of the seabed for a scene: grazing angles in degrees, increasing, and backscattering strengths in dB.

    The calibration of the measured levels is unknown. The mean of the ratio at incidences of 30 to 60 degrees is therefore
    removed, so that the table has the level of the simulated seabed there. The mode with the largest range of incidences
    determines the table, as the mean over its sectors. The strengths of the ends apply down to a grazing angle of 1 degree, by
    Lambert's law, and up to 90 degrees. The result is empty if no mode has incidences from 30 to 60 degrees.

    Args:
        material: :attr:`Comparison.material` with ``strength_db``.
    """
    best: dict[float, list[float]] = {}
    for mode in dict.fromkeys(row["mode"] for row in material):
        strengths: dict[float, list[float]] = {}
        for sector in sorted({row["sector"] for row in material if row["mode"] == mode}):
            rows = [row for row in material if row["mode"] == mode and row["sector"] == sector and np.isfinite(row["ratio_db"])]
            offset = [row["ratio_db"] for row in rows if 30 <= row["grazing_deg"] <= 60]
            for row in rows if offset else ():
                strengths.setdefault(row["grazing_deg"], []).append(row["strength_db"] - float(np.mean(offset)))
        if len(strengths) > len(best):
            best = strengths
    table = [(angle, float(np.mean(best[angle]))) for angle in sorted(best)]
    if not table:
        return []
    lowest = table[0][1] + 20 * np.log10(np.sin(np.radians(1)) / np.sin(np.radians(table[0][0])))
    return [(1.0, float(lowest)), *table, (90.0, table[-1][1])]


def compare_measured(measured: PathLike, simulated: PathLike, *, sensor: Optional[str] = None, seed: int = 1,
                     resamples: int = 400, simulated_lambert_db: Optional[float] = None) -> Comparison:
    """Compares the water column of a measured multibeam with that of a simulated one.

    Args:
        measured: echo file of the measured data, or its folder. ``recorded_range_min`` and ``recorded_range_max`` (ping, beam;
            m) limit the recorded range bins. An energy of 0 between them is a level below the lowest code. Beams in which
            ``detected_range`` (ping, beam; m) is NaN in most pings are outside of the swath and left out.
        simulated: echo file of the simulated data, with sensors of the same names, beams and range bins. The number of pings
            may differ. ``received`` is used if present, and ``energy`` if not.
        sensor: name of the only sensor (mode of the sonar) to compare. By default, all common sensors.
        seed: seed of the bootstrap.
        resamples: number of resamples per figure, at least 20.
        simulated_lambert_db: Lambert strength of the simulated seabed in dB. With it, ``material`` contains the implied
            backscattering strength, which includes the unknown calibration of the measured levels.

    Returns:
        A :class:`Comparison`.

    The seabed has the range R(theta) at the angle theta across the track. It is a robust fit of local planes to the echoes of
    the file itself, per ping. The extent over angle belongs to the mean power over beams and pings against
    (r - R) / |dR/dtheta|, in bins of 0.1 degrees that are averaged over 5 bins. The bootstrap resamples blocks of at least 3
    degrees of neighbouring beams of one ping, sector and side. Figures of less than 4 blocks have no interval. With less than
    about 20 blocks, the intervals of the extents are too long rather than too short.

    Raises:
        InputError: a file is invalid, the files have no common sensor, or the beams or range bins differ.
        UsageError: ``resamples`` is too small, or ``seed`` is negative.
    """
    if whole("resamples", resamples) < 20:
        raise UsageError(f"resamples: expected 20 or more, not {resamples}")
    if whole("seed", seed) < 0:
        raise UsageError(f"seed: expected 0 or more, not {seed}")
    _echoes.library("scipy.ndimage", "the comparison")
    out = Comparison(seed=seed, resamples=resamples)
    rng = np.random.default_rng(seed)
    with _echoes.open_file(os.fspath(measured)) as mine, _echoes.open_file(os.fspath(simulated)) as other:
        groups = _echoes.sensors_of(mine), _echoes.sensors_of(other)
        names = [name for name in groups[0] if name in groups[1] and sensor in (None, name)]
        if not names:
            wanted = "no common sensor" if sensor is None else f"no common sensor {sensor!r}"
            raise InputError(f"{other.filepath()}: {wanted}: the measured file has {_listed(groups[0])}, the simulated file has "
                             f"{_listed(groups[1])}; name the sensors of the scene like those of the measured file",
                             other.filepath())
        for k, group in enumerate(groups):
            left = [name for name in group if name not in groups[1 - k]]
            if left and sensor is None:
                out.notes.append(f"only the {('measured', 'simulated')[k]} file has {_listed(left)}: no rows")
        for name in names:
            pair = tuple(_echoes.echoes_of(file, name, group[name]) for file, group in zip((mine, other), groups))
            _echoes.matching(*pair)
            try:
                _Study(out, pair, rng, simulated_lambert_db).run()
            except InputError as error:
                if len(names) == 1:
                    raise
                out.notes.append(str(error))
    order = list(QUANTITIES)
    out.rows.sort(key=lambda row: (order.index(row["quantity"]), names.index(row["mode"])))
    return out


def _listed(names: Any) -> str:
    return ", ".join(map(repr, names)) or "no sensor"
