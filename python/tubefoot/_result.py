# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs, their results and their files."""

from __future__ import annotations

import json
import operator
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

from . import _native
from ._arrays import unmasked
from ._engines import Engine, own_engine
from ._errors import InputError, UsageError, warn, whole
from ._options import gradient_option, without_option
from ._picture import Picture, as_html, drawn, plural
from ._scene import PathLike, Scene, a_scene
from ._signals import Signals
from ._words import CHOICES, former, in_python, meant, one_of, with_named_arguments

if TYPE_CHECKING:
    import xarray

Progress = Callable[[int, int], Any]

# Dimensions, unit and meaning of variables of echoes.nc (docs/output-files.md). The native module knows all others.
_VARIABLES: dict[str, tuple[tuple[str, ...], str, str]] = {
    "energy": (("ping", "beam", "sample"), "J m-2",
               "received energy density per beam and range bin, for a source of 1 J/sr at 1 m"),
    "energy_bound": (("ping", "beam", "sample"), "J m-2",
                     "certified bound: the true energy lies within energy +- energy_bound"),
    "received": (("ping", "beam", "sample"), "J m-2",
                 "energy density per beam and range bin as the receiver records it, for a source of 1 J/sr at 1 m"),
    "received_lower": (("ping", "beam", "sample"), "J m-2",
                       "energy density per beam and range bin as the lower receiver records it; received is that of the upper "
                       "receiver"),
    "ping_time": (("ping",), "s", "time of the transmission on the clock of the scene"),
    "slant_range": (("sample",), "m", "slant range of the centre of the range bin"),
    "slant_range_bounds": (("sample", "bound"), "m",
                           "slant ranges at both ends of the range bin, which contains the nearer end"),
    "two_way_travel_time": (("sample",), "s", "two-way travel time of the centre of the range bin"),
    "beam_azimuth": (("beam",), "degree", "azimuth of the beam axis in the sensor frame, clockwise from "
                     "forward, starboard positive"),
    "beam_elevation": (("beam",), "degree", "elevation of the beam axis above the horizontal plane of the sensor"),
    "beam_azimuth_width": (("beam",), "degree", "full one-way width of the ideal rectangular beam in azimuth"),
    "beam_elevation_width": (("beam",), "degree", "full one-way width of the ideal rectangular beam in elevation"),
    "sensor_position": (("ping", "xyz"), "m", "position of the sensor in the local frame: east, north, up"),
    "sensor_attitude": (("ping", "wxyz"), "1", "quaternion w, x, y, z that rotates the sensor axes (x starboard, y "
                        "forward, z up) into the local frame"),
    "sensor_heading": (("ping",), "degree", "heading of the forward axis of the sensor, clockwise from north in the "
                       "local frame"),
    "sensor_pitch": (("ping",), "degree", "pitch of the sensor, forward axis up positive"),
    "sensor_roll": (("ping",), "degree", "roll of the sensor, starboard down positive"),
    # Only if the assumed configuration differs from the true one.
    "recorded_sensor_position": (("ping", "xyz"), "m",
                                 "position of the sensor that its software assumes, in the local frame: east, north, up"),
    "recorded_sensor_attitude": (("ping", "wxyz"), "1", "quaternion w, x, y, z of the attitude that the software of the "
                                 "sensor assumes, as in sensor_attitude"),
    "recorded_sensor_heading": (("ping",), "degree", "heading of the sensor that its software assumes, clockwise from "
                                "north in the local frame"),
    "recorded_sensor_pitch": (("ping",), "degree", "pitch of the sensor that its software assumes, forward axis up "
                              "positive"),
    "recorded_sensor_roll": (("ping",), "degree", "roll of the sensor that its software assumes, starboard down positive"),
    # Only in files of a part of a run.
    "ping_number": (("ping",), "1", "ping of the scene, counted from 0"),
    "beam_number": (("beam",), "1", "beam of the sonar, counted from 0"),
    # Only for a survey with lines.
    "line": (("ping",), "1", "line of the survey, counted from 1"),
    # Only for a scene with a place on Earth.
    "sensor_longitude": (("ping",), "degrees_east", "longitude of the sensor on WGS 84"),
    "sensor_latitude": (("ping",), "degrees_north", "latitude of the sensor on WGS 84"),
    "sensor_height": (("ping",), "m", "height of the sensor, up positive, as the scene's heights count"),
    "sensor_true_heading": (("ping",), "degree", "heading of the sensor's forward axis, clockwise from true north"),
}
_COORDINATES = ("ping_time", "slant_range", "slant_range_bounds", "two_way_travel_time", "beam_azimuth",
                "beam_elevation", "beam_azimuth_width", "beam_elevation_width", "ping_number", "beam_number")


class SensorResult:
    """The echoes of one sensor, as read-only arrays that share the run's memory.

    ``P`` is the number of pings, ``B`` of beams and ``K`` of range samples. Names and units are those of echoes.nc
    (docs/output-files.md). Values that are missing in an opened file are NaN.

    ``echoes[2:5]``, ``echoes[-1]`` and ``echoes[[0, 7]]`` select pings by the indexing rules of NumPy. A selection is
    another SensorResult with pings numbered from 0. One ping is a result with ``P = 1``, too.
    """

    def __init__(self, native: _native.Result, index: int) -> None:
        self._native = native
        self._index = index
        self._pings: Optional[np.ndarray] = None  # indices of a selection of pings in the whole result
        self._labels: Optional[dict[str, Any]] = None  # set at the first access
        self._signals: Optional[Signals] = None  # set at the first access
        self._values: dict[str, np.ndarray] = {**native.arrays(index), **native.axes(index)}
        self._altitude: Optional[np.ndarray] = self._values.pop("altitude", None)
        self._attributes: dict[str, Any] = native.attributes(index)
        self._variables = {**_VARIABLES, **native.dimensions(index)}

    def _value(self, name: str, *more: int) -> np.ndarray:
        return self._values[name] if name in self._values else self._unknown(name, *more)

    def _unknown(self, name: str, *more: int) -> np.ndarray:
        lengths = dict(zip(("ping", "beam", "sample"), self.energy.shape))
        values = np.full((lengths[_VARIABLES[name][0][0]], *more), np.nan)
        values.flags.writeable = False
        return values

    def __len__(self) -> int:
        """Number of pings, P."""
        return len(self.energy)

    def __iter__(self) -> Iterator[SensorResult]:
        return (self[ping] for ping in range(len(self)))

    def __getitem__(self, pings: Union[int, slice, Sequence[int], np.ndarray]) -> SensorResult:
        chosen = self._chosen(pings)
        part = object.__new__(SensorResult)
        part.__dict__.update(self.__dict__)
        part._pings = (np.arange(len(self)) if self._pings is None else self._pings)[chosen]
        part._labels = None
        part._values = {name: values[chosen] if self._variables[name][0][0] == "ping" else values
                        for name, values in self._values.items()}
        part._altitude = None if self._altitude is None else self._altitude[chosen]
        for values in part._values.values():
            values.flags.writeable = False
        return part

    def _chosen(self, pings: Union[int, slice, Sequence[int], np.ndarray]) -> Union[slice, np.ndarray]:
        if isinstance(pings, slice):
            return pings
        if isinstance(pings, (list, tuple, range, np.ndarray)) and np.ndim(pings) == 1:
            numbers = unmasked(pings, "pings") if len(pings) else np.zeros(0, np.int64)
            if numbers.dtype != bool and not np.issubdtype(numbers.dtype, np.integer):
                raise TypeError(f"expected integers as ping numbers, not {numbers.dtype}")
            if numbers.dtype == bool and len(numbers) != len(self):
                raise IndexError(f"there are {len(numbers)} booleans for {plural(len(self), 'ping')}")
            for ping in () if numbers.dtype == bool else numbers:
                self._number(int(ping))
            return numbers
        try:
            ping = self._number(operator.index(pings))  # type: ignore[arg-type]
        except TypeError:
            raise TypeError(f"expected a ping, a slice or ping numbers, not {type(pings).__name__}") from None
        return slice(ping, ping + 1)

    def _number(self, ping: int) -> int:
        if not -len(self) <= ping < len(self):
            has = f"pings 0 to {len(self) - 1}" if len(self) else "no ping"
            raise IndexError(f"ping {ping}: sensor {self.name!r} has {has}")
        return ping % len(self)

    @property
    def pings(self) -> np.ndarray:
        """(P,) int64: number of each ping in the run."""
        if "ping_number" in self._values:
            return self._values["ping_number"].astype(np.int64)
        return np.arange(len(self)) if self._pings is None else self._pings

    @with_named_arguments
    def picture(self, ping: Optional[int] = None) -> Picture:
        """Draws the echoes as the program does.

        For a forward-looking fan, the picture shows one ping, or several pings side by side. For beams to both sides, the
        picture is a waterfall. For beams downwards, the picture is the echogram of the steepest beam. The picture shows
        ideal echoes, not received ones.

        Args:
            ping: one ping of a forward-looking fan; by default all pings, at most 20 of a sequence.

        Raises:
            UsageError: the result has no ping, or the argument ``ping`` is given and the sensor has no picture of one ping.
            InputError: the samples of an opened file are not uniformly spaced.
        """
        if not len(self):
            raise UsageError(f"sensor {self.name!r} has no ping to draw")
        one = None if ping is None else self._number(whole("ping", ping))
        title = self.name if ping is None else f"{self.name}, ping {one}"
        return drawn(self._native, self._index, None if self._pings is None else self._pings.tolist(), one, title)

    def _repr_html_(self) -> str:
        try:
            picture: Optional[Picture] = self.picture()
        except (InputError, UsageError):
            picture = None
        pings, beams, samples = self.energy.shape
        near, far = self.slant_range_bounds[0, 0], self.slant_range_bounds[-1, 1]
        facts = (f"{self.kind}: {plural(pings, 'ping')}, {plural(beams, 'beam')}, {plural(samples, 'sample')} from "
                 f"{near:.4g} to {far:.4g} m, {self.energy.sum():.4g} J/m²")
        return as_html(self.name, facts, picture)

    @property
    def name(self) -> str:
        """Name of the sensor."""
        return self._attributes["sensor_name"]

    @property
    def kind(self) -> str:
        """Kind of the sensor as in scene files, such as ``didson`` or ``sidescan`` (docs/sensors.md).

        The text is empty if an opened file does not give the kind.
        """
        return self._attributes.get("sensor_kind", "")

    @property
    def energy(self) -> np.ndarray:
        """(P, B, K) float64: received energy density in J/m², for a source of 1 J/sr at 1 m."""
        return self._values["energy"]

    @property
    def energy_bound(self) -> Optional[np.ndarray]:
        """(P, B, K) float64: certified bound of the energy in J/m²; None except for a reference."""
        return self._values.get("energy_bound")

    @property
    def gradient(self) -> dict[str, np.ndarray]:
        """(P, B, K) float64 by name of a parameter: derivative of ``energy`` by it (docs/gradients.md). The dict is empty
        unless the run computed derivatives."""
        return {name.removeprefix("gradient."): values for name, values in self._values.items() if name.startswith("gradient.")}

    @property
    def gradient_bound(self) -> dict[str, np.ndarray]:
        """(P, B, K) float64 by name of a parameter: certified bound of its derivative. Only references have bounds."""
        return {name.removeprefix("gradient_bound."): values for name, values in self._values.items()
                if name.startswith("gradient_bound.")}

    @property
    def gradient_step(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """(P, B) float64, two arrays by name of a parameter: its proven decrease and increase without a change of visible edges
        and corners, in metres or radians (docs/gradients.md). The dict is empty unless the run had ``gradient_steps``."""
        forward = "gradient_forward_step."
        return {name.removeprefix(forward): (self._values["gradient_backward_step." + name.removeprefix(forward)], values)
                for name, values in self._values.items() if name.startswith(forward)}

    @property
    def energy_lower(self) -> Optional[np.ndarray]:
        """(P, B, K) float64: energy density at the lower of two receivers in J/m²; None except for ``interferometric``.

        ``energy`` is the energy density at the upper receiver. The coherence is abs(cross) / sqrt(energy * energy_lower).
        """
        return self._values.get("energy_lower")

    @property
    def cross(self) -> Optional[np.ndarray]:
        """(P, B, K) complex128, a copy: mean product of two receivers' signals in J/m²; None except for
        ``interferometric``."""
        if "cross_real" not in self._values:
            return None
        return self._values["cross_real"] + 1j * self._values["cross_imag"]

    @property
    def received(self) -> Optional[np.ndarray]:
        """(P, B, K) float64: received data in J/m², with pulse, speckle, noise, gain and quantisation (docs/sensors.md).

        The property is None for an ideal receiver, and for ``array``, which records :attr:`signals`. The values are those of
        echoes.nc, with 24 significant bits. For ``interferometric``, the data are those of the upper receiver. The first
        access creates the array.
        """
        return self._received("received")

    @property
    def received_lower(self) -> Optional[np.ndarray]:
        """(P, B, K) float64: received data of the lower of two receivers in J/m²; None except for ``interferometric``.

        :attr:`received` contains those of the upper receiver. The speckle of both has the coherence of the signals.
        """
        return self._received("received_lower")

    def _received(self, name: str) -> Optional[np.ndarray]:
        if name not in self._values:
            values = self._native.received(self._index, name == "received_lower")
            if values is not None:
                values = values if self._pings is None else values[self._pings]
                values.flags.writeable = False
                self._values[name] = values
        return self._values.get(name)

    @property
    def labels(self) -> Optional[dict[str, Any]]:
        """Objects and materials of each range bin, by the names of echoes.nc (docs/output-files.md).

        The property is None except for a run with ``labels=True``. It contains these entries:

        * ``object_share`` (P, objects, B, K) and ``material_share`` (P, materials, B, K): shares of the energy.
        * ``mean_height`` and ``mean_range`` (P, B, K): means in m.
        * ``object_label`` and ``material_label`` (P, B, K) int16: the largest contribution near the peak of the beam pattern
          (``label_level``), -1 in empty bins.
        * ``unscattered_share`` (P, B, K): share of the energy that no object scatters, only with mirrors.
        * ``objects`` and ``materials``: lists of names.

        The arrays are copies, which the first access creates. Names from a file have underscores instead of blanks. Unknown
        values are NaN.
        """
        if self._labels is None:
            labels = self._native.labels(self._index)
            if labels is not None and self._pings is not None:
                labels = {name: value if isinstance(value, list) else value[self._pings]
                          for name, value in labels.items()}
            self._labels = labels
        return self._labels

    @property
    def truth(self) -> Optional[dict[str, Any]]:
        """The former name of :attr:`labels`, with a DeprecationWarning."""
        former("truth", "labels")
        return self.labels

    @property
    def signals(self) -> Optional[Signals]:
        """Signals of the sensor's elements with phase (docs/sensors.md).

        The signals are those of all pings of the run, even if this result is a selection of pings. The property is None for
        sensors that record only energies, and for opened files. :func:`tubefoot.signals` opens files of signals.

        The first access creates the object. Its arrays are views of the program's own memory.
        """
        if self._signals is None:
            native = self._native.signals(self._index)
            self._signals = None if native is None else Signals(native)
        return self._signals

    @property
    def times(self) -> np.ndarray:
        """(P,) float64: times of the pings in s, on the scene's clock."""
        return self._value("ping_time")

    @property
    def positions(self) -> np.ndarray:
        """(P, 3) float64: east, north, up of the sensor in m."""
        return self._value("sensor_position", 3)

    @property
    def attitudes(self) -> np.ndarray:
        """(P, 4) float64: unit quaternions w, x, y, z that rotate the sensor's axes (starboard, forward, up) into the local
        frame."""
        return self._value("sensor_attitude", 4)

    @property
    def poses(self) -> np.ndarray:
        """(P, 6) float64, a copy: east, north, up in m, heading, pitch, roll in degrees."""
        angles = [self._value("sensor_" + name) for name in ("heading", "pitch", "roll")]
        return np.column_stack([self.positions, *angles])

    @property
    def altitudes(self) -> np.ndarray:
        """(P,) float64: height of the sensor above the terrain directly below in m.

        The value is NaN if there is no terrain below, and for an opened file.
        """
        return self._unknown("ping_time") if self._altitude is None else self._altitude

    @property
    def slant_ranges(self) -> np.ndarray:
        """(K,) float64: slant range of each sample's centre in m."""
        return self._values["slant_range"]

    @property
    def slant_range_bounds(self) -> np.ndarray:
        """(K, 2) float64: start and end of each sample in m."""
        return self._value("slant_range_bounds", 2)

    @property
    def beam_azimuths(self) -> np.ndarray:
        """(B,) float64: azimuth of each beam's axis in degrees, clockwise from forward."""
        return self._values["beam_azimuth"]

    @property
    def beam_elevations(self) -> np.ndarray:
        """(B,) float64: elevation of each beam's axis in degrees, upwards."""
        return self._value("beam_elevation")

    def to_xarray(self) -> xarray.Dataset:
        """Returns a dataset with the layout of echoes.nc: dimensions, names, ``units`` and ``long_name``.

        ``ping_utc`` contains dates. Descriptions of pings, beams and samples are coordinates; energies and poses are data.
        The method does not copy energies. It creates received data (:attr:`received`). The method needs xarray (Debian: python3-xarray).
        """
        import xarray

        variables = {}
        for name in ("received", "received_lower"):
            self._received(name)  # creates the array
        for name, (dimensions, units, long_name) in self._variables.items():
            if name in self._values and name != "ping_utc":
                variables[name] = (dimensions, self._values[name], {"units": units, "long_name": long_name})
        coordinates = {name: variables.pop(name) for name in _COORDINATES if name in variables}
        if "slant_range_bounds" in coordinates:
            coordinates["slant_range"][2]["bounds"] = "slant_range_bounds"
        attributes = {**self._native.file_attributes(), **self._attributes}
        if "start_utc" not in attributes or "ping_time" not in coordinates:
            return xarray.Dataset(variables, coordinates, attributes)
        date = {"units": f"seconds since {attributes['start_utc']}", "calendar": "standard", "standard_name": "time",
                "long_name": "date and time of the transmission"}
        dates = xarray.decode_cf(xarray.Dataset({"ping_utc": (("ping",), self._values["ping_time"], date)}))
        coordinates["ping_utc"] = dates["ping_utc"].variable
        return xarray.Dataset(variables, coordinates, attributes)

    def __repr__(self) -> str:
        pings, beams, samples = self.energy.shape
        return f"<tubefoot.SensorResult {self.name!r}: {pings} pings x {beams} beams x {samples} samples>"


class Result(Mapping[str, SensorResult]):
    """The echoes of a run, or of the files of a run (:func:`open`), by sensor: ``result["camera"].energy``.

    Notebooks display the pictures of the sensors.
    """

    def __init__(self, native: _native.Result, warnings: list[str]) -> None:
        self._native = native
        self._warnings = warnings
        self._sensors = {name: SensorResult(native, i) for i, name in enumerate(native.sensors)}

    def __getitem__(self, sensor: str) -> SensorResult:
        try:
            return self._sensors[sensor]
        except KeyError:
            has = ", ".join(map(repr, self))
            raise KeyError(f"the result has no sensor {sensor!r}; it has {has}{meant(sensor, self)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._sensors)

    def __len__(self) -> int:
        return len(self._sensors)

    @property
    def stats(self) -> dict[str, Any]:
        """The content of the run's stats.json: counts, seconds, settings, warnings. It is empty for a single echo file."""
        return json.loads(self._native.statistics or "{}")

    @property
    def warnings(self) -> list[str]:
        """Warnings about probable mistakes, and about data that the files omit."""
        return list(self._warnings)

    def _repr_html_(self) -> str:
        return "".join(sensor._repr_html_() for sensor in self.values())

    def to_xarray(self) -> dict[str, xarray.Dataset]:
        """Returns one dataset per sensor (:meth:`SensorResult.to_xarray`), by name."""
        return {name: sensor.to_xarray() for name, sensor in self.items()}

    def __repr__(self) -> str:
        return f"<tubefoot.Result: {', '.join(self)}>"


_RANGES = {"threads": (1, 4096), "rays": (1, 10**10), "rays_per_beam": (1, 10**10), "seed": (0, 2**63 - 1)}


def _checked(options: dict[str, Any]) -> dict[str, Any]:
    for name, choices in CHOICES.items():
        if options.get(name) is not None and options[name] not in choices:
            raise UsageError(f"{name}: {options[name]!r} is not {one_of(choices)}{meant(options[name], choices)}")
    for name, (least, most) in _RANGES.items():
        if options.get(name) is None:
            continue
        options[name] = whole(name, options[name])
        if not least <= options[name] <= most:
            raise UsageError(f"{name}: {options[name]} is not within {least} to {most}")
    if options.get("rays") is not None and options.get("rays_per_beam") is not None:
        raise UsageError("rays and rays_per_beam exclude each other: leave out one of them")
    return options


@with_named_arguments
def run(scene: Union[Scene, PathLike], *, engine: Union[str, Engine, None] = None, tolerance: Union[float, str, None] = None,
        threads: Optional[int] = None, arithmetic: Optional[str] = None, binning: Optional[str] = None,
        sampling: Optional[str] = None, rays: Optional[int] = None, rays_per_beam: Optional[int] = None,
        seed: Optional[int] = None, sensor: Optional[str] = None, pings: Union[int, str, None] = None,
        beams: Union[int, str, None] = None, coarsen: float = 0, labels: bool = False, label_level: Optional[float] = None,
        gradient: Optional[Sequence[str]] = None, gradient_steps: bool = False,
        output: Optional[PathLike] = None, without: Sequence[str] = (), progress: Optional[Progress] = None) -> Result:
    """Simulates all pings of a scene in memory, as ``tubefoot run`` does.

    Args:
        scene: the scene, or the name of its file.
        engine: ``"tube"`` (exact), ``"ray"`` (sampling), or a function marked by :func:`engine` or :func:`sensor`; by
            default the engine of the scene.
        tolerance: permitted error, relative (``1e-3``; 1e-6 to 0.1), ``"20%"`` or ``"0.1dB"``. tubefoot selects engine
            and settings.
        threads: number of threads, 1 to 4096; by default the number in the scene, else all cores. Simultaneous runs use
            the smallest number that any of them requests.
        arithmetic: ``"fixed"``, ``"filtered"``, ``"rational"`` or ``"double"``.
        binning: tube engine: ``"exact"``, ``"spread"`` or ``"centroid"``.
        sampling: ray engine: ``"stratified"``, ``"sobol"``, ``"adaptive"``, ``"regular"``, ``"random"`` or ``"column"``.
        rays: ray engine: number of rays per ping.
        rays_per_beam: ray engine: number of rays per beam, instead of ``rays``.
        seed: ray engine: seed of the sampling.
        sensor: name of the only sensor to run.
        pings: pings of each sensor to run: one, or ``"A:B"``, both included, counted from 0. Their energies are those of
            the whole run.
        beams: beams of each sensor to run, in the form of ``pings``, or several such parts separated by commas.
        coarsen: largest displacement of a point of a facet when facets are merged, from 0 (no merging) to 1. The unit is the
            resolution of the scene's sonars at that point. ``stats["coarsening"]`` contains the bounds.
        labels: also compute the objects and materials of each range bin, and its mean height and range
            (:attr:`SensorResult.labels`). The former name ``truth`` gives a DeprecationWarning.
        label_level: with ``labels``: level in dB below the two-way peak of the beam pattern. An object owns a label only
            through contributions above this level; by default 20.
        gradient: names of parameters (:meth:`Scene.gradient_parameters`): also compute the derivatives of energies by them
            (:attr:`SensorResult.gradient`), and those of the signals of smooth materials (:attr:`Signals.gradient`).
        gradient_steps: with ``gradient``: also prove how far each parameter may move before the visible edges change
            (:attr:`SensorResult.gradient_step`).
        output: folder for the files of ``tubefoot run -o``. The files appear only when complete.
        without: with ``output``: files that are not written, such as ``"sonar.nc"`` (of all sensors) or
            ``"fan-sonar.nc"`` (of the sensor ``fan``).
        progress: function that is called occasionally with the number of finished pings and of all pings. An exception
            from this function stops the run.

    Other Python threads continue during a run. Ctrl-C stops the run within its current pings and leaves no partial files.

    A probable mistake in the scene gives a :class:`SceneWarning`. A sensor that receives nothing gives a
    :class:`SilenceWarning`. Each warning appears as soon as its cause is known. With
    ``warnings.simplefilter("error", tubefoot.SilenceWarning)`` such a run stops before its first ping. With refraction,
    tiled terrain, relief refined per transmission or multiple paths, the cause is known only after the run.

    Raises:
        InputError: the scene is invalid.
        UsageError: options contradict each other, or the output folder contains files that tubefoot did not write.
    """
    options = dict(threads=threads, arithmetic=arithmetic, binning=binning, sampling=sampling, rays=rays,
                   rays_per_beam=rays_per_beam, seed=seed, labels=bool(labels),
                   label_level=None if label_level is None else float(label_level),
                   output=None if output is None else os.fspath(output))
    options |= dict(sensor=sensor, pings=None if pings is None else str(pings),
                    beams=None if beams is None else str(beams))
    if tolerance is not None:
        options["tolerance"] = tolerance if isinstance(tolerance, str) else repr(float(tolerance))
    options |= gradient_option(gradient)
    options["gradient_steps"] = bool(gradient_steps)
    if coarsen:
        options["coarsen"] = repr(float(coarsen))
    options |= without_option(without, output)
    if output is not None and not os.fspath(output):
        raise UsageError("output: the name of a folder is empty")
    own = own_engine(engine)
    if own is None:
        options["engine"] = engine
    elif tolerance is not None:
        raise UsageError("a tolerance selects a built-in engine: leave out 'engine' or 'tolerance'")
    return _run(scene, options, own, progress)


@with_named_arguments
def reference(scene: Union[Scene, PathLike], tolerance: float = 1e-9, *, arithmetic: Optional[str] = None,
              threads: Optional[int] = None, gradient: Optional[Sequence[str]] = None,
              output: Optional[PathLike] = None, progress: Optional[Progress] = None) -> Result:
    """Computes certified echoes, as ``tubefoot run --reference`` does: ``energy`` and ``energy_bound`` of each sensor.

    Args:
        scene: the scene, or the name of its file.
        tolerance: requested relative bound, 1e-12 to 0.1. :attr:`Result.stats` reports bins that exceed it.
        arithmetic, threads, output, progress: as for :func:`run`.
        gradient: names of parameters: also compute enclosures of the derivatives of energies by them
            (:attr:`SensorResult.gradient`, :attr:`SensorResult.gradient_bound`).

    The true energy of every ping, beam and sample lies within ``energy`` +- ``energy_bound``, in J/m² (docs/reference-results.md).

    Raises:
        InputError, UsageError: as for :func:`run`.
    """
    options = dict(arithmetic=arithmetic, threads=threads, reference=True, tolerance=repr(float(tolerance)),
                   output=None if output is None else os.fspath(output)) | gradient_option(gradient)
    return _run(scene, options, None, progress)


def _run(scene: Union[Scene, PathLike], options: dict[str, Any], own: Optional[Engine],
         progress: Optional[Progress]) -> Result:
    _checked(options)
    known = a_scene(scene)
    with known._explained():
        native = _native.run(known._native, options, own.name if own else None, own.checked if own else None, progress,
                             lambda warning, is_silence: warn(known._said(warning), is_silence))
    return Result(native, [known._said(warning) for warning in native.warnings])


@with_named_arguments
def open(result: PathLike) -> Result:
    """Reads the files of a run and returns its result: ``tubefoot.open("out/wellhead")["camera"].energy``.

    Args:
        result: a folder that :func:`run` or ``tubefoot run`` wrote, or an echo file. The echo file may come from another
            program that follows docs/output-files.md. The function reads the whole echo file into memory.
            :meth:`SensorResult.to_xarray` includes additional variables of the file.

    Raises:
        InputError: the file does not exist, or it is not an echo file.
    """
    native = _native.open(os.fspath(result))
    try:
        warnings = [in_python(text) for text in json.loads(native.statistics or "{}").get("warnings", [])]
    except (ValueError, AttributeError, TypeError):
        name = os.path.join(os.fspath(result), "stats.json")
        raise InputError(f"{name} is not a valid result of a run: restore the file, or open echoes.nc only", name) from None
    return Result(native, warnings)
