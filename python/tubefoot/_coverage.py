# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a scene's facets that pings see, the number of pings that see them, and the parts that no ping sees."""

from __future__ import annotations

import os
from typing import Optional, Union

import numpy as np

from . import _native
from ._columns import Columns
from ._errors import UsageError
from ._footprints import Numbers, as_text
from ._picture import Picture, as_html
from ._scene import PathLike, Scene, a_scene
from ._words import with_named_arguments


class Coverage(Columns):
    """Visible parts of the facets in the sectors of the pings, as columns with one element per facet.

    For example, ``coverage["seen_m2"]`` is the area that at least one ping sees. Names and units are those of the table
    ``facets`` in docs/footprints.md. Areas are in m², and shares of the facet's area are from 0 to 1. ``facet``,
    ``most_pings`` and ``mean_pings`` are numbers. Arrays are read-only. ``N`` is the number of facets. ``D`` is the number
    of pairs of a facet and a number of pings.
    """

    def __init__(self, native: _native.Coverage) -> None:
        self._native = native
        self._columns = native.columns()
        self._depths = native.depths()

    @property
    def rows(self) -> int:
        """Number of facets in the sector of at least one ping, N."""
        return len(self._columns["facet"])

    @property
    def facets_of_scene(self) -> int:
        """Number of all facets of the scene."""
        return self._native.facets_of_scene

    @property
    def pings(self) -> list[tuple[str, int]]:
        """Pings that this coverage includes: sensor and number."""
        return self._native.pings

    @property
    def component(self) -> np.ndarray:
        """(N,) text, a copy: name of the terrain or object of each facet."""
        return np.array(self._native.component_names, dtype=object)[self["component_index"]]

    @property
    def material(self) -> np.ndarray:
        """(N,) text, a copy: name of the material of each facet."""
        return np.array(self._native.material_names, dtype=object)[self["material_index"]]

    @property
    def area_by_pings_m2(self) -> dict[int, float]:
        """Area in m² by the number of pings that see it. The key 0 gives the area of these facets that no ping sees."""
        return self._native.by_pings

    @property
    def depth_facet(self) -> np.ndarray:
        """(D,) uint32: facet of each pair."""
        return self._depths["facet"]

    @property
    def depth_pings(self) -> np.ndarray:
        """(D,) uint32: number of pings of each pair."""
        return self._depths["pings"]

    @property
    def depth_share(self) -> np.ndarray:
        """(D,) float64: share of the facet's area that this number of pings sees. The shares of a facet add up to 1."""
        return self._depths["share"]

    def picture(self) -> Picture:
        """Draws the plan of ``tubefoot coverage``: the number of pings that see each part, north up.

        Raises:
            UsageError: no facet lies in the sector of a ping.
        """
        return Picture(self._native.picture())

    def _repr_html_(self) -> str:
        return as_html("Coverage", repr(self), self.picture() if self.rows else None)

    def __repr__(self) -> str:
        return f"<tubefoot.Coverage {self._native.title!r}: {self.rows} of {self.facets_of_scene} facets in a sector>"


@with_named_arguments
def coverage(scene: Union[Scene, PathLike], sensor: Optional[str] = None, pings: Optional[Numbers] = None, *,
             output: Optional[PathLike] = None) -> Coverage:
    """Measures the parts of the scene's facets that pings see, as ``tubefoot coverage`` does (docs/footprints.md).

    Args:
        scene: the scene, or the name of its file.
        sensor: name of the only sensor to include; by default all sensors.
        pings: a ping, a ``range`` of step 1, or text as in the command: ``"2:5"`` (both included); by default all.
        output: name of an output file that ends with ``.gpkg`` or ``.csv``, or of a folder. Files appear only when
            complete.

    Other Python threads continue during the computation. Ctrl-C stops it.

    Raises:
        InputError: the scene is invalid.
        UsageError: the sensor or ping does not exist, or the output cannot be written.
    """
    if output is not None and not os.fspath(output):
        raise UsageError("output: the name is empty")
    known = a_scene(scene)
    with known._explained():
        chosen = ":" if pings is None else as_text("pings", pings)
        return Coverage(_native.coverage(known._native, sensor, chosen, "" if output is None else os.fspath(output)))
