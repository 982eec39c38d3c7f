# SPDX-License-Identifier: GPL-3.0-or-later
"""Residuals and derivatives of energies for the optimisers of SciPy (docs/gradients.md)."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _native
from ._arrays import finite
from ._errors import UsageError
from ._gradient import AXES, Array, gradient_of
from ._result import run
from ._scene import PathLike, Scene
from ._words import meant, one_of, with_named_arguments


class EnergyFit:
    """Residuals and derivatives of the energies of a scene as functions of some parameters, for SciPy.

    >>> fit = tubefoot.EnergyFit(keys, ["camera.mounting.tilt", "water.absorption"], measured)
    >>> scipy.optimize.least_squares(fit.residuals, fit.initial, fit.jacobian, x_scale="jac")
    >>> scipy.optimize.minimize(fit.half_squares, fit.initial, jac=True)

    The values ``x`` of the parameters are absolute, in metres, radians, m/s and dB/km; mu has no unit, and a key of a
    scattering model (``material.NAME.KEY``) has the unit of the key. A change of
    ``water.sound_speed`` also changes the keys ``range_min_m`` and ``range_max_m`` of all sensors in proportion, because
    range bins are intervals of time.

    Args:
        keys: the scene as for :meth:`Scene.from_dict`. It must contain a number for each parameter, except for mounting
            angles and positions, which are 0 by default.
        parameters: names as for the argument ``gradient`` of :func:`run`. Rotations have no key of their own: use
            mounting angles, or ``update``.
        measured: energies to fit, as an array of shape (pings, beams, range bins), or such arrays by sensor.
        sigma: standard deviation of the measured energies, a number or arrays like ``measured``. Residuals are
            divided by it.
        update: function that returns the keys of the scene for the values; by default, the values replace keys. A change
            of a value must change the scene as the parameter of this name does, in its unit. For
            ``OBJECT.rotation.z``, ``heading_deg`` does so only without pitch and roll, and in the opposite sense.
        initial: first values of the parameters; by default those of the keys. Required with ``update``.
        base: folder to which file names are relative.
        threads: number of threads.
    """

    @with_named_arguments
    def __init__(self, keys: Mapping[str, Any], parameters: Sequence[str],
                 measured: Union[npt.ArrayLike, Mapping[str, npt.ArrayLike]],
                 sigma: Union[float, npt.ArrayLike, Mapping[str, npt.ArrayLike]] = 1.0, *,
                 update: Optional[Callable[[Array], Mapping[str, Any]]] = None,
                 initial: Optional[npt.ArrayLike] = None, base: PathLike = ".",
                 threads: Optional[int] = None) -> None:
        self._keys, self._base, self._threads = keys, base, threads
        self.parameters = list(parameters)
        if not self.parameters:
            raise UsageError("parameters: the list is empty: name at least one parameter")
        self._update = update
        scene = Scene.from_dict(keys, base)
        known = [name for name, _, _ in _native.gradient_parameters(scene._native)]
        for name in self.parameters:
            if name not in known:
                raise UsageError(f"parameters: there is no parameter {name!r}{meant(name, known)}")
        if update is None:
            self._reject_changes_of_times(scene)
            self._places = [_place(keys, name) for name in self.parameters]
        elif initial is None:
            raise UsageError("initial: 'update' needs first values of the parameters")
        self.initial = finite([place.value() for place in self._places] if initial is None else initial, "initial")
        if self.initial.shape != (len(self.parameters),):
            raise UsageError(f"initial: expected {len(self.parameters)} numbers, not an array of shape {self.initial.shape}")
        measured = measured if isinstance(measured, Mapping) else {scene.sensors[0]: measured}
        self.measured = {name: finite(values, f"measured energies of {name!r}") for name, values in measured.items()}
        self._sigma: dict[str, Array] = {}
        for name, values in self.measured.items():
            of = finite(sigma.get(name, 1.0) if isinstance(sigma, Mapping) else sigma, f"sigma of {name!r}")
            if not (of > 0).all() or of.shape not in ((), values.shape):
                raise UsageError(f"sigma of {name!r}: expected numbers above 0 of shape {values.shape}")
            self._sigma[name] = of
        self._known: tuple[bytes, bool, Any, Any] = (b"", False, None, None)

    def _reject_changes_of_times(self, scene: Scene) -> None:
        """In stratified water, a change of the sound speed at the sonar changes the times of range bins."""
        water = self._keys.get("water", {})
        if (water.get("profile", "constant") if isinstance(water, Mapping) else "constant") == "constant":
            return
        for name in self.parameters:
            if name.startswith("water.") and name != "water.absorption" or name in [f"{s}.position.up" for s in scene.sensors]:
                raise UsageError(f"parameters: with this sound-speed profile, {name} can change the sound speed at the sonar, "
                                 "so that the ranges must change too: give 'update'")

    def scene(self, x: npt.ArrayLike) -> Scene:
        """Returns the scene for the values of the parameters."""
        values = self._values(x)
        if self._update is not None:
            return Scene.from_dict(self._update(values), self._base)
        keys = {section: _plain(value) for section, value in self._keys.items()}
        for place, value in zip(self._places, values):
            place.on(keys).set(float(value))
        return Scene.from_dict(keys, self._base)

    def residuals(self, x: npt.ArrayLike) -> Array:
        """Returns (energy - measured) / sigma of all sensors as one vector."""
        result = self._result(x, False)
        return np.concatenate([((self._energy(result, name) - values) / self._sigma[name]).ravel()
                               for name, values in self.measured.items()])

    def jacobian(self, x: npt.ArrayLike) -> Array:
        """Returns the derivatives of the residuals, of shape (residuals, parameters)."""
        result = self._result(x, True)
        return np.stack([np.concatenate([(result[name].gradient[parameter] / self._sigma[name]).ravel()
                                         for name in self.measured]) for parameter in self.parameters], axis=1)

    def half_squares(self, x: npt.ArrayLike) -> tuple[float, Array]:
        """Returns half of the sum of squared residuals and its gradient, which is computed in reverse mode."""
        result = self._result(x, False)
        errors = {name: (self._energy(result, name) - values) / self._sigma[name] for name, values in self.measured.items()}
        weights = {name: e / self._sigma[name] for name, e in errors.items()}
        gradient = gradient_of(self._known[3], weights, self._threads, None)
        return (0.5 * sum(float((e * e).sum()) for e in errors.values()),
                np.array([gradient[name] for name in self.parameters]))

    def _values(self, x: npt.ArrayLike) -> Array:
        values = finite(x, "x")
        if values.shape != self.initial.shape:
            raise UsageError(f"x: expected {len(self.parameters)} numbers, not an array of shape {values.shape}")
        return values

    def _energy(self, result: Any, name: str) -> Array:
        energy = result[name].energy
        if energy.shape != self.measured[name].shape:
            raise UsageError(f"measured energies of {name!r}: the array has the shape {self.measured[name].shape}, expected "
                             f"{energy.shape} (pings, beams, range bins)")
        return energy

    def _result(self, x: npt.ArrayLike, with_gradient: bool) -> Any:
        values = self._values(x)
        if self._known[0] == values.tobytes() and self._known[1] >= with_gradient:
            return self._known[2]
        scene = self.scene(values)
        result = run(scene, gradient=self.parameters if with_gradient else None, threads=self._threads)
        for name in self.measured:
            if name not in result:
                raise UsageError(f"measured: there is no sensor {name!r}: expected {one_of(result)}")
        self._known = (values.tobytes(), with_gradient, result, scene)
        return result


def _plain(value: Any) -> Any:
    """Returns tables and lists of tables as changeable objects; arrays remain the same."""
    if isinstance(value, Mapping):
        return dict(value)
    if isinstance(value, (list, tuple)):
        return [dict(v) if isinstance(v, Mapping) else v for v in value]
    return value


def _from_key(key: str, value: float) -> float:
    """Returns the value of a parameter: radians, and Lambert's parameter mu."""
    return math.radians(value) if key.endswith("_deg") else 10 ** (value / 10) if key == "lambert_db" else value


def _to_key(key: str, value: float) -> float:
    if key == "lambert_db" and not value > 0:
        raise UsageError(f"x: mu of a material is {value:g}, expected a number above 0")
    return math.degrees(value) if key.endswith("_deg") else 10 * math.log10(value) if key == "lambert_db" else value


class _Place:
    """A number in the keys of a scene. ``is_key``: the parameter is the key itself, in its unit."""

    def __init__(self, keys: Mapping[str, Any], section: str, index: Optional[int], key: str, component: Optional[int] = None,
                 default: Optional[float] = None, is_key: bool = False) -> None:
        self._keys, self._path, self._is_key = keys, (section, index, key, component, default), is_key

    def on(self, keys: Mapping[str, Any]) -> _Place:
        return _Place(keys, *self._path, self._is_key)

    def _table(self) -> Any:
        section, index = self._path[:2]
        entry = self._keys.get(section, {}) if isinstance(self._keys, dict) else self._keys[section]
        return entry if index is None or isinstance(entry, Mapping) else entry[index]

    def value(self) -> float:
        section, _, key, component, default = self._path
        value = self._table().get(key, default if component is None else [default] * 3)
        value = value if component is None else value[component]
        if value is None:
            raise UsageError(f"parameters: the scene has no {section}.{key}: add this key, or use 'update'")
        return float(value) if self._is_key else _from_key(key, float(value))

    def set(self, value: float) -> None:
        _, _, key, component, _ = self._path
        if key == "sound_speed_m_s":
            self._scale_ranges(value / self.value())
        value = value if self._is_key else _to_key(key, value)
        table = self._table()
        if component is None:
            table[key] = value
        else:
            table[key] = [float(v) for v in table.get(key, (0, 0, 0))]
            table[key][component] = value

    def _scale_ranges(self, factor: float) -> None:
        sensors = self._keys["sensors"]
        for sensor in [sensors] if isinstance(sensors, Mapping) else sensors:
            for key in ("range_min_m", "range_max_m"):
                if key in sensor:
                    sensor[key] = float(sensor[key]) * factor
                else:
                    raise UsageError(f"parameters: water.sound_speed needs the key {key!r} of each sensor: add it, or give "
                                     "'update'")


def _place(keys: Mapping[str, Any], name: str) -> _Place:
    """Returns the key of a parameter. Raises UsageError for a parameter without a key."""
    def index(section: str, owner: str) -> int:
        entries = keys.get(section, [])
        names = [entry.get("name") for entry in ([entries] if isinstance(entries, Mapping) else entries)]
        return names.index(owner) if owner in names else -1

    def entry(section: str, number: int) -> Mapping[str, Any]:
        entries = keys[section]
        return entries if isinstance(entries, Mapping) else entries[number]

    if name == "water.sound_speed":
        return _Place(keys, "water", None, "sound_speed_m_s")
    if name == "water.absorption":
        return _Place(keys, "water", None, "absorption_db_per_km")
    if of_material := re.fullmatch(r"material\.(.+?)\.([a-z_]+)(?:\.(\d+))?", name):
        material, key, number_in_table = of_material.groups()
        if key == "mu":
            return _Place(keys, "materials", index("materials", material), "lambert_db")
        return _Place(keys, "materials", index("materials", material), key, int(number_in_table) if number_in_table else None,
                      default=2.0 if key == "oblique_exponent" else None, is_key=True)
    owner, kind, axis = name.rsplit(".", 2)
    sensor, object_ = index("sensors", owner), index("objects", owner)
    if kind == "mounting" and sensor >= 0:
        return _Place(keys, "sensors", sensor, axis + "_deg", default=0.0)
    number = AXES[kind].index(axis)
    if kind == "position" and object_ >= 0 and not {"on_terrain_m", "position_lat_lon_deg"} & set(entry("objects", object_)):
        return _Place(keys, "objects", object_, "position_m", number, default=0.0)
    trajectory, sensors = keys.get("trajectory"), keys.get("sensors")
    if kind == "position" and sensor >= 0 and "look_at_m" not in entry("sensors", sensor) and isinstance(trajectory, Mapping) and trajectory.get("kind") == "fixed" \
            and (isinstance(sensors, Mapping) or len(sensors) == 1):  # type: ignore[arg-type]
        return _Place(keys, "trajectory", None, "position_m", number, default=0.0)
    raise UsageError(f"parameters: {name!r} is no key of the scene: give 'update', which returns the keys for the values. "
                     "Mounting angles, positions of objects without 'on_terrain_m', the position of a single sensor "
                     "without 'look_at_m' on a fixed trajectory, materials and water need no 'update'")
