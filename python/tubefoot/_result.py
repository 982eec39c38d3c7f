# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs and what comes out of them."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

from . import _native
from ._engines import Engine, own_engine
from ._errors import UsageError, whole
from ._scene import PathLike, Scene, a_scene, warn

if TYPE_CHECKING:
    import xarray

Progress = Callable[[int, int], Any]

# Dimensions, units and meaning of echoes.nc (docs/echo-file.md).
_VARIABLES: dict[str, tuple[tuple[str, ...], str, str]] = {
    "energy": (("ping", "beam", "sample"), "J",
               "echo energy per beam and range sample, for a source of 1 J/sr at 1 m"),
    "energy_lower": (("ping", "beam", "sample"), "J",
                     "echo energy per beam and range sample that the lower receiver hears; energy is the upper's"),
    "cross_real": (("ping", "beam", "sample"), "J",
                   "mean product of the upper receiver's signal and the lower one's conjugate, real part"),
    "cross_imag": (("ping", "beam", "sample"), "J",
                   "mean product of the upper receiver's signal and the lower one's conjugate, imaginary part"),
    "energy_bound": (("ping", "beam", "sample"), "J",
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
    # Of a survey with lines.
    "line": (("ping",), "1", "line of the survey, counted from 1"),
    # Of a scene with a place on Earth.
    "sensor_longitude": (("ping",), "degrees_east", "longitude of the sensor on WGS 84"),
    "sensor_latitude": (("ping",), "degrees_north", "latitude of the sensor on WGS 84"),
    "sensor_height": (("ping",), "m", "height of the sensor, up positive, as the scene's heights count"),
    "sensor_true_heading": (("ping",), "degree", "heading of the sensor's forward axis, clockwise from true north"),
}
_COORDINATES = ("ping_time", "slant_range", "slant_range_bounds", "two_way_travel_time", "beam_azimuth",
                "beam_elevation", "beam_azimuth_width", "beam_elevation_width")


class SensorResult:
    """The echoes of one sensor, as read-only arrays that share the run's memory.

    ``P`` pings, ``B`` beams and ``K`` range samples; names and units are those of echoes.nc (docs/echo-file.md).
    """

    def __init__(self, native: _native.Result, index: int) -> None:
        self._native = native
        self._values: dict[str, np.ndarray] = {**native.arrays(index), **native.axes(index)}
        self._altitude = self._values.pop("altitude")
        self._attributes: dict[str, Any] = native.attributes(index)

    @property
    def name(self) -> str:
        """The sensor's name."""
        return self._attributes["sensor_name"]

    @property
    def kind(self) -> str:
        """The kind of sensor as scene files name it, such as ``didson`` or ``sidescan`` (docs/sensors.md)."""
        return self._attributes["sensor_kind"]

    @property
    def energy(self) -> np.ndarray:
        """(P, B, K) float64: echo energy in J, for a source of 1 J/sr at 1 m."""
        return self._values["energy"]

    @property
    def energy_bound(self) -> Optional[np.ndarray]:
        """(P, B, K) float64: certified half-width of the energy in J; None but for a reference."""
        return self._values.get("energy_bound")

    @property
    def energy_lower(self) -> Optional[np.ndarray]:
        """(P, B, K) float64: what the lower of two receivers hears in J (``energy`` is the upper one's); None but
        for ``interferometric``. The coherence is abs(cross) / sqrt(energy * energy_lower)."""
        return self._values.get("energy_lower")

    @property
    def cross(self) -> Optional[np.ndarray]:
        """(P, B, K) complex128, a copy: mean product of two receivers' signals in J; None but for
        ``interferometric``."""
        if "cross_real" not in self._values:
            return None
        return self._values["cross_real"] + 1j * self._values["cross_imag"]

    @property
    def times(self) -> np.ndarray:
        """(P,) float64: times of the pings in s, on the scene's clock."""
        return self._values["ping_time"]

    @property
    def positions(self) -> np.ndarray:
        """(P, 3) float64: east, north, up of the sensor in m."""
        return self._values["sensor_position"]

    @property
    def attitudes(self) -> np.ndarray:
        """(P, 4) float64: unit quaternions w, x, y, z that turn the sensor's axes (starboard, forward, up) into the
        local frame."""
        return self._values["sensor_attitude"]

    @property
    def poses(self) -> np.ndarray:
        """(P, 6) float64, a copy: east, north, up in m, heading, pitch, roll in degrees."""
        angles = [self._values["sensor_" + name] for name in ("heading", "pitch", "roll")]
        return np.column_stack([self.positions, *angles])

    @property
    def altitudes(self) -> np.ndarray:
        """(P,) float64: height of the sensor above the terrain straight below in m; not a number without one."""
        return self._altitude

    @property
    def slant_ranges(self) -> np.ndarray:
        """(K,) float64: slant range of each sample's centre in m."""
        return self._values["slant_range"]

    @property
    def slant_range_bounds(self) -> np.ndarray:
        """(K, 2) float64: where each sample begins and ends in m."""
        return self._values["slant_range_bounds"]

    @property
    def beam_azimuths(self) -> np.ndarray:
        """(B,) float64: azimuth of each beam's axis in degrees, clockwise from forward."""
        return self._values["beam_azimuth"]

    @property
    def beam_elevations(self) -> np.ndarray:
        """(B,) float64: elevation of each beam's axis in degrees, upwards."""
        return self._values["beam_elevation"]

    def to_xarray(self) -> xarray.Dataset:
        """A dataset laid out as echoes.nc: its dimensions, names, ``units`` and ``long_name``; ``ping_utc`` as dates.

        What describes pings, beams and samples are coordinates, energies and poses are data. Energies are not copied.
        Needs xarray (Debian: python3-xarray).
        """
        import xarray

        variables = {}
        for name, (dimensions, units, long_name) in _VARIABLES.items():
            if name in self._values:
                variables[name] = (dimensions, self._values[name], {"units": units, "long_name": long_name})
        coordinates = {name: variables.pop(name) for name in _COORDINATES}
        coordinates["slant_range"][2]["bounds"] = "slant_range_bounds"
        attributes = {**self._native.file_attributes(), **self._attributes}
        date = {"units": f"seconds since {attributes['start_utc']}", "calendar": "standard", "standard_name": "time",
                "long_name": "date and time of the transmission"}
        dates = xarray.decode_cf(xarray.Dataset({"ping_utc": (("ping",), self._values["ping_time"], date)}))
        coordinates["ping_utc"] = dates["ping_utc"].variable
        return xarray.Dataset(variables, coordinates, attributes)

    def __repr__(self) -> str:
        pings, beams, samples = self.energy.shape
        return f"<tubefoot.SensorResult {self.name!r}: {pings} pings x {beams} beams x {samples} samples>"


class Result(Mapping[str, SensorResult]):
    """The echoes of a run, by sensor: ``result["camera"].energy``."""

    def __init__(self, native: _native.Result) -> None:
        self._native = native
        self._sensors = {name: SensorResult(native, i) for i, name in enumerate(native.sensors)}

    def __getitem__(self, sensor: str) -> SensorResult:
        try:
            return self._sensors[sensor]
        except KeyError:
            raise KeyError(f"the scene has no sensor {sensor!r}; it has {', '.join(map(repr, self))}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._sensors)

    def __len__(self) -> int:
        return len(self._sensors)

    @property
    def stats(self) -> dict[str, Any]:
        """What stats.json of a run says: counts, seconds, settings, warnings."""
        return json.loads(self._native.statistics)

    @property
    def warnings(self) -> list[str]:
        """What may not be meant, and what the files leave out."""
        return self._native.warnings

    def to_xarray(self) -> dict[str, xarray.Dataset]:
        """A dataset a sensor (:meth:`SensorResult.to_xarray`), by name."""
        return {name: sensor.to_xarray() for name, sensor in self.items()}

    def __repr__(self) -> str:
        return f"<tubefoot.Result: {', '.join(self)}>"


_CHOICES = {"engine": ("tube", "ray"), "arithmetic": ("fixed", "filtered", "rational", "double"),
            "binning": ("exact", "spread", "centroid"),
            "sampling": ("stratified", "regular", "random", "column")}
_RANGES = {"threads": (1, 4096), "rays": (1, 10**10), "rays_per_beam": (1, 10**10), "seed": (0, 2**63 - 1)}


def _checked(options: dict[str, Any]) -> dict[str, Any]:
    for name, choices in _CHOICES.items():
        if options.get(name) is not None and options[name] not in choices:
            raise UsageError(f"{name}: {options[name]} not in {{{','.join(choices)}}}")
    for name, (least, most) in _RANGES.items():
        if options.get(name) is None:
            continue
        options[name] = whole(name, options[name])
        if not least <= options[name] <= most:
            raise UsageError(f"{name}: Value {options[name]} not in range [{least} - {most}]")
    if options.get("rays") is not None and options.get("rays_per_beam") is not None:
        raise UsageError("rays excludes rays_per_beam")
    return options


def run(scene: Scene, *, engine: Union[str, Engine, None] = None, tolerance: Union[float, str, None] = None,
        threads: Optional[int] = None, arithmetic: Optional[str] = None, binning: Optional[str] = None,
        sampling: Optional[str] = None, rays: Optional[int] = None, rays_per_beam: Optional[int] = None,
        seed: Optional[int] = None, output: Optional[PathLike] = None,
        progress: Optional[Progress] = None) -> Result:
    """Simulates all pings of a scene, as ``tubefoot run`` does, into memory.

    Args:
        scene: the scene.
        engine: ``"tube"`` (exact) or ``"ray"`` (sampling), or a function marked by :func:`engine` or :func:`sensor`;
            by default, as the scene says.
        tolerance: error allowed, relative (``1e-3``; 1e-6 to 1) or ``"0.1dB"``: picks engine and settings.
        threads: threads to use, 1 to 4096; by default as the scene says, else all cores. Runs at the same time share
            the least that any of them asks for.
        arithmetic: ``"fixed"``, ``"filtered"``, ``"rational"`` or ``"double"``.
        binning: tube engine: ``"exact"``, ``"spread"`` or ``"centroid"``.
        sampling: ray engine: ``"stratified"``, ``"regular"``, ``"random"`` or ``"column"``.
        rays: ray engine: rays a ping.
        rays_per_beam: ray engine: rays a beam, instead.
        seed: ray engine: seed of the sampling.
        output: folder to write as well, as ``tubefoot run -o`` does: whole or not at all.
        progress: called now and then with the pings finished and all pings; what it raises ends the run.

    Other Python threads run meanwhile. Ctrl-C ends the run, pings at hand unfinished; nothing half-written is left.

    Raises:
        InputError: the scene is wrong.
        UsageError: options contradict each other, or the output folder is somebody else's.
    """
    options = dict(threads=threads, arithmetic=arithmetic, binning=binning, sampling=sampling, rays=rays,
                   rays_per_beam=rays_per_beam, seed=seed, output=None if output is None else os.fspath(output))
    if tolerance is not None:
        options["tolerance"] = tolerance if isinstance(tolerance, str) else repr(float(tolerance))
    if output is not None and not os.fspath(output):
        raise UsageError("output: the name of a folder is empty")
    own = own_engine(engine)
    if own is None:
        options["engine"] = engine
    elif tolerance is not None:
        raise UsageError("a tolerance picks among the engines that are built in: leave out 'engine' or 'tolerance'")
    return _run(scene, options, own, progress)


def reference(scene: Scene, tolerance: float = 1e-9, *, arithmetic: Optional[str] = None,
              threads: Optional[int] = None, output: Optional[PathLike] = None,
              progress: Optional[Progress] = None) -> Result:
    """Certified echoes, as ``tubefoot run --reference``: ``energy`` and ``energy_bound`` of each sensor.

    Args:
        scene: the scene.
        tolerance: relative bound asked for, 1e-12 to 0.1; :attr:`Result.stats` tells of bins that miss it.
        arithmetic, threads, output, progress: as of :func:`run`.

    The true energy of every ping, beam and sample lies within ``energy`` +- ``energy_bound``, in J
    (docs/reference.md). Raises what :func:`run` raises.
    """
    options = dict(arithmetic=arithmetic, threads=threads, reference=True, tolerance=repr(float(tolerance)),
                   output=None if output is None else os.fspath(output))
    return _run(scene, options, None, progress)


def _run(scene: Scene, options: dict[str, Any], own: Optional[Engine], progress: Optional[Progress]) -> Result:
    _checked(options)
    with a_scene(scene)._explained():
        native = _native.run(scene._native, options, own.name if own else None, own.checked if own else None, progress)
    result = Result(native)
    warn(result.warnings)
    return result
