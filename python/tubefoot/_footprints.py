# SPDX-License-Identifier: GPL-3.0-or-later
"""Footprints of pings as columns."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Optional, Union

import numpy as np

from . import _native
from ._columns import Columns
from ._errors import UsageError, whole
from ._result import Progress
from ._scene import PathLike, Scene, a_scene
from ._words import former, with_named_arguments

if TYPE_CHECKING:
    import geopandas

Numbers = Union[int, str, range, Iterable[int]]

FORMER_COLUMNS = {"shot": "transmission", "mirrors_out": "tx_reflections", "mirrors_home": "rx_reflections"}


class Footprints(Columns):
    """Footprints of a sensor's pings, as columns with one element per footprint: ``footprints["area_m2"]``.

    Names are those of docs/footprints.md, and :attr:`units` gives the units. Arrays are read-only and share the memory of
    the table. ``N`` is the number of footprints, ``P`` the number of their convex pieces, and ``C`` the number of corners
    of these pieces. Corners are in the scene's local frame.
    """

    def __init__(self, native: _native.Footprints) -> None:
        self._native = native
        columns = native.columns()
        self._columns = {name: values for name, _, _, values in columns}
        self._units = {name: units for name, units, _, _ in columns}
        self._meanings = {name: long_name for name, _, long_name, _ in columns}

    def __getitem__(self, column: str) -> np.ndarray:
        """Returns a column. Former names of columns give a DeprecationWarning."""
        if column in FORMER_COLUMNS:
            former(column, FORMER_COLUMNS[column])
        return super().__getitem__(FORMER_COLUMNS.get(column, column))

    @property
    def rows(self) -> int:
        """Number of footprints, N."""
        return len(self._columns["ping"])

    @property
    def sensor(self) -> str:
        """Name of the sensor."""
        return self._native.sensor

    @property
    def units(self) -> dict[str, str]:
        """Unit of each column; ``"1"`` for indices and counts."""
        return dict(self._units)

    @property
    def meanings(self) -> dict[str, str]:
        """Meaning of each column."""
        return dict(self._meanings)

    @property
    def component(self) -> np.ndarray:
        """(N,) text, a copy: name of the terrain or object of each footprint."""
        return np.array(self._native.component_names, dtype=object)[self["component_index"]]

    @property
    def material(self) -> np.ndarray:
        """(N,) text, a copy: name of the material of each footprint."""
        return np.array(self._native.material_names, dtype=object)[self["material_index"]]

    @property
    def first_piece(self) -> np.ndarray:
        """(N + 1,) uint64: footprint i has the pieces ``first_piece[i]`` to ``first_piece[i + 1]`` (excluded)."""
        return self._native.first_piece

    @property
    def first_corner(self) -> np.ndarray:
        """(P + 1,) uint64: piece p has the corners ``first_corner[p]`` to ``first_corner[p + 1]`` (excluded)."""
        return self._native.first_corner

    @property
    def corners_m(self) -> np.ndarray:
        """(C, 3) float64: corners in m, east, north, up; counter-clockwise as seen from the sensor."""
        return self._native.corners_m

    @property
    def first_occluder(self) -> np.ndarray:
        """(N + 1,) uint64: footprint i has the occluders ``first_occluder[i]`` to ``first_occluder[i + 1]`` (excluded)."""
        return self._native.first_occluder

    @property
    def occluders(self) -> np.ndarray:
        """(any,) uint32: facets that hide a part of the footprints' facets."""
        return self._native.occluders

    def polygons_m(self, row: int) -> list[np.ndarray]:
        """Returns the pieces of a footprint: arrays (corners, 3) float64, east, north, up in m."""
        pieces = range(int(self.first_piece[row]), int(self.first_piece[row + 1]))
        return [self.corners_m[int(self.first_corner[p]):int(self.first_corner[p + 1])] for p in pieces]

    def to_geopandas(self) -> geopandas.GeoDataFrame:
        """Returns columns and multipolygons in the scene's CRS, or in local metres if the scene has no CRS.

        The method needs GeoPandas (Debian: python3-geopandas). The content is that of the file of ``tubefoot footprints``.
        """
        import geopandas
        from shapely.geometry import MultiPolygon, Polygon

        corners = self._native.map_corners
        pieces = [Polygon(corners[int(a):int(b)]) for a, b in zip(self.first_corner[:-1], self.first_corner[1:])]
        shapes = [MultiPolygon(pieces[int(a):int(b)]) for a, b in zip(self.first_piece[:-1], self.first_piece[1:])]
        columns = {**self._columns, "component": self.component, "material": self.material,
                   "pieces": np.diff(self.first_piece.astype(np.int64))}
        return geopandas.GeoDataFrame(columns, geometry=shapes, crs=self._native.crs_wkt or None)

    def __repr__(self) -> str:
        return f"<tubefoot.Footprints of {self.sensor!r}: {self.rows}>"


@with_named_arguments
def footprints(scene: Union[Scene, PathLike], sensor: str, pings: Numbers = 0, beams: Optional[Numbers] = None, *,
               progress: Optional[Progress] = None) -> Footprints:
    """Computes the visible polygons of a sensor's pings, with their measures and energies (docs/footprints.md).

    Args:
        scene: the scene, or the name of its file.
        sensor: name of the sensor.
        pings: a ping, a ``range`` of step 1, or text as in the command: ``"3"``, ``"2:5"`` (both included), ``":"``.
        beams: a beam, several beams, or text as in the command: ``"2:5,9"``; by default all.
        progress: function that is called occasionally with the number of finished pings and of all pings. An exception
            from this function stops the computation.

    Raises:
        InputError: the scene is invalid.
        UsageError: the sensor, ping or beam does not exist.
    """
    known = a_scene(scene)
    with known._explained():
        chosen = as_text("pings", pings), "" if beams is None else as_text("beams", beams)
        return Footprints(_native.footprints(known._native, sensor, *chosen, progress))


def as_text(name: str, numbers: Numbers) -> str:
    """Returns the numbers as the command line expects them.

    Raises:
        UsageError: there is no number, or one is not a whole number.
    """
    if isinstance(numbers, str):
        return numbers
    if isinstance(numbers, range) and numbers.step == 1 and len(numbers) > 0:
        return f"{numbers[0]}:{numbers[-1]}"
    if isinstance(numbers, Iterable):
        text = ",".join(str(whole(name, n)) for n in numbers)
        if not text:
            raise UsageError(f"{name}: the selection is empty")
        return text
    return str(whole(name, numbers))
