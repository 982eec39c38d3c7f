# SPDX-License-Identifier: GPL-3.0-or-later
"""Derivatives of weighted sums of energies (docs/gradients.md)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _native
from ._arrays import finite
from ._errors import UsageError, warn
from ._words import meant, one_of

if TYPE_CHECKING:
    from ._result import Progress
    from ._scene import Scene

Array = npt.NDArray[np.float64]
AXES = {"position": ("east", "north", "up"), "rotation": ("x", "y", "z"), "mounting": ("yaw", "tilt", "roll"), "patterns": ("x", "y", "z")}


@dataclass(frozen=True)
class SonarGradient:
    """Derivatives by the pose of one sonar, per ping."""

    position: Array  #: (P, 3) per metre of east, north, up
    rotation: Array  #: (P, 3) per radian about the sonar's own axes: x starboard, y forward, z up
    mounting: Optional[Array]  #: (P, 3) per radian of yaw, tilt and roll; None for a sonar with ``look_at_m``
    patterns: Array  #: (P, 3) per radian of a rotation of the beam patterns alone about the sonar's own axes


@dataclass(frozen=True)
class ComponentGradient:
    """Derivatives by the vertices of a terrain or an object, and by the pose of an object."""

    vertices_m: Array  #: (n, 3) vertices on the grid of the scene: east, north, up
    facets: npt.NDArray[np.uint32]  #: (m, 3) indices of vertices
    by_vertex: Array  #: (n, 3) per metre. A vertex that belongs to several components appears in each of them
    position: Optional[Array]  #: (3,) per metre; None for a terrain, and for an object that cannot move alone
    rotation: Optional[Array]  #: (3,) per radian about the object's own axes through its origin; None as ``position``


@dataclass(frozen=True)
class Gradient:
    """Derivatives of the sum of weight times energy. ``gradient[name]`` is the derivative by a parameter of a run's
    ``gradient``, for all pings together."""

    sonars: dict[str, SonarGradient]
    components: dict[str, ComponentGradient]  #: terrains, then objects
    mu: dict[str, float]  #: by Lambert's parameter 10 ** (lambert_db / 10) of each material that has this law
    scattering: dict[str, float]  #: by the parameters of other scattering models, by name: ``material.NAME.KEY``
    sound_speed: float  #: per m/s, for range bins that are intervals of time, at fixed beam patterns
    absorption: float  #: one-way absorption, per dB/km
    profile: dict[str, float] = field(default_factory=dict)  #: by further parameters of the sound-speed profile, by name

    def __getitem__(self, name: str) -> float:
        all_ = self._named()
        if name not in all_:
            raise UsageError(f"there is no parameter {name!r}{meant(name, all_)}")
        return all_[name]

    def _named(self) -> dict[str, float]:
        named = {"water.sound_speed": self.sound_speed, "water.absorption": self.absorption}
        named |= {f"material.{name}.mu": value for name, value in self.mu.items()} | self.scattering | self.profile
        for name, parts in (*self.components.items(), *self.sonars.items()):
            for kind, axes in AXES.items():
                values = getattr(parts, kind, None)
                if values is not None:
                    total = values if values.ndim == 1 else values.sum(axis=0)
                    named |= {f"{name}.{kind}.{axis}": float(value) for axis, value in zip(axes, total)}
        return named


def gradient_of(scene: Scene, weights: Union[npt.ArrayLike, Mapping[str, npt.ArrayLike]], threads: Optional[int],
                progress: Optional[Progress]) -> Gradient:
    """Computes the gradient of a weighted sum of energies. See :meth:`Scene.gradient`."""
    sensors = scene.sensors
    if not isinstance(weights, Mapping):
        if len(sensors) != 1:
            raise UsageError(f"weights: the scene has {len(sensors)} sensors: give a dict with arrays by sensor, "
                             f"{one_of(sensors)}")
        weights = {sensors[0]: weights}
    for name in weights:
        if name not in sensors:
            raise UsageError(f"weights: there is no sensor {name!r}: expected {one_of(sensors)}")
    if not weights:
        raise UsageError(f"weights: the dict is empty: give an array for one of the sensors {one_of(sensors)}")
    given = {name: finite(values, f"weights of sensor {name!r}") for name, values in weights.items()}
    for name, values in given.items():
        if values.ndim != 3 or len(values) != scene.pings(name):
            raise UsageError(f"weights of sensor {name!r}: expected an array of shape (pings, beams, range bins) with "
                             f"{scene.pings(name)} pings, not {values.shape}")
    with scene._explained():
        native = _native.gradient(scene._native, [given.get(name) for name in sensors], threads, progress)
    if not (any(native["mu"]) or native["absorption"] or native["by_vertex"].any()) and any(values.any() for values in given.values()):
        warn("gradient: all derivatives are 0, because no range bin with a weight receives energy", True)
    return _from_native(scene, native)


def _from_native(scene: Scene, native: dict[str, Any]) -> Gradient:
    components = {}
    terrains = len(scene.components) - len(native["objects"])
    for number, name in enumerate(scene.components):
        facets = native["facets"][native["component"] == number]
        vertices, renumbered = np.unique(facets, return_inverse=True)
        position = rotation = None
        if number >= terrains and native["objects"][number - terrains][2]:
            position, rotation = (values[0] for values in native["objects"][number - terrains][:2])
        components[name] = ComponentGradient(native["vertices_m"][vertices], renumbered.reshape(-1, 3).astype(np.uint32),
                                             native["by_vertex"][vertices], position, rotation)
    known = {name for name, _, _ in _native.gradient_parameters(scene._native)}
    sonars = {name: SonarGradient(position, rotation, mounting if f"{name}.mounting.yaw" in known else None, patterns)
              for name, (position, rotation, mounting, patterns) in zip(scene.sensors, native["sonars"])}
    mu = {name: float(value) for name, value in zip(scene.materials, native["mu"]) if f"material.{name}.mu" in known}
    return Gradient(sonars, components, mu, native["scattering"], float(native["sound_speed"]), float(native["absorption"]),
                    native["profile"])
