# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of the seabed echo of a multibeam, and their uncertainties. Part of :mod:`tubefoot.measured`.

All figures are functions of sums over *blocks*. A block contains neighbouring beams of one ping, one sector and one side.
Beams overlap, so that each scatterer contributes to several neighbouring beams. Blocks that are longer than a beam are nearly
independent. The sum over all beams that receive a scatterer varies less than a part of this sum. For short blocks, the
intervals of the extents are therefore too long.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Optional

import numpy as np

from ._measured_echoes import Echoes, Seabed, echo_half_width, pings_of

BANDS_DEG = ((30.0, 40.0), (40.0, 50.0), (50.0, 58.0))  # incidence bands of the extents: angle of the beam from straight down
NADIR_BAND_DEG = (0.0, 10.0)  # band of the extent over range only
ARCS_DEG = ((3.0, 5.0), (10.0, 20.0), (20.0, 30.0), (30.0, 45.0), (45.0, 60.0))  # angles from the beam of the first return
BLOCK_DEG = 3.0  # smallest length of a block, except where a band or a sector is shorter
ENOUGH_BLOCKS = 20  # blocks are not shorter than this number of blocks needs
FEWEST_BLOCKS = 4  # figures of less blocks have no interval

ANGLE_BIN_DEG, ANGLE_HALF_DEG = 0.1, 8.0  # bins of the extent over angle
RANGE_BIN_M, RANGE_HALF_M = 0.02, 1.5  # bins of the extent over range
BINS_OF_MEAN = 5  # the curves are running means over this number of bins
RESPONSE_BIN_DEG = 2.0  # bins of the angular response
LEVELS = np.geomspace(1e-4, 1e2, 241)  # bounds of the histogram of normalised samples, 0.25 dB apart

# Student's 0.975 quantile for 1, 2, ... degrees of freedom.
_STUDENT = np.array([12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160, 2.145,
                     2.131, 2.120, 2.110, 2.101, 2.093, 2.086, 2.080, 2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048])

Sums = dict[str, np.ndarray]


def decibels(ratio: np.ndarray) -> np.ndarray:
    """Returns 10 log10 of the ratio, and NaN for ratios of 0 or less."""
    ratio = np.asarray(ratio, float)
    return 10 * np.log10(np.where(ratio > 0, ratio, np.nan))


def intervals(blocks: Sums, estimator: Callable[[Sums], np.ndarray], rng: np.random.Generator,
              resamples: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns the figures of all blocks, and the ends of their 95 % bootstrap intervals.

    Args:
        blocks: sums per block; the first axis of each array is the block.
        estimator: function of the sums over all blocks. It returns one or several figures.
        rng: source of the resamples.
        resamples: number of resamples. Each draws as many blocks as there are, with replacement (Efron 1979).

    The percentile interval is too short for few blocks. Its distances from the figure are therefore multiplied by
    Student's quantile over the normal quantile, and by sqrt(n / (n - 1)) for n blocks. The interval is NaN for less than
    :data:`FEWEST_BLOCKS` blocks.
    """
    value = np.atleast_1d(estimator({k: v.sum(axis=0) for k, v in blocks.items()}))
    n = len(next(iter(blocks.values())))
    if n < FEWEST_BLOCKS:
        return value, np.full(value.shape, np.nan), np.full(value.shape, np.nan)
    draws = np.empty((resamples, len(value)))
    for k in range(resamples):
        weight = np.bincount(rng.integers(n, size=n), minlength=n).astype(float)
        draws[k] = estimator({name: np.tensordot(weight, sums, 1) for name, sums in blocks.items()})
    return (value, *widened(value, draws, n))


def widened(value: np.ndarray, draws: np.ndarray, blocks: int) -> tuple[np.ndarray, np.ndarray]:
    """Returns the ends of the intervals of :func:`intervals` for given resampled figures, (resamples, figures)."""
    enough = np.isfinite(draws).sum(axis=0) >= max(2, 0.5 * len(draws))
    low, high = np.nanquantile(np.where(enough, draws, 0), [0.025, 0.975], axis=0)
    factor = (_STUDENT[blocks - 2] if blocks - 2 < len(_STUDENT) else 1.96 + 2.4 / (blocks - 1)) / 1.96
    factor *= np.sqrt(blocks / (blocks - 1))
    low, high = np.minimum(low, value), np.maximum(high, value)
    known = enough & np.isfinite(value)
    return (np.where(known, value - factor * (value - low), np.nan), np.where(known, value + factor * (high - value), np.nan))


def blocks_of(angle: np.ndarray, beams: np.ndarray, pings: int) -> np.ndarray:
    """Returns the block of each beam in a ping, counted from 0, and -1 for beams that are not in ``beams``."""
    block, count = np.full(len(angle), -1), 0
    sides = [beams[np.sign(angle[beams] + 1e-9) == side] for side in (-1, 1)]
    sides = [side[np.argsort(angle[side])] for side in sides if len(side)]
    wanted = -(-ENOUGH_BLOCKS // max(1, pings * len(sides)))
    for run in sides:
        length = (angle[run[-1]] - angle[run[0]]) * len(run) / max(1, len(run) - 1)
        for piece in np.array_split(run, max(1, min(wanted, int(length / BLOCK_DEG)))):
            block[piece] = count
            count += 1
    return block


def beams_in(echoes: Echoes, sector: int, band: tuple[float, float]) -> np.ndarray:
    """Returns the beams of a sector in an incidence band on both sides."""
    away = np.abs(echoes.angle)
    return np.flatnonzero((echoes.sector == sector) & (away >= band[0]) & (away < band[1]))


def _add(total: np.ndarray, block: np.ndarray, bins: np.ndarray, keep: np.ndarray,
         values: Optional[np.ndarray] = None) -> None:
    """Adds values, or counts, to the bins of blocks. ``bins``, ``keep`` and ``values`` are (beams, samples)."""
    cell = (block[:, None] * total.shape[1] + bins)[keep]
    total += np.bincount(cell, None if values is None else values[keep], total.size).reshape(total.shape)


def _axis(half: float, step: float) -> np.ndarray:
    return (np.arange(int(round(2 * half / step))) + 0.5) * step - half


ANGLES_DEG, RANGES_M = _axis(ANGLE_HALF_DEG, ANGLE_BIN_DEG), _axis(RANGE_HALF_M, RANGE_BIN_M)


def curve_sums(echoes: Echoes, seabed: Seabed, bands: Iterable[tuple[int, np.ndarray]]) -> list[Sums]:
    """Sums power over the bins of the echo curves, per block, for each sector and beams of ``bands``.

    ``angle_power`` and ``angle_count`` belong to bins of (r - R) / |dR/dtheta|, and ``range_power`` and ``range_count`` to
    bins of r - R. ``centroid_square`` is the sum of squared deviations of the centroids from R in square degrees,
    ``bottom_range`` the sum of R in m and ``beams`` the number of beams.
    """
    axes = {"angle": (ANGLES_DEG, ANGLE_BIN_DEG, ANGLE_HALF_DEG), "range": (RANGES_M, RANGE_BIN_M, RANGE_HALF_M)}
    bands = [(beams, blocks_of(echoes.angle, beams, echoes.pings)) for _, beams in bands]
    out: list[dict[str, list[np.ndarray]]] = [{} for _ in bands]
    for ping, energy, known in pings_of(echoes, seabed):
        for (beams, block), sums in zip(bands, out):
            beams = beams[seabed.valid[ping, beams]]
            if not len(beams):
                continue
            mine, count = block[beams], 1 + int(block.max())
            r, rate = seabed.range[ping, beams], seabed.rate[ping, beams]
            away = echoes.slant_range - r[:, None]
            new = {}
            for name, (axis, step, half) in axes.items():
                x = away / rate[:, None] if name == "angle" else away
                keep = known[beams] & (np.abs(x) < half)
                bins = np.clip(np.floor((np.where(keep, x, 0) + half) / step).astype(int), 0, len(axis) - 1)
                new[name + "_power"], new[name + "_count"] = np.zeros((count, len(axis))), np.zeros((count, len(axis)))
                _add(new[name + "_power"], mine, bins, keep, energy[beams])
                _add(new[name + "_count"], mine, bins, keep)
            deviation = (seabed.centroid[ping, beams] - r) / rate
            for name, values in (("centroid_square", deviation**2), ("bottom_range", r), ("beams", np.ones(len(beams)))):
                new[name] = np.bincount(mine, values, count)
            present = new["beams"] > 0
            for name, values in new.items():
                sums.setdefault(name, []).append(values[present])
    return [{name: np.concatenate(values) for name, values in sums.items()} for sums in out]


def curve(power: np.ndarray, count: np.ndarray) -> np.ndarray:
    """Returns the mean power per bin, averaged over :data:`BINS_OF_MEAN` bins. Empty bins are left out."""
    full = count > 0
    mean = np.where(full, power / np.where(full, count, 1), 0)
    kernel = np.ones(BINS_OF_MEAN)
    bins = np.convolve(full, kernel, "same")
    return np.where(bins > 0, np.convolve(mean, kernel, "same") / np.maximum(bins, 1), np.nan)


def relative_curve(sums: Sums) -> np.ndarray:
    """Returns the curve over angle relative to its peak."""
    power = curve(sums["angle_power"], sums["angle_count"])
    peak = np.nanmax(power, initial=0)
    return power / peak if peak > 0 else np.full(power.shape, np.nan)


def crossing_width(axis: np.ndarray, power: np.ndarray, level_db: float) -> float:
    """Returns the distance of the crossings at ``level_db`` below the peak that are nearest to the peak.

    The crossings are interpolated in decibels. The width is NaN if the curve does not fall to the level on both sides.
    """
    peak = int(np.nanargmax(power)) if np.nanmax(power, initial=0) > 0 else -1
    if peak < 0:
        return np.nan
    level = 10 * np.log10(np.maximum(power, 1e-30 * power[peak]) / power[peak]) + level_db
    ends = []
    for side in (-1, 1):
        k = peak
        while 0 <= k + side < len(level) and not level[k + side] < 0:
            k += side
        if not 0 <= k + side < len(level) or np.isnan(level[k]):
            return np.nan
        ends.append(axis[k] + (axis[k + side] - axis[k]) * level[k] / (level[k] - level[k + side]))
    return ends[1] - ends[0]


def extents(axis: np.ndarray, power: np.ndarray) -> np.ndarray:
    """Returns the widths of a curve at -3 dB and -10 dB, and its equivalent width, which is integral over peak."""
    known = np.nan_to_num(power)
    peak = known.max()
    equivalent = known.sum() * (axis[1] - axis[0]) / peak if peak > 0 else np.nan
    return np.array([crossing_width(axis, power, 3), crossing_width(axis, power, 10), equivalent])


def angle_figures(sums: Sums) -> np.ndarray:
    """Figures of the curve over angle: three extents, then the levels in dB at -5 to -3, 3 to 5 and both, in degrees."""
    power = curve(sums["angle_power"], sums["angle_count"])
    peak = np.nanmax(power, initial=0)
    levels = []
    for chosen in ((ANGLES_DEG > -5) & (ANGLES_DEG < -3), (ANGLES_DEG > 3) & (ANGLES_DEG < 5),
                   (np.abs(ANGLES_DEG) > 3) & (np.abs(ANGLES_DEG) < 5)):
        count = sums["angle_count"][chosen].sum()
        levels.append(decibels(sums["angle_power"][chosen].sum() / max(count, 1) / peak) if peak > 0 else np.nan)
    return np.array([*extents(ANGLES_DEG, power), *levels])


def range_figures(sums: Sums) -> np.ndarray:
    """Figures of the curve over range: its three extents in m."""
    return extents(RANGES_M, curve(sums["range_power"], sums["range_count"]))


def alignment_figures(sums: Sums) -> np.ndarray:
    """Mean range of the seabed in m, and root mean square deviation of the centroids of single beams in degrees."""
    beams = max(sums["beams"], 1)
    return np.array([sums["bottom_range"] / beams, np.sqrt(sums["centroid_square"] / beams)])


def sample_sums(echoes: Echoes, seabed: Seabed, beams: np.ndarray, power: np.ndarray) -> Sums:
    """Sums of normalised samples within the half-power extent, per block.

    Args:
        power: curve over angle. It and the mean level per degree of beam angle normalise the samples.

    Returns:
        ``moment`` (blocks, 3): number, sum and sum of squares; ``histogram`` (blocks, levels): counts between
        :data:`LEVELS`, with one more bin at each end.
    """
    inside = np.nan_to_num(power) > 0.5 * np.nanmax(power, initial=0)
    low, high = (ANGLES_DEG[inside][[0, -1]] if inside.any() else (0, 0))
    samples, beam_of, block_of = [], [], []
    block = blocks_of(echoes.angle, beams, echoes.pings)
    for number, (ping, energy, known) in enumerate(pings_of(echoes, seabed)):
        mine = beams[seabed.valid[ping, beams]]
        x = (echoes.slant_range - seabed.range[ping, mine, None]) / seabed.rate[ping, mine, None]
        keep = known[mine] & (x >= low) & (x <= high)
        shape = np.interp(x, ANGLES_DEG, np.nan_to_num(power))
        ratio = (energy[mine] / np.where(shape > 0, shape, np.inf))[keep]
        rows = np.nonzero(keep)[0]
        samples.append(ratio)
        beam_of.append(mine[rows])
        block_of.append(block[mine[rows]] + number * (1 + block.max()))
    if not samples:
        return {"moment": np.zeros((0, 3)), "histogram": np.zeros((0, len(LEVELS) + 1))}
    values, beam, blocks = map(np.concatenate, (samples, beam_of, block_of))
    group = np.round(np.abs(echoes.angle[beam]) / 5).astype(int)
    count = np.maximum(np.bincount(group), 1)
    values = values / np.maximum((np.bincount(group, values) / count)[group], 1e-300)
    _, blocks = np.unique(blocks, return_inverse=True)
    n = int(blocks.max(initial=-1)) + 1
    moment = np.stack([np.bincount(blocks, w, n) for w in (np.ones(len(values)), values, values**2)], axis=1)
    histogram = np.zeros((n, len(LEVELS) + 1))
    np.add.at(histogram, (blocks, np.searchsorted(LEVELS, values, side="right")), 1)
    return {"moment": moment, "histogram": histogram}


def sample_figures(sums: Sums) -> np.ndarray:
    """Statistics of the samples: <I^2>/<I>^2, 1/nu of the K distribution, and distance from the exponential distribution.

    For a K distribution of the amplitude with the shape nu, <I^2>/<I>^2 = 2 (1 + 1/nu) (Jakeman and Pusey 1976). Rayleigh
    amplitudes have 2 and 1/nu = 0. The distance is that of Kolmogorov, at steps of 0.25 dB.
    """
    n, first, second = sums["moment"]
    if n < 2 or first <= 0:
        return np.full(3, np.nan)
    moment = n * second / first**2
    below = np.cumsum(sums["histogram"])[:-1] / n
    return np.array([moment, moment / 2 - 1, np.abs(below - (1 - np.exp(-LEVELS * n / first))).max()])


def response_sums(echoes: Echoes, seabed: Seabed, sector: int) -> Sums:
    """Sums of the energy of the seabed echo per beam over bins of incidence, per block: ``energy`` and ``count``."""
    beams = np.flatnonzero(echoes.sector == sector)
    block = blocks_of(echoes.angle, beams, echoes.pings)
    bins = int(90 / RESPONSE_BIN_DEG)
    energies, counts = [], []
    for ping, energy, known in pings_of(echoes, seabed):
        mine = beams[seabed.valid[ping, beams]]
        r, rate = seabed.range[ping, mine, None], seabed.rate[ping, mine, None]
        half = echo_half_width(rate, echoes.pulse_m[sector], r)
        total = (energy[mine] * (np.abs(echoes.slant_range - r) <= half)).sum(axis=1)
        place = np.clip((seabed.incidence[ping, mine] / RESPONSE_BIN_DEG).astype(int), 0, bins - 1)
        new = np.zeros((2, 1 + int(block.max()), bins))
        np.add.at(new[0], (block[mine], place), total)
        np.add.at(new[1], (block[mine], place), 1)
        present = new[1].any(axis=1)
        energies.append(new[0][present])
        counts.append(new[1][present])
    return {"energy": np.concatenate(energies), "count": np.concatenate(counts)} if counts else {}


INCIDENCES_DEG = (np.arange(int(90 / RESPONSE_BIN_DEG)) + 0.5) * RESPONSE_BIN_DEG


def response(sums: Sums) -> np.ndarray:
    """Returns the mean energy per beam in bins of incidence, NaN where there is none."""
    return np.where(sums["count"] > 0, sums["energy"] / np.maximum(sums["count"], 1), np.nan)


def fitted_response(ratio_db: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Fits ratio = a + b 10 log10(cos i) + c exp(-i^2 / (2 w^2)) over the incidence i. Returns a and c in dB, b, w in degrees.

    The order is a, b, c, w. The specular term is only fitted if there are data below 10 degrees; else c and w are NaN. For
    each w the fit is linear, and w is the best of 24 values from 1 to 10 degrees. The first and last values are limits.

    Args:
        ratio_db: measured over simulated energy per bin of incidence, NaN where unknown.
        weight: weights of the squared residuals.
    """
    known = np.isfinite(ratio_db) & (weight > 0) & (INCIDENCES_DEG < 80)
    i, y, root = INCIDENCES_DEG[known], ratio_db[known], np.sqrt(weight[known])
    if len(i) < 3:
        return np.full(4, np.nan)
    columns = [np.ones(len(i)), 10 * np.log10(np.cos(np.radians(i)))]
    specular = len(i) >= 6 and i.min() < 10 < i.max() - 10

    def solved(more: Sequence[np.ndarray]) -> tuple[np.ndarray, float]:
        matrix = np.stack([*columns, *more], axis=1)
        solution = np.linalg.lstsq(matrix * root[:, None], y * root, rcond=None)[0]
        return solution, float((((matrix @ solution - y) * root) ** 2).sum())

    if not specular:
        return np.array([*solved([])[0], np.nan, np.nan])
    trials = [(*solved([np.exp(-(i**2) / (2 * w * w))]), w) for w in np.geomspace(1, 10, 24)]
    solution, _, w = min(trials, key=lambda trial: trial[1])
    return np.array([*solution, w])


def arc_sums(echoes: Echoes, seabed: Seabed) -> list[Sums]:
    """Sums of power in the range bins of the first return, per block, for each of :data:`ARCS_DEG`.

    The range bins extend from one pulse before to one pulse after the smallest range of the fitted seabed. ``power`` and
    ``count`` belong to beams whose angle from the beam of the first return is in the interval. ``first_power`` and
    ``first_count`` belong to the beams within 1 degree of that beam, in the same ping. On a level seabed, the main lobes of
    beams up to about 8 degrees away also receive echoes from these ranges.
    """
    out: list[Sums] = []
    order = np.argsort(echoes.angle)
    for near, far in ARCS_DEG:
        rows = []
        for ping, energy, known in pings_of(echoes, seabed):
            first = int(np.nanargmin(np.where(seabed.valid[ping], seabed.range[ping], np.nan)))
            nearest, pulse = seabed.range[ping, first], echoes.pulse_m[echoes.sector[first]]
            gate = known & (echoes.slant_range > nearest - pulse) & (echoes.slant_range < nearest + pulse)
            away = echoes.angle - echoes.angle[first]
            main = np.abs(away) < 1
            power = (energy * gate).sum(axis=1)
            chosen = order[(np.abs(away[order]) >= near) & (np.abs(away[order]) < far)]
            block = blocks_of(away, chosen, echoes.pings)
            for k in range(1 + int(block.max(initial=-1))):
                rows.append([power[block == k].sum(), gate[block == k].sum(), power[main].sum(), gate[main].sum()])
        table = np.array(rows, float).reshape(-1, 4)
        out.append(dict(zip(("power", "count", "first_power", "first_count"), table.T)))
    return out


def arc_figures(sums: Sums) -> np.ndarray:
    """Mean power of beams beside the first return relative to that of the first return, in dB."""
    power, count, first, first_count = (float(sums[k]) for k in ("power", "count", "first_power", "first_count"))
    return decibels(power / count / (first / first_count)) if min(count, first, first_count) > 0 else np.array(np.nan)


def water_sums(echoes: Echoes, seabed: Seabed, sector: int) -> Sums:
    """Sums over the water column and the seabed echo of a sector, per block.

    The water column extends from 1 m to 0.5 m or 3 pulses before the first return of the ping. ``empty`` is its number of
    range bins with energy 0. ``seabed_power`` belongs to range bins within one range bin of the seabed.
    """
    beams = np.flatnonzero(echoes.sector == sector)
    block = blocks_of(echoes.angle, beams, echoes.pings)
    rows = []
    for ping, energy, known in pings_of(echoes, seabed):
        end = np.nanmin(np.where(seabed.valid[ping], seabed.range[ping], np.nan)) - max(0.5, 3 * echoes.pulse_m.max())
        gate = known & (echoes.slant_range > 1) & (echoes.slant_range < end)
        with np.errstate(invalid="ignore"):
            echo = known & (np.abs(echoes.slant_range - seabed.range[ping, :, None]) <= echoes.step)
        for k in range(1 + int(block.max(initial=-1))):
            mine = np.flatnonzero(block == k)
            water, bottom = energy[mine][gate[mine]], energy[mine][echo[mine] & seabed.valid[ping, mine, None]]
            rows.append([water.sum(), len(water), (water == 0).sum(), bottom.sum(), len(bottom)])
    table = np.array(rows, float).reshape(-1, 5)
    return dict(zip(("power", "count", "empty", "seabed_power", "seabed_count"), table.T))


def water_figures(sums: Sums) -> np.ndarray:
    """Mean power of the water column relative to that of the seabed echo in dB, and its fraction of empty range bins."""
    if not (sums["count"] > 0 and sums["seabed_power"] > 0):
        return np.full(2, np.nan)
    mean, seabed = sums["power"] / sums["count"], sums["seabed_power"] / sums["seabed_count"]
    return np.array([decibels(mean / seabed), sums["empty"] / sums["count"]])
