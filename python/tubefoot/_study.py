# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of engines relative to a reference, and the costs of the engines."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Sequence
from typing import Any, Optional, Union

from . import _native
from ._engines import Engine, own_engine
from ._errors import UsageError, whole
from ._result import Progress, Result
from ._scene import PathLike, Scene, a_scene
from ._words import in_python, meant, one_of, with_named_arguments

Echoes = Union[Result, PathLike]


@with_named_arguments
def compare(reference: Echoes, candidate: Echoes, *, sensor: Optional[str] = None, worst: int = 5,
            any_scene: bool = False) -> dict[str, Any]:
    """Compares a candidate's energies with a reference's, and returns the figures of ``tubefoot compare --json``.

    Args:
        reference: the reference: a result, an echo file (docs/output-files.md) or a folder that a run wrote.
        candidate: the same pings, beams and samples from another engine.
        sensor: name of the only sensor to compare.
        worst: number of worst bins to list.
        any_scene: compares even if the scenes' hashes differ.

    Returns:
        ``notes``, and for each entry of ``sensors``: ``l1_error`` (relative), ``rms_db_error`` (dB), ``energy_ratio``,
        ``first_return``, ``within_bound``, ``worst_bins`` and more (docs/engine-validation.md). Figures that are not finite are
        None.

    Raises:
        InputError: a file is invalid, or the reference and the candidate do not match.
    """
    if whole("worst", worst) < 0:
        raise UsageError(f"worst: expected a number of bins of 0 or more, not {worst}")
    return json.loads(_native.compare(_native_echoes(reference), _native_echoes(candidate), sensor, worst, any_scene))


def _native_echoes(echoes: Echoes) -> Union[_native.Result, str]:
    if isinstance(echoes, Result):
        return echoes._native
    file = os.fspath(echoes)
    return os.path.join(file, "echoes.nc") if os.path.isdir(file) else file


@with_named_arguments
def advise(scene: Union[Scene, PathLike], tolerance: Union[float, str], *, pings: Union[int, str, None] = None,
           trial_pings: int = 8, threads: Optional[int] = None) -> dict[str, Any]:
    """Finds the fastest engine and settings within a tolerance by measurements on a few pings.

    The figures are those of ``tubefoot advise --json`` (docs/accuracy-and-speed.md).

    Args:
        scene: the scene, or the name of its file.
        tolerance: permitted error, relative (``1e-3``; 1e-6 to 0.1), ``"20%"`` or ``"0.1dB"``.
        pings: ``"A:B"`` selects the trial pings from these pings of each sensor, both included, counted from 0. An
            integer is the former meaning, a number of trial pings, and gives a DeprecationWarning.
        trial_pings: number of pings per sensor for the prediction, and of others for the measurement; at least 2.
        threads: threads for loading the scene. tubefoot always measures settings on one thread.

    Returns:
        ``sensors``, ``candidates`` and ``cheapest``. The first candidate is exact. ``cheapest`` is the cheapest candidate
        within the tolerance. Each candidate has ``predicted`` and ``measured`` errors (relative, or in dB, see
        ``measure``) and seconds per ping. It also states its neglected effects, and ``holds`` is true if it satisfies the
        tolerance. ``options`` are the arguments of :func:`run` for these settings:
        ``tubefoot.run(scene, **advice["cheapest"]["options"])``.

    The measurements run on one thread. Ctrl-C stops the measurements.

    Raises:
        InputError: the scene is invalid.
        UsageError: the tolerance is invalid.
    """
    if pings is not None and not isinstance(pings, str):
        trial_pings, pings = whole("pings", pings), None
        warnings.warn("an integer for 'pings' of advise() is now 'trial_pings'", DeprecationWarning, stacklevel=3)
    if whole("trial_pings", trial_pings) < 2:
        raise UsageError(f"trial_pings: expected 2 or more, not {trial_pings}")
    if threads is not None and not 1 <= whole("threads", threads) <= 4096:
        raise UsageError(f"threads: expected 1 to 4096, not {threads}")
    text = tolerance if isinstance(tolerance, str) else repr(float(tolerance))
    known = a_scene(scene)
    with known._explained():
        advice = json.loads(_native.advise(known._native, text, ":" if pings is None else pings, trial_pings, threads))
    for candidate in [*advice["candidates"], advice["cheapest"]]:
        words = candidate["options"].split()
        candidate["options"] = {in_python(option): int(value) if value.isdigit() else value
                                for option, value in zip(words[::2], words[1::2])}
    return advice


@with_named_arguments
def chart(scenes: Union[Scene, PathLike, Sequence[Union[Scene, PathLike]]],
          engines: Union[str, Engine, Sequence[Union[str, Engine]]] = ("tube", "ray"), *,
          output: Optional[PathLike] = None, pings: Union[int, str] = "0", repeats: int = 3, seconds: float = 4,
          progress: Optional[Progress] = None) -> list[dict[str, Any]]:
    """Runs engines on scenes and compares their errors with their times, as ``tubefoot chart`` does.

    Args:
        scenes: a scene or several, or the names of their files. The chart uses the first sensor of each, on one thread.
        engines: one or several: ``"tube"`` and ``"ray"``, each in all its settings, and functions marked by
            :func:`engine` or :func:`sensor`.
        output: folder for the page, the table and the diagrams. The files appear only when complete.
        pings: ``"A:B"``, pings of each scene, both included, counted from 0. An integer is the former meaning, a number
            of first pings, and gives a DeprecationWarning.
        repeats: number of runs of each setting. The chart uses the median of their times.
        seconds: excludes numbers of rays for which one run would take longer than this time, in s.
        progress: function that is called occasionally with the number of finished settings and of all settings. An
            exception from this function stops the chart.

    Returns:
        One dict per trial: ``scene``, ``engine``, ``setting``, ``l1_error`` (relative), ``rms_db_error`` (dB), ``seconds``
        (per ping), ``processor_seconds`` (the part of these in which the thread was running), ``instructions`` (None if
        the machine does not count them), ``bound`` (of the reference, relative) and ``rays`` (per ping).
    """
    several = [scenes] if isinstance(scenes, (Scene, str, os.PathLike)) else scenes
    known = [a_scene(s) for s in several]
    builtin: list[str] = []
    own: list[tuple[str, Any]] = []
    for engine in [engines] if isinstance(engines, (str, Engine)) else engines:
        mine = own_engine(engine)
        if mine is not None:
            own.append((mine.name, mine.checked))
        elif engine in ("tube", "ray"):
            builtin.append(str(engine))
        else:
            choices = ("tube", "ray")
            raise UsageError(f"engines: {engine!r} is not {one_of(choices)}{meant(engine, choices)}")
    names = builtin + [name for name, _ in own]
    if not known or not names:
        raise UsageError("a chart needs at least one scene and one engine")
    if len(set(names)) < len(names):
        raise UsageError(f"two engines have the same name: {', '.join(names)}")
    repeats = whole("repeats", repeats)
    first_pings = None
    if not isinstance(pings, str):
        count = whole("pings", pings)
        if count < 1:
            raise UsageError("pings: expected 1 or more")
        pings, first_pings = f"0:{count - 1}", count
        warnings.warn(f"an integer for 'pings' of chart() is deprecated: use {pings!r}", DeprecationWarning, stacklevel=3)
    if repeats < 1 or not seconds > 0:
        raise UsageError("repeats must be 1 or more, and seconds above 0")
    folder = "" if output is None else os.fspath(output)
    asked = dict(scenes=[s._native for s in known], builtin=builtin, own=own, output=folder, pings=pings, first_pings=first_pings,
                 repeats=repeats, seconds=float(seconds))
    return _native.chart(asked, progress)
