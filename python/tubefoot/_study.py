# SPDX-License-Identifier: GPL-3.0-or-later
"""How far engines are from the truth, and at what cost."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from typing import Any, Optional, Union

from . import _native
from ._engines import Engine, own_engine
from ._errors import UsageError, whole
from ._result import PathLike, Progress, Result
from ._scene import Scene, a_scene

Echoes = Union[Result, PathLike]


def compare(reference: Echoes, candidate: Echoes, *, sensor: Optional[str] = None, worst: int = 5,
            any_scene: bool = False) -> dict[str, Any]:
    """How far a candidate's energies are from a reference's: the figures of ``tubefoot compare --json``.

    Args:
        reference: what is taken for true: a result, or an echo file (docs/echo-file.md).
        candidate: the same pings, beams and samples from another engine.
        sensor: only this one.
        worst: number of worst bins to list.
        any_scene: compare although the scenes' hashes differ.

    Returns:
        ``notes`` and, for each of ``sensors``, ``l1_error`` (relative), ``rms_db_error`` (dB), ``energy_ratio``,
        ``first_return``, ``within_bound``, ``worst_bins`` and more (docs/compare.md). Figures that are not finite are
        None.

    Raises:
        InputError: a file is wrong, or the two sides do not go together.
    """
    if whole("worst", worst) < 0:
        raise UsageError(f"worst: {worst} is no number of bins")
    return json.loads(_native.compare(_native_echoes(reference), _native_echoes(candidate), sensor, worst, any_scene))


def _native_echoes(echoes: Echoes) -> Union[_native.Result, str]:
    return echoes._native if isinstance(echoes, Result) else os.fspath(echoes)


def chart(scenes: Union[Scene, Sequence[Scene]],
          engines: Union[str, Engine, Sequence[Union[str, Engine]]] = ("tube", "ray"), *,
          output: Optional[PathLike] = None, pings: int = 1, repeats: int = 3, seconds: float = 4,
          progress: Optional[Progress] = None) -> list[dict[str, Any]]:
    """Runs engines on scenes and holds their errors against the time they take, as ``tubefoot chart`` does.

    Args:
        scenes: a scene or several; of each, the first pings of the first sensor, on one thread.
        engines: one or several: ``"tube"`` and ``"ray"``, each in all its settings, and functions marked by
            :func:`engine` or :func:`sensor`.
        output: folder for the page, the table and the diagrams: whole or not at all.
        pings: pings of each scene.
        repeats: runs of each setting; the median of their seconds counts.
        seconds: leave out rays that would take longer than this for one run.
        progress: called now and then with the settings finished and all settings; what it raises ends the work.

    Returns:
        One dict a trial: ``scene``, ``engine``, ``setting``, ``l1_error`` (relative), ``rms_db_error`` (dB),
        ``seconds`` (a ping), ``bound`` (of the reference, relative) and ``rays`` (a ping).
    """
    scenes = [scenes] if isinstance(scenes, Scene) else [a_scene(s) for s in scenes]
    builtin: list[str] = []
    own: list[tuple[str, Any]] = []
    for engine in [engines] if isinstance(engines, (str, Engine)) else engines:
        mine = own_engine(engine)
        if mine is not None:
            own.append((mine.name, mine.checked))
        elif engine in ("tube", "ray"):
            builtin.append(str(engine))
        else:
            raise UsageError(f"engines: {engine} not in {{tube,ray}}")
    names = builtin + [name for name, _ in own]
    if not scenes or not names:
        raise UsageError("a chart needs a scene and an engine")
    if len(set(names)) < len(names):
        raise UsageError(f"two engines have one name: {', '.join(names)}")
    pings, repeats = whole("pings", pings), whole("repeats", repeats)
    if pings < 1 or repeats < 1 or not seconds > 0:
        raise UsageError("pings and repeats are 1 or more, seconds above 0")
    folder = "" if output is None else os.fspath(output)
    asked = dict(scenes=[s._native for s in scenes], builtin=builtin, own=own, output=folder, pings=pings,
                 repeats=repeats, seconds=float(seconds))
    return _native.chart(asked, progress)
