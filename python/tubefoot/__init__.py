# SPDX-License-Identifier: GPL-3.0-or-later
"""tubefoot: a sonar simulator that measures footprints instead of sampling them.

>>> import tubefoot
>>> scene = tubefoot.load("scenes/wellhead/scene.toml")
>>> result = tubefoot.run(scene)
>>> result["camera"].energy  # (pings, beams, samples) in J

docs/python.md is a tutorial. Lengths are metres, times seconds, energies joules for a source of 1 J/sr at 1 m; other
units are in the names.
"""

from . import _native
from ._engines import Engine, engine, sensor
from ._errors import InputError, SceneWarning, UsageError
from ._footprints import Footprints, footprints
from ._history import History, Shot, history, shot
from ._result import Result, SensorResult, reference, run
from ._scene import Scene, load
from ._study import chart, compare

__version__: str = _native.version

__all__ = [
    "Engine", "Footprints", "History", "InputError", "Result", "Scene", "SceneWarning", "SensorResult", "Shot",
    "UsageError", "chart", "compare", "engine", "footprints", "history", "load", "reference", "run", "sensor", "shot",
]
