# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures that judge the scenes of a suite. Each returns a value and its standard error.

The arguments are the content of scene.json with `range` (centres of the samples) and `limits`, the energies of the reference,
and the energies of the candidate. The dimensions are ping, beam and sample."""
import numpy as np

from .echoes import LIT_SHARE_OF_MEAN


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
    """Mean distance by which the energy of a beam would have to move along range, in samples, with the sign of the mean displacement.

    Positive values are away from the sonar. Opposite displacements of two parts do not cancel."""
    r, c = (x.reshape(-1, x.shape[-1]) for x in (r, c))
    total, theirs = r.sum(axis=1), c.sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        difference = np.cumsum(r, axis=1) / total[:, None] - np.cumsum(c, axis=1) / theirs[:, None]
    distance, displacement = (np.where(theirs > 0, way, r.shape[1])[total > 0] @ total[total > 0] / total.sum()
                              for way in (np.abs(difference).sum(axis=1), difference.sum(axis=1)))
    return np.copysign(distance, displacement) if distance > 0 else 0.0, 0.0


def samples_moved_by_amount(scene, r, c):
    """The same without a sign (versions before 3)."""
    return abs(samples_moved(scene, r, c)[0]), 0.0


def blocks_of(x):
    """Sums over blocks of 4 beams and 8 samples, in which most sampling noise averages out."""
    beams, samples = np.arange(0, x.shape[1], 4), np.arange(0, x.shape[2], 8)
    return np.add.reduceat(np.add.reduceat(x, beams, axis=1), samples, axis=2)


def coarse_l1(scene, r, c):
    """Relative L1 error of blocks."""
    return np.abs(blocks_of(c) - blocks_of(r)).sum() / r.sum(), 0.0


def pings_off(scene, r, c):
    """Difference between the number of a ping and that of the most similar ping of the reference."""
    r, c = (x / np.maximum(x.sum(axis=(1, 2), keepdims=True), 1e-300) for x in (r, c))
    nearest = [np.abs(r - ping).sum(axis=(1, 2)).argmin() for ping in c]
    return float(np.abs(np.array(nearest) - np.arange(len(r))).max()), 0.0


def volume_db(scene, r, c):
    """Level of the samples in which only the water scatters, candidate relative to reference."""
    water = scene["range"] < scene["water_to_m"]
    return level_db(r[:, :, water].sum(), c[:, :, water].sum()), 0.0


def level_db(r, c):
    return float(np.clip(10 * np.log10(max(c, 1e-300) / max(r, 1e-300)), -60.0, 60.0))


def sectors_db(scene, r, c):
    """Largest level of a transmit sector relative to the whole fan, candidate relative to reference."""
    levels = [level_db(r[:, part].sum() / r.sum(), c[:, part].sum() / max(c.sum(), 1e-300)) for part in
              (slice(sector["first_beam"], sector["end_beam"]) for sector in scene["beams"]["sectors"])]
    return max(levels, key=abs), 0.0


def border_db(scene, r, c):
    """Energy in samples that are dark with sharp shadows, relative to the rest, candidate relative to reference."""
    return ratio_db(r, c, scene["sharp"] == 0), 0.0


def gradient_l1(scene, r, c):
    """Relative L1 error of the derivatives in blocks of 4 beams and 8 samples: the largest of all parameters."""
    r, c = (blocks_of(x) for x in (scene["gradient_reference"], scene["gradient_candidate"]))
    return float((np.abs(c - r).sum(axis=(1, 2)) / np.abs(r).sum(axis=(1, 2))).max()), 0.0


MEASURES = {f.__name__: f for f in (gain_db, range_exponent, db_per_km, beams_off, side_lobes_db, bounces_db, lit_in_shadow,
                                    edges_off, samples_moved, coarse_l1, pings_off, volume_db, sectors_db, border_db,
                                    gradient_l1)}


def measures_of(version):
    """Measures by name for a version of the suite."""
    return MEASURES if version >= 3 else MEASURES | {"samples_moved": samples_moved_by_amount}
