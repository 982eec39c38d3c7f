# SPDX-License-Identifier: GPL-3.0-or-later
"""tubefoot: an exact sonar simulator that computes footprints instead of sampling them with rays.

>>> import tubefoot
>>> result = tubefoot.run("scenes/wellhead/scene.toml")
>>> result["camera"].energy  # (pings, beams, samples) in J/m²
>>> result["camera"].picture(0)  # the same picture as that of the program; notebooks display it

docs/python.md is a tutorial. Lengths are in metres and times in seconds. Energies are in J/m² for a source of 1 J/sr at
1 m. The names of quantities in other units contain the unit.
"""

from typing import Any

from . import _native
from ._coverage import Coverage, coverage
from ._engines import Engine, engine, sensor
from ._errors import InputError, SceneWarning, SilenceWarning, UsageError
from ._fit import EnergyFit
from ._footprints import Footprints, footprints
from ._gradient import ComponentGradient, Gradient, SonarGradient
from ._history import History, Transmission, history, transmission
from ._picture import Picture
from ._result import Result, SensorResult, open, reference, run
from ._scene import Scene, load
from ._signals import Signals, Waveform, point_signals, signals, window_weights
from ._study import advise, chart, compare
from ._words import former

__version__: str = _native.version

__all__ = [
    "ComponentGradient", "Coverage", "EnergyFit", "Engine", "Footprints", "Gradient", "History", "InputError", "Picture",
    "Result", "Scene", "SceneWarning", "SensorResult", "SonarGradient", "Transmission", "Signals", "SilenceWarning",
    "UsageError", "Waveform", "advise", "chart", "compare", "coverage", "engine", "footprints", "history", "load", "open",
    "point_signals", "reference", "run", "sensor", "transmission", "signals", "window_weights",
]


def __getattr__(name: str) -> Any:
    renamed = {"Shot": "Transmission", "shot": "transmission"}
    if name not in renamed:
        raise AttributeError(f"module 'tubefoot' has no attribute {name!r}")
    former(name, renamed[name])
    return globals()[renamed[name]]
