# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs, what comes out of them, and what they wrote."""

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
from ._picture import Picture, as_html, drawn, plural
from ._scene import PathLike, Scene, a_scene
from ._signals import Signals
from ._words import CHOICES, former, in_python, meant, one_of, with_named_arguments

if TYPE_CHECKING:
    import xarray

Progress = Callable[[int, int], Any]

# Dimensions, units and meaning of echoes.nc (docs/echo-file.md).
_VARIABLES: dict[str, tuple[tuple[str, ...], str, str]] = {
    "energy": (("ping", "beam", "sample"), "J m-2",
               "received energy density per beam and range sample, for a source of 1 J/sr at 1 m"),
    "energy_lower": (("ping", "beam", "sample"), "J m-2",
                     "received energy density per beam and range bin at the lower receiver; energy is that of the upper receiver"),
    "cross_real": (("ping", "beam", "sample"), "J m-2",
                   "mean product of the upper receiver's signal and the lower one's conjugate, real part"),
    "cross_imag": (("ping", "beam", "sample"), "J m-2",
                   "mean product of the upper receiver's signal and the lower one's conjugate, imaginary part"),
    "energy_bound": (("ping", "beam", "sample"), "J m-2",
                     "certified half-width: the true energy lies within energy +- energy_bound"),
    "ping_time": (("ping",), "s", "time of the transmission on the scene's clock"),
    "slant_range": (("sample",), "m", "slant range of the sample's centre"),
    "slant_range_bounds": (("sample", "bound"), "m",
                           "slant ranges between which the sample gathers energy, the nearer included"),
    "two_way_travel_time": (("sample",), "s", "two-way travel time of the sample's centre"),
    "beam_azimuth": (("beam",), "degree", "azimuth of the beam's axis in the sensor's frame, clockwise from "
                     "forward, starboard positive"),
    "beam_elevation": (("beam",), "degree", "elevation of the beam's axis above the sensor's horizontal plane"),
    "beam_azimuth_width": (("beam",), "degree", "full one-way width of the ideal rectangular beam in azimuth"),
    "beam_elevation_width": (("beam",), "degree", "full one-way width of the ideal rectangular beam in elevation"),
    "sensor_position": (("ping", "xyz"), "m", "position of the sensor in the local frame: east, north, up"),
    "sensor_attitude": (("ping", "wxyz"), "1", "quaternion w, x, y, z that turns the sensor's axes (x starboard, y "
                        "forward, z up) into the local frame"),
    "sensor_heading": (("ping",), "degree", "heading of the sensor's forward axis, clockwise from the local frame's "
                       "north"),
    "sensor_pitch": (("ping",), "degree", "pitch of the sensor, forward axis up positive"),
    "sensor_roll": (("ping",), "degree", "roll of the sensor, starboard down positive"),
    # Of a part of a run.
    "ping_number": (("ping",), "1", "ping of the scene, counted from 0"),
    "beam_number": (("beam",), "1", "beam of the sonar, counted from 0"),
    # Of a survey with lines.
    "line": (("ping",), "1", "line of the survey, counted from 1"),
    # Of a scene with a place on Earth.
    "sensor_longitude": (("ping",), "degrees_east", "longitude of the sensor on WGS 84"),
    "sensor_latitude": (("ping",), "degrees_north", "latitude of the sensor on WGS 84"),
    "sensor_height": (("ping",), "m", "height of the sensor, up positive, as the scene's heights count"),
    "sensor_true_heading": (("ping",), "degree", "heading of the sensor's forward axis, clockwise from true north"),
}
_COORDINATES = ("ping_time", "slant_range", "slant_range_bounds", "two_way_travel_time", "beam_azimuth",
                "beam_elevation", "beam_azimuth_width", "beam_elevation_width", "ping_number", "beam_number")


class SensorResult:
    """The echoes of one sensor, as read-only arrays that share the run's memory.

    ``P`` pings, ``B`` beams and ``K`` range samples; names and units are those of echoes.nc (docs/echo-file.md). What an
    opened file does not say is not a number.

    ``echoes[2:5]``, ``echoes[-1]`` and ``echoes[[0, 7]]`` are some of its pings, counted as NumPy counts, as another
    SensorResult, whose pings begin at 0; one ping, too, is a result with ``P = 1``.
    """

    def __init__(self, native: _native.Result, index: int) -> None:
        self._native = native
        self._index = index
        self._pings: Optional[np.ndarray] = None  # of a slice: their places in what it is a slice of
        self._labels: Optional[dict[str, Any]] = None  # once it was asked for
        self._signals: Optional[Signals] = None  # the same
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
                raise TypeError(f"numbers of pings are integers, not {numbers.dtype}")
            if numbers.dtype == bool and len(numbers) != len(self):
                raise IndexError(f"{len(numbers)} booleans for {plural(len(self), 'ping')}")
            for ping in () if numbers.dtype == bool else numbers:
                self._number(int(ping))
            return numbers
        try:
            ping = self._number(operator.index(pings))  # type: ignore[arg-type]
        except TypeError:
            raise TypeError(f"expected a ping, a slice or numbers of pings, not {type(pings).__name__}") from None
        return slice(ping, ping + 1)

    def _number(self, ping: int) -> int:
        if not -len(self) <= ping < len(self):
            has = f"pings 0 to {len(self) - 1}" if len(self) else "no ping"
            raise IndexError(f"ping {ping}: sensor {self.name!r} has {has}")
        return ping % len(self)

    @property
    def pings(self) -> np.ndarray:
        """(P,) int64: the number that each ping has in the run."""
        if "ping_number" in self._values:
            return self._values["ping_number"].astype(np.int64)
        return np.arange(len(self)) if self._pings is None else self._pings

    @with_named_arguments
    def picture(self, ping: Optional[int] = None) -> Picture:
        """What the echoes look like, as the program draws it: of a fan ahead the ping, or several side by side; of beams
        to both sides the waterfall; of beams downwards the echogram of the steepest. Ideal, not as received.

        Args:
            ping: one ping of a fan; by default all, of a sequence 20 at most.

        Raises:
            UsageError: there is no ping, or pings of this sensor are drawn side by side only.
            InputError: samples of an opened file are not evenly spaced.
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
        """The sensor's name."""
        return self._attributes["sensor_name"]

    @property
    def kind(self) -> str:
        """The kind of sensor as scene files name it, such as ``didson`` or ``sidescan`` (docs/sensors.md); empty where an
        opened file does not say."""
        return self._attributes.get("sensor_kind", "")

    @property
    def energy(self) -> np.ndarray:
        """(P, B, K) float64: received energy density in J/m², for a source of 1 J/sr at 1 m."""
        return self._values["energy"]

    @property
    def energy_bound(self) -> Optional[np.ndarray]:
        """(P, B, K) float64: certified half-width of the energy in J/m²; None but for a reference."""
        return self._values.get("energy_bound")

    @property
    def energy_lower(self) -> Optional[np.ndarray]:
        """(P, B, K) float64: what the lower of two receivers hears in J/m² (``energy`` is the upper one's); None but
        for ``interferometric``. The coherence is abs(cross) / sqrt(energy * energy_lower)."""
        return self._values.get("energy_lower")

    @property
    def cross(self) -> Optional[np.ndarray]:
        """(P, B, K) complex128, a copy: mean product of two receivers' signals in J/m²; None but for
        ``interferometric``."""
        if "cross_real" not in self._values:
            return None
        return self._values["cross_real"] + 1j * self._values["cross_imag"]

    @property
    def labels(self) -> Optional[dict[str, Any]]:
        """Objects and materials of each range bin, by the names of echoes.nc (docs/labels.md); None except for a run with
        ``labels=True``.

        ``object_share`` (P, objects, B, K) and ``material_share`` (P, materials, B, K): shares of the energy.
        ``mean_height`` and ``mean_range`` (P, B, K) in m. ``object_label`` and ``material_label`` (P, B, K) int16: the
        largest contribution near the peak of the beam pattern (``label_level``), -1 in empty bins. Over mirrors also
        ``unscattered_share`` (P, B, K). ``objects`` and ``materials`` are lists of names.
        The arrays are copies, made at the first access. Names read from a file have underscores instead of blanks;
        unknown values are NaN.
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
        """What a sensor's elements received, with phase (docs/sensors.md): of all pings of the run, also where this is
        some of them. None for sensors that keep energies alone, and for files: those of signals are opened by
        :func:`tubefoot.signals`.

        Made when this is first asked for; what its arrays show is the program's own memory.
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
        """(P, 4) float64: unit quaternions w, x, y, z that turn the sensor's axes (starboard, forward, up) into the
        local frame."""
        return self._value("sensor_attitude", 4)

    @property
    def poses(self) -> np.ndarray:
        """(P, 6) float64, a copy: east, north, up in m, heading, pitch, roll in degrees."""
        angles = [self._value("sensor_" + name) for name in ("heading", "pitch", "roll")]
        return np.column_stack([self.positions, *angles])

    @property
    def altitudes(self) -> np.ndarray:
        """(P,) float64: height of the sensor above the terrain straight below in m; not a number without one, and of an
        opened file."""
        return self._unknown("ping_time") if self._altitude is None else self._altitude

    @property
    def slant_ranges(self) -> np.ndarray:
        """(K,) float64: slant range of each sample's centre in m."""
        return self._values["slant_range"]

    @property
    def slant_range_bounds(self) -> np.ndarray:
        """(K, 2) float64: where each sample begins and ends in m."""
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
        """A dataset laid out as echoes.nc: its dimensions, names, ``units`` and ``long_name``; ``ping_utc`` as dates.

        What describes pings, beams and samples are coordinates, energies and poses are data. Energies are not copied.
        Needs xarray (Debian: python3-xarray).
        """
        import xarray

        variables = {}
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
    """The echoes of a run, or of what one wrote (:func:`open`), by sensor: ``result["camera"].energy``. Notebooks show
    their pictures."""

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
        """What stats.json of a run says: counts, seconds, settings, warnings. Empty of an echo file by itself."""
        return json.loads(self._native.statistics or "{}")

    @property
    def warnings(self) -> list[str]:
        """What may not be meant, and what the files leave out."""
        return list(self._warnings)

    def _repr_html_(self) -> str:
        return "".join(sensor._repr_html_() for sensor in self.values())

    def to_xarray(self) -> dict[str, xarray.Dataset]:
        """A dataset a sensor (:meth:`SensorResult.to_xarray`), by name."""
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
            raise UsageError(f"{name}: {options[name]} is not in {least} to {most}")
    if options.get("rays") is not None and options.get("rays_per_beam") is not None:
        raise UsageError("rays and rays_per_beam: give one of them")
    return options


@with_named_arguments
def run(scene: Union[Scene, PathLike], *, engine: Union[str, Engine, None] = None, tolerance: Union[float, str, None] = None,
        threads: Optional[int] = None, arithmetic: Optional[str] = None, binning: Optional[str] = None,
        sampling: Optional[str] = None, rays: Optional[int] = None, rays_per_beam: Optional[int] = None,
        seed: Optional[int] = None, sensor: Optional[str] = None, pings: Union[int, str, None] = None,
        beams: Union[int, str, None] = None, coarsen: float = 0, labels: bool = False, label_level: Optional[float] = None,
        output: Optional[PathLike] = None, progress: Optional[Progress] = None) -> Result:
    """Simulates all pings of a scene, as ``tubefoot run`` does, into memory.

    Args:
        scene: the scene, or the name of its file.
        engine: ``"tube"`` (exact) or ``"ray"`` (sampling), or a function marked by :func:`engine` or :func:`sensor`;
            by default, as the scene says.
        tolerance: error allowed, relative (``1e-3``; 1e-6 to 0.1), ``"20%"`` or ``"0.1dB"``: picks engine and settings.
        threads: threads to use, 1 to 4096; by default as the scene says, else all cores. Runs at the same time share
            the least that any of them asks for.
        arithmetic: ``"fixed"``, ``"filtered"``, ``"rational"`` or ``"double"``.
        binning: tube engine: ``"exact"``, ``"spread"`` or ``"centroid"``.
        sampling: ray engine: ``"stratified"``, ``"sobol"``, ``"adaptive"``, ``"regular"``, ``"random"`` or ``"column"``.
        rays: ray engine: rays a ping.
        rays_per_beam: ray engine: rays a beam, instead.
        seed: ray engine: seed of the sampling.
        sensor: only this sensor, by its name.
        pings: only these of each sensor: one, or ``"A:B"``, both included, counted from 0. Their energies are the
            whole run's.
        beams: only these of each sensor, as ``pings``, or several such between commas.
        coarsen: lets facets become fewer where no point of them moves by more than this part of what the scene's sonars
            tell apart there, 0 (not at all) to 1; ``stats["coarsening"]`` tells the bounds.
        labels: also compute the objects and materials of each range bin, and its mean height and range
            (:attr:`SensorResult.labels`). The former name ``truth`` gives a DeprecationWarning.
        label_level: with ``labels``: level in dB below the two-way peak of the beam pattern. An object owns a label only
            through contributions above this level; by default 20.
        output: folder to write as well, as ``tubefoot run -o`` does: whole or not at all.
        progress: called now and then with the pings finished and all pings; what it raises ends the run.

    Other Python threads run meanwhile. Ctrl-C ends the run, pings at hand unfinished; nothing half-written is left. What may
    not be meant is a :class:`SceneWarning`, a sensor that receives nothing a :class:`SilenceWarning`, as soon as it is known:
    with ``warnings.simplefilter("error", tubefoot.SilenceWarning)`` such a run ends before its first ping.

    Raises:
        InputError: the scene is wrong.
        UsageError: options contradict each other, or the output folder is somebody else's.
    """
    options = dict(threads=threads, arithmetic=arithmetic, binning=binning, sampling=sampling, rays=rays,
                   rays_per_beam=rays_per_beam, seed=seed, labels=bool(labels),
                   label_level=None if label_level is None else float(label_level),
                   output=None if output is None else os.fspath(output))
    options |= dict(sensor=sensor, pings=None if pings is None else str(pings),
                    beams=None if beams is None else str(beams))
    if tolerance is not None:
        options["tolerance"] = tolerance if isinstance(tolerance, str) else repr(float(tolerance))
    if coarsen:
        options["coarsen"] = repr(float(coarsen))
    if output is not None and not os.fspath(output):
        raise UsageError("output: the name of a folder is empty")
    own = own_engine(engine)
    if own is None:
        options["engine"] = engine
    elif tolerance is not None:
        raise UsageError("a tolerance picks among the engines that are built in: leave out 'engine' or 'tolerance'")
    return _run(scene, options, own, progress)


@with_named_arguments
def reference(scene: Union[Scene, PathLike], tolerance: float = 1e-9, *, arithmetic: Optional[str] = None,
              threads: Optional[int] = None, output: Optional[PathLike] = None,
              progress: Optional[Progress] = None) -> Result:
    """Certified echoes, as ``tubefoot run --reference``: ``energy`` and ``energy_bound`` of each sensor.

    Args:
        scene: the scene, or the name of its file.
        tolerance: relative bound asked for, 1e-12 to 0.1; :attr:`Result.stats` tells of bins that miss it.
        arithmetic, threads, output, progress: as of :func:`run`.

    The true energy of every ping, beam and sample lies within ``energy`` +- ``energy_bound``, in J/m²
    (docs/reference.md). Raises what :func:`run` raises.
    """
    options = dict(arithmetic=arithmetic, threads=threads, reference=True, tolerance=repr(float(tolerance)),
                   output=None if output is None else os.fspath(output))
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
    """What a run wrote, as it returned it: ``tubefoot.open("out/wellhead")["camera"].energy``.

    Args:
        result: a folder that :func:`run` or ``tubefoot run`` wrote, or an echo file, ours or of anybody who keeps to
            docs/echo-file.md. All of the echo file is read into memory, with variables that only it has
            (:meth:`SensorResult.to_xarray`).

    Raises:
        InputError: there is no such file, or it is no echo file.
    """
    native = _native.open(os.fspath(result))
    try:
        warnings = [in_python(text) for text in json.loads(native.statistics or "{}").get("warnings", [])]
    except (ValueError, AttributeError, TypeError):
        name = os.path.join(os.fspath(result), "stats.json")
        raise InputError(f"{name}: it is not what a run wrote: bring it back, or open echoes.nc alone", name) from None
    return Result(native, warnings)
