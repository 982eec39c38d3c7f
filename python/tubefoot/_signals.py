# SPDX-License-Identifier: GPL-3.0-or-later
"""What the elements of a sonar receive, with phase; beams and pictures of it."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import NamedTuple, Optional, Union

import numpy as np

from . import _native
from ._arrays import finite, unmasked
from ._scene import PathLike
from ._words import with_named_arguments

Vector = Union[Sequence[float], np.ndarray]


class Waveform(NamedTuple):
    """What a sonar transmits: a pulse of one frequency, or an even chirp; its energy is 1."""

    start: float
    """First frequency in Hz."""
    stop: float
    """Last frequency in Hz; the first one again: no chirp."""
    duration: float
    """In s."""
    taper: float = 0.0
    """Share of the duration in both raised-cosine flanks: 0 a rectangle, 1 a Hann window."""


class Signals:
    """Complex baseband signals of pings, receivers and samples; the time factor is exp(-i omega t).

    ``P`` pings, ``R`` receivers, ``S`` samples. Arrays are read-only; the large one is the program's own memory.
    docs/files-signals.md has the file, docs/beamforming.md the formulas.
    """

    def __init__(self, native: _native.Signals) -> None:
        self._native = native
        self._arrays = native.arrays()
        self._numbers = native.numbers()

    @property
    def pressure(self) -> np.ndarray:
        """(P, R, S) complex128: signals in W^(1/2), for a pulse of 1 J/sr at 1 m."""
        return self._arrays["pressure"]

    @property
    def ping_times(self) -> np.ndarray:
        """(P,) float64: starts of the transmissions in s on the scene's clock."""
        return self._arrays["ping_times"]

    @property
    def sample_times(self) -> np.ndarray:
        """(S,) float64, a copy: times of the samples in s after their ping's start."""
        return self._arrays["sample_times"]

    @property
    def positions(self) -> np.ndarray:
        """(P, 3) float64, a copy: of the vehicle at the pings' starts in m, east, north, up."""
        return self._arrays["positions"]

    @property
    def attitudes(self) -> np.ndarray:
        """(P, 4) float64, a copy: quaternions w, x, y, z that turn the vehicle's axes into the local frame."""
        return self._arrays["attitudes"]

    @property
    def receivers(self) -> np.ndarray:
        """(R, 3) float64: places on the vehicle in m, starboard, forward, up."""
        return self._arrays["receivers"]

    @property
    def transmitter(self) -> np.ndarray:
        """(3,) float64, a copy: its place on the vehicle in m."""
        return np.array(self._numbers["transmitter"])

    @property
    def waveform(self) -> Waveform:
        """What was transmitted."""
        return Waveform(*self._numbers["waveform"])

    @property
    def baseband_frequency(self) -> float:
        """In Hz: what the signals are a baseband about."""
        return self._numbers["baseband_frequency"]

    @property
    def sample_rate(self) -> float:
        """Complex samples a second."""
        return self._numbers["sample_rate"]

    @property
    def sound_speed(self) -> float:
        """In m/s."""
        return self._numbers["sound_speed"]

    @property
    def stop_and_hop(self) -> bool:
        """Whether the vehicle stands still during a ping."""
        return self._numbers["stop_and_hop"]

    @property
    def is_matched_filtered(self) -> bool:
        """Whether the waveform is compressed, so that echoes peak at their delay."""
        return self._numbers["matched_filtered"]

    @with_named_arguments
    def matched_filtered(self, window: str = "uniform", *, side_lobe_db: float = 30, nearly_equal: int = 4) -> Signals:
        """Signals with the waveform compressed; arguments as of :func:`window_weights`.

        Raises ValueError for signals that are matched filtered already.
        """
        return Signals(self._native.matched_filtered(window, side_lobe_db, nearly_equal))

    @with_named_arguments
    def beams(self, directions: Vector, pings: Optional[Sequence[int]] = None, *, weights: Optional[Vector] = None,
              reference: Vector = (0, 0, 0), near_field: bool = False, by_phase: bool = False, band: float = 0.8,
              error: float = 1e-5) -> np.ndarray:
        """Receive beams by delay and sum, (pings, beams, S) complex128.

        Args:
            directions: (beams, 3), on the vehicle's axes.
            pings: by number; all, unless given.
            weights: (R,), as of :func:`window_weights`; all 1, unless given.
            reference: place on the vehicle that times and phases are counted from, in m.
            near_field: every sample is focused at its own distance, by exact delays.
            by_phase: by phases of spectra instead of delays in time; of plane waves only.
            band, error: of the interpolator: share of half the sampling rate that signals fill, and the largest error.

        Raises ValueError for what makes no beams.
        """
        chosen = range(len(self.ping_times)) if pings is None else pings
        return self._native.beams([_count(p, "a ping's number") for p in chosen], finite(directions, "directions"),
                                  _reals(weights, "weights"), _vector(reference, "reference"), near_field, by_phase, band,
                                  error)

    @with_named_arguments
    def back_projected(self, first: Vector, column_step: Vector, row_step: Vector, columns: int, rows: int, *,
                       ping_weights: Optional[Vector] = None, receiver_weights: Optional[Vector] = None,
                       half_beam_rad: Optional[float] = None, spreading_undone: bool = True, band: float = 0.8,
                       error: float = 1e-5) -> np.ndarray:
        """A picture of a plane, focused by all pings, (rows, columns) complex128; a point has its strength in m.

        Args:
            first: place of the first pixel in the scene's frame, in m.
            column_step, row_step: from one column, or row, to the next, in m.
            columns, rows: how many there are.
            ping_weights, receiver_weights: all 1, unless given.
            half_beam_rad: pings that a pixel lies further from abeam of are left out.
            spreading_undone: multiplies each echo by its distances out and home.
            band, error: of the interpolator, as of :meth:`beams`.

        Raises ValueError for what makes no picture.
        """
        return self._native.focused(_vector(first, "first"), _vector(column_step, "column_step"),
                                    _vector(row_step, "row_step"), _count(columns, "columns"), _count(rows, "rows"),
                                    _reals(ping_weights, "ping_weights"), _reals(receiver_weights, "receiver_weights"),
                                    half_beam_rad, spreading_undone, band, error)

    @with_named_arguments
    def write(self, file: PathLike) -> None:
        """Writes signals.nc: whole, or not at all.

        Raises UsageError for a place that nothing can be written at.
        """
        self._native.write(os.fspath(file))


def _reals(values: Optional[Vector], name: str) -> np.ndarray:
    return np.zeros(0) if values is None else finite(values, name)


def _vector(values: Vector, name: str) -> list[float]:
    return finite(values, name).tolist()


def _count(value: int, what: str) -> int:
    unmasked(value, what)
    if value != int(value) or value < 0:
        raise ValueError(f"{what} must be a whole number of 0 or more, not {value}")
    return int(value)


@with_named_arguments
def signals(file: PathLike) -> Signals:
    """Signals of a file, ours or of anybody who keeps to docs/files-signals.md: ``tubefoot.signals("signals.nc").pressure``.

    Raises:
        InputError: there is no such file, or something in it is wrong.
    """
    return Signals(_native.read_signals(os.fspath(file)))


@with_named_arguments
def point_signals(targets: Vector, strengths: Vector, *, receivers: Vector, transmitter: Vector = (0, 0, 0),
                  waveform: Waveform, baseband_frequency: float, sample_rate: float, samples: int,
                  first_sample: float = 0.0, ping_times: Vector = (0.0,), track_times: Vector = (0.0,),
                  positions: Vector = ((0.0, 0.0, 0.0),), attitudes: Optional[Vector] = None,
                  stop_and_hop: bool = True, sound_speed: float = 1500.0) -> Signals:
    """What elements receive of point scatterers in open water, in closed form: exact delays, no occlusion.

    Args:
        targets: (N, 3), places in m.
        strengths: (N,) complex, in m: target strength is ``10 log |f|^2``.
        receivers: (R, 3), places on the vehicle in m.
        transmitter: its place on the vehicle.
        waveform: what is transmitted.
        baseband_frequency, sample_rate, samples, first_sample: how it is sampled: Hz, Hz, number, s after the start.
        ping_times: starts of the transmissions in s.
        track_times, positions, attitudes: (K,), (K, 3) and (K, 4): the vehicle's way; without attitudes it looks north.
        stop_and_hop: the vehicle stands still during a ping; else it moves while sound is under way.
        sound_speed: in m/s.

    Raises ValueError, saying what to do, for bands above half the sampling rate, waveforms longer than the record, and
    whatever else makes no signals.
    """
    way = finite(positions, "positions")
    turns = np.tile([1.0, 0, 0, 0], (len(way), 1)) if attitudes is None else finite(attitudes, "attitudes")
    return Signals(_native.point_signals(
        finite(targets, "targets"), finite(strengths, "strengths", complex), _vector(transmitter, "transmitter"),
        finite(receivers, "receivers"), _vector(waveform, "waveform"), baseband_frequency, sample_rate, first_sample,
        _count(samples, "samples"), finite(track_times, "track_times"), way, turns, finite(ping_times, "ping_times"),
        stop_and_hop, sound_speed))


@with_named_arguments
def window_weights(window: str, elements: int, *, side_lobe_db: float = 30, nearly_equal: int = 4) -> np.ndarray:
    """Weights of evenly spaced elements, (elements,) float64.

    Args:
        window: "uniform", "hann", "hamming", "taylor" or "chebyshev".
        elements: how many there are.
        side_lobe_db: of the last two, below the main lobe.
        nearly_equal: of Taylor's: how many side lobes, less one, are near that.
    """
    return _native.window_weights(window, _count(elements, "elements"), side_lobe_db, nearly_equal)
