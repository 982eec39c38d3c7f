# SPDX-License-Identifier: GPL-3.0-or-later
"""Engines and sensors that are Python functions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Optional, Union

import numpy as np

from . import _native
from ._arrays import first_of, values_and_mask
from ._errors import UsageError
from ._history import History, Transmission


class Engine:
    """A Python function that :func:`run` and :func:`chart` accept as an engine.

    :func:`engine` and :func:`sensor` create engines. A call of the engine calls the function.

    Attributes:
        name: name of the engine in results and charts.
        function: the function itself.
    """

    def __init__(self, name: str, function: Callable[[Any], Any], takes_history: bool) -> None:
        if not isinstance(name, str) or not name:
            raise UsageError("an engine needs a name")
        self.name = name
        self.function = function
        self._takes_history = takes_history
        self.__doc__ = function.__doc__

    def __call__(self, seen: Union[Transmission, History]) -> np.ndarray:
        return self.function(seen)

    def checked(self, native: _native.Transmission) -> np.ndarray:
        """Calls the function and returns the energies of a transmission as float64, with the shape ``energy_shape``.

        All values must be finite. Energies must not be negative; products may be negative.
        """
        transmission = Transmission(native)
        returned = self.function(transmission.history() if self._takes_history else transmission)
        energy, hidden = values_and_mask(returned)
        if energy.shape != transmission.energy_shape:
            axes = "(beams, samples)" if len(transmission.energy_shape) == 2 else "(channels, beams, samples)"
            raise ValueError(f"engine '{self.name}' returned an array of shape {energy.shape}, expected "
                             f"{axes} = {transmission.energy_shape}")
        try:
            energy = energy.astype(np.float64, casting="safe", copy=False)
        except TypeError:
            raise ValueError(f"engine '{self.name}' returned {energy.dtype}, expected float64") from None
        if hidden.any():
            raise ValueError(f"engine '{self.name}' returned a masked value{_at(hidden, transmission)}: expected energies "
                             "without a mask; replace masked values, by 0 without an echo")
        wrong = ~np.isfinite(energy)
        of_energies = ... if energy.ndim == 2 else slice(2)  # Products of signals may be negative.
        wrong[of_energies] |= energy[of_energies] < 0
        if wrong.any():
            raise ValueError(f"engine '{self.name}' returned energies that are negative or not finite: "
                             f"{energy[first_of(wrong)]}{_at(wrong, transmission)}")
        return np.ascontiguousarray(energy)

    def __repr__(self) -> str:
        return f"<tubefoot.Engine {self.name!r}>"


def _at(chosen: np.ndarray, transmission: Transmission) -> str:
    *channel, beam, sample = first_of(chosen)
    of_channel = f" of channel {channel[0]}" if channel else ""
    return (f" in beam {beam} and sample {sample}{of_channel} of transmission {transmission.transmission} of ping {transmission.ping} of sensor "
            f"{transmission.sensor!r}")


def engine(name: str) -> Callable[[Callable[[Transmission], np.ndarray]], Engine]:
    """Marks a function as an engine: ``@tubefoot.engine("mine")``.

    The function receives a :class:`Transmission`, which contains facets, tubes and pose as arrays. The function returns the
    energies of the transmission's beams: (beams, samples) float64 in J/m², for a source of 1 J/sr at 1 m. With two
    receivers the shape is (4, beams, samples), see :attr:`Transmission.energy_shape`. tubefoot calls the function once per
    transmission, in no fixed order.
    """
    return lambda function: Engine(name, function, False)


def sensor(name: str) -> Callable[[Callable[[History], np.ndarray]], Engine]:
    """Marks a function as a sensor: ``@tubefoot.sensor("mine")``.

    The function receives the :class:`History` of a transmission, which contains the visible footprints of the exact engine
    as arrays. The function returns energies as the function of an :func:`engine` does. The function decides how footprints
    contribute to range bins.
    """
    return lambda function: Engine(name, function, True)


def own_engine(engine: Union[str, Engine, None]) -> Optional[Engine]:
    """Returns the engine if it is a function, and None if it is built in."""
    if engine is None or isinstance(engine, str):
        return None
    if isinstance(engine, Engine):
        return engine
    raise UsageError(f"expected an engine name or a function with the decorator tubefoot.engine, not {type(engine).__name__}")
