# SPDX-License-Identifier: GPL-3.0-or-later
"""Signals of a sonar's elements with phase, and the beams and pictures that they yield."""

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
    """The transmitted waveform: a pulse of one frequency, or a linear chirp. Its energy is 1."""

    start: float
    """First frequency in Hz."""
    stop: float
    """Last frequency in Hz. For a pulse of one frequency it equals ``start``."""
    duration: float
    """Duration in s."""
    taper: float = 0.0
    """Share of the duration in both raised-cosine flanks together: 0 for a rectangle, 1 for a Hann window."""


class Signals:
    """Complex baseband signals by ping, receiver and sample. The time factor is exp(-i omega t).

    ``P`` is the number of pings, ``R`` of receivers and ``S`` of samples. Arrays are read-only. The large array is the
    program's own memory. docs/output-files.md describes the file, and docs/signals.md gives the formulas.
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
    def gradient(self) -> dict[str, np.ndarray]:
        """(P, R, S) complex128 by name of a parameter of run(gradient=[...]): derivatives of the pressures.

        They are derivatives of the echoes of smooth surfaces, in W^(1/2) per unit of the parameter. Other surfaces
        contribute nothing, because their speckle has the mean 0. Empty if the run computes no derivatives of signals.
        """
        return self._arrays.get("gradient", {})

    @property
    def ping_times(self) -> np.ndarray:
        """(P,) float64: start times of the transmissions in s on the scene's clock."""
        return self._arrays["ping_times"]

    @property
    def sample_times(self) -> np.ndarray:
        """(S,) float64, a copy: times of the samples in s after the start of their ping."""
        return self._arrays["sample_times"]

    @property
    def positions(self) -> np.ndarray:
        """(P, 3) float64, a copy: positions of the vehicle at the starts of the pings in m, east, north, up."""
        return self._arrays["positions"]

    @property
    def attitudes(self) -> np.ndarray:
        """(P, 4) float64, a copy: quaternions w, x, y, z that rotate the vehicle's axes into the local frame."""
        return self._arrays["attitudes"]

    @property
    def receivers(self) -> np.ndarray:
        """(R, 3) float64: positions of the receivers on the vehicle in m, starboard, forward, up."""
        return self._arrays["receivers"]

    @property
    def transmitter(self) -> np.ndarray:
        """(3,) float64, a copy: position of the transmitter on the vehicle in m."""
        return np.array(self._numbers["transmitter"])

    @property
    def waveform(self) -> Waveform:
        """The transmitted waveform."""
        return Waveform(*self._numbers["waveform"])

    @property
    def baseband_frequency(self) -> float:
        """Frequency in Hz about which the signals are a complex baseband."""
        return self._numbers["baseband_frequency"]

    @property
    def sample_rate(self) -> float:
        """Number of complex samples per second."""
        return self._numbers["sample_rate"]

    @property
    def sound_speed(self) -> float:
        """Sound speed in m/s."""
        return self._numbers["sound_speed"]

    @property
    def stop_and_hop(self) -> bool:
        """True if the vehicle does not move during a ping."""
        return self._numbers["stop_and_hop"]

    @property
    def is_matched_filtered(self) -> bool:
        """True if the waveform is compressed, so that echoes have their peak at their delay."""
        return self._numbers["matched_filtered"]

    @with_named_arguments
    def matched_filtered(self, window: str = "uniform", *, side_lobe_db: float = 30, nearly_equal: int = 4) -> Signals:
        """Returns the signals after the matched filter. Arguments are those of :func:`window_weights`.

        Raises:
            ValueError: the signals are matched filtered already.
        """
        return Signals(self._native.matched_filtered(window, side_lobe_db, nearly_equal))

    @with_named_arguments
    def beams(self, directions: Vector, pings: Optional[Sequence[int]] = None, *, weights: Optional[Vector] = None,
              reference: Vector = (0, 0, 0), near_field: bool = False, by_phase: bool = False, band: float = 0.8,
              error: float = 1e-5) -> np.ndarray:
        """Computes receive beams by delay and sum, (pings, beams, S) complex128.

        Args:
            directions: (beams, 3), in the vehicle's axes.
            pings: numbers of the pings; by default all.
            weights: (R,), for example from :func:`window_weights`; by default all 1.
            reference: position on the vehicle to which times and phases refer, in m.
            near_field: focuses every sample at its own distance with exact delays.
            by_phase: uses phases of spectra instead of delays in time. This option is for plane waves only.
            band, error: settings of the interpolator. ``band`` is the share of half the sampling rate that signals occupy,
                and ``error`` is the largest error.

        Raises:
            ValueError: the arguments do not define beams.
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
        """Computes an image of a plane by back-projection of all pings, (rows, columns) complex128.

        The value of a point is its strength in m.

        Args:
            first: position of the first pixel in the scene's frame, in m.
            column_step, row_step: vector from one column, or row, to the next, in m.
            columns, rows: number of columns and of rows.
            ping_weights, receiver_weights: weights of the pings and of the receivers; by default all 1.
            half_beam_rad: largest angle of a pixel from abeam, in rad. A ping does not contribute to pixels beyond this
                angle. By default all pings contribute.
            spreading_undone: multiplies each echo by its distances to the transmitter and to the receiver.
            band, error: settings of the interpolator, as for :meth:`beams`.

        Raises:
            ValueError: the arguments do not define an image.
        """
        return self._native.focused(_vector(first, "first"), _vector(column_step, "column_step"),
                                    _vector(row_step, "row_step"), _count(columns, "columns"), _count(rows, "rows"),
                                    _reals(ping_weights, "ping_weights"), _reals(receiver_weights, "receiver_weights"),
                                    half_beam_rad, spreading_undone, band, error)

    @with_named_arguments
    def write(self, file: PathLike) -> None:
        """Writes signals.nc. The file appears only when complete.

        Raises:
            UsageError: the file cannot be written.
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
    """Reads the signals of a file: ``tubefoot.signals("signals.nc").pressure``.

    The file may come from tubefoot or from another program that follows docs/output-files.md.

    Raises:
        InputError: the file does not exist, or its content is invalid.
    """
    return Signals(_native.read_signals(os.fspath(file)))


@with_named_arguments
def point_signals(targets: Vector, strengths: Vector, *, receivers: Vector, transmitter: Vector = (0, 0, 0),
                  waveform: Waveform, baseband_frequency: float, sample_rate: float, samples: int,
                  first_sample: float = 0.0, ping_times: Vector = (0.0,), track_times: Vector = (0.0,),
                  positions: Vector = ((0.0, 0.0, 0.0),), attitudes: Optional[Vector] = None,
                  stop_and_hop: bool = True, sound_speed: float = 1500.0) -> Signals:
    """Computes the signals of point scatterers in unobstructed water in closed form, with exact delays and no occlusion.

    Args:
        targets: (N, 3), positions in m.
        strengths: (N,) complex, in m: target strength is ``10 log |f|^2``.
        receivers: (R, 3), positions on the vehicle in m.
        transmitter: position of the transmitter on the vehicle in m.
        waveform: the transmitted waveform.
        baseband_frequency, sample_rate, samples, first_sample: sampling of the signals: in Hz, in Hz, a number, and in s
            after the start of the ping.
        ping_times: start times of the transmissions in s.
        track_times, positions, attitudes: (K,), (K, 3) and (K, 4), the track of the vehicle. Without attitudes the
            vehicle faces north.
        stop_and_hop: the vehicle does not move during a ping; otherwise it moves while sound travels.
        sound_speed: sound speed in m/s.

    Raises:
        ValueError: the band exceeds half the sampling rate, the waveform is longer than the record, or the arguments do
            not define signals for another reason. The message gives a remedy.
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
    """Computes the weights of uniformly spaced elements, (elements,) float64.

    Args:
        window: "uniform", "hann", "hamming", "taylor" or "chebyshev".
        elements: number of elements.
        side_lobe_db: for "taylor" and "chebyshev": level of the side lobes below the main lobe in dB.
        nearly_equal: for "taylor": the first ``nearly_equal`` - 1 side lobes are near this level.
    """
    return _native.window_weights(window, _count(elements, "elements"), side_lobe_db, nearly_equal)
