# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes, from files or built in code."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _native
from ._arrays import finite, first_of, place_of, unmasked, with_holes
from ._errors import InputError, UsageError
from ._gradient import Gradient, gradient_of
from ._toml import Text
from ._words import former, in_python, with_named_arguments

PathLike = Union[str, "os.PathLike[str]"]

_MESH_KEYS = {"vertices", "facets"}
_HEIGHT_KEYS = {"heights", "cell_m", "origin_m"}


class Scene:
    """The description of surfaces and sonars. tubefoot loads a scene when a computation needs it.

    :func:`load` and :meth:`from_dict` create scenes. A scene does not change, and results remain valid without the scene. Scenes
    can be pickled for other processes. The pickled data contain the names of the scene's files, but not their contents. The
    contents must be the same when the scene is unpickled.
    """

    def __init__(self, native: _native.Scene, text: Optional[Text] = None, meshes: Optional[list[tuple]] = None,
                 confined: bool = False) -> None:
        self._native = native
        self._text = text
        self._meshes = meshes or []
        self._confined = confined

    @classmethod
    @with_named_arguments
    def from_dict(cls, keys: Mapping[str, Any], base: PathLike = ".", name: str = "scene.dict") -> Scene:
        """Creates a scene from the keys of a scene file (docs/scene-keys.md).

        Args:
            keys: sections as dicts or lists of dicts, with the keys, units and defaults of scene files. Values may be
                NumPy numbers and arrays. In addition to the keys of scene files, entries of ``objects`` and ``terrain`` may
                have

                * ``vertices``: (n, 3) float, metres in the object's own axes (for a terrain: east, north, up in the
                  scene's frame), and ``facets``: (m, 3) int, indices of vertices. Both replace ``shape`` or ``kind`` and
                  its keys.
                * terrain only: ``heights``: (rows, columns) float, metres up, rows from south to north and columns
                  from west to east. A NaN or masked height is a hole. ``cell_m`` is the distance of neighbours in metres.
                  ``origin_m`` is (east, north) of ``heights[0, 0]`` in metres, by default (0, 0).
            base: folder to which file names are relative.
            name: name of the scene in messages. The chart uses this name without its extension.

        Raises:
            InputError: a key or a value is invalid; ``key`` is its path.
            UsageError: a value has a type that scenes do not support.
        """
        plain, meshes = _without_arrays(keys)
        text = Text(plain)
        file = os.path.join(os.fspath(base), name)
        with _explained(text, file):
            return cls(_native.parse_scene(str(text), file, meshes), text, meshes)

    @property
    def title(self) -> str:
        """Title of the scene; it may be empty."""
        return self._native.title

    @property
    def file(self) -> str:
        """Name of the scene file, or the name that the file of a scene in code would have."""
        return self._native.file

    @property
    def hash(self) -> str:
        """SHA-256 of the scene's text, of the files that it names and of its arrays, as 64 hexadecimal digits."""
        return self._native.hash

    @property
    def sensors(self) -> list[str]:
        """Names of the sensors."""
        return self._native.sensors

    @property
    def materials(self) -> list[str]:
        """Names of the materials. Materials of facets are indices into this list."""
        return self._native.materials

    @property
    def components(self) -> list[str]:
        """Names of terrains, then of objects. Components of facets are indices into this list."""
        return self._native.components

    def pings(self, sensor: str) -> int:
        """Returns the number of pings of a sensor. The call loads the scene."""
        with self._explained():
            return self._native.pings(sensor)

    def transmissions(self, sensor: str) -> int:
        """Returns the number of transmissions per ping of a sensor. The call loads the scene."""
        with self._explained():
            return self._native.transmissions(sensor)

    def gradient_parameters(self) -> dict[str, tuple[str, str]]:
        """Returns unit and meaning of each parameter for ``gradient`` of :func:`run`, by name (docs/gradients.md)."""
        return {name: (units, meaning) for name, units, meaning in _native.gradient_parameters(self._native)}

    @with_named_arguments
    def gradient(self, weights: Union[npt.ArrayLike, Mapping[str, npt.ArrayLike]], *, threads: Optional[int] = None,
                 progress: Optional[Callable[[int, int], Any]] = None) -> Gradient:
        """Computes the derivatives of the sum of weight times energy by all vertices, poses, materials and water.

        The computation is in reverse mode: its time does not depend on the number of parameters.

        Args:
            weights: derivatives of a value by the energies, as an array of shape (pings, beams, range bins) for a scene
                with one sensor, or such arrays by sensor. Sensors without an array have the weight 0.
            threads, progress: as for :func:`run`.

        Raises:
            UsageError: weights of the wrong shape or not finite, or a feature without derivatives.
        """
        return gradient_of(self, weights, threads, progress)

    def shots(self, sensor: str) -> int:
        """The former name of :meth:`transmissions`, with a DeprecationWarning."""
        former("shots", "transmissions")
        return self.transmissions(sensor)

    def warnings(self) -> list[str]:
        """Returns the warnings of ``tubefoot check`` about probable mistakes.

        Examples are sensors that will receive nothing, objects that are buried or in the air, and files that a run omits.
        The call loads the scene and examines a few pings.
        """
        with self._explained():
            return [self._said(text) for text, _ in self._native.warnings()]

    def to_toml(self) -> str:
        """Returns the text of the scene file.

        For a scene with arrays, the text contains the name of each array in its place.
        """
        if self._text is not None:
            return str(self._text)
        with open(self.file, encoding="utf-8") as file:
            return file.read()

    def __repr__(self) -> str:
        return f"<tubefoot.Scene {self.file!r}: {', '.join(self.sensors)}>"

    def __copy__(self) -> Scene:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Scene:
        return self

    def __reduce__(self) -> tuple:
        file = os.path.normpath(_native.absolute_path(self.file))
        return _again, (self._text, self._meshes, file, self._confined, self.hash)

    def _explained(self) -> Any:
        return _explained(self._text, self.file)

    def _said(self, warning: str) -> str:
        return in_python(warning if self._text is None else self._text.placed(warning, self.file))


def _again(text: Optional[Text], meshes: list[tuple], file: str, confined: bool, hash: str) -> Scene:
    if text is None:
        scene = load(file, confined=confined)
    else:
        with _explained(text, file):
            scene = Scene(_native.parse_scene(str(text), file, meshes), text, meshes)
    if scene.hash != hash:
        raise InputError(f"{file}: the scene, or a file that it names, has changed since it was pickled", file)
    return scene


@with_named_arguments
def load(file: PathLike, *, confined: bool = False) -> Scene:
    """Reads the scene of a scene file (TOML, docs/scene-keys.md).

    Args:
        confined: reads no file outside the folder of the scene file, after following links. Otherwise tubefoot reads such
            files, and ``Scene.warnings()`` lists them.

    Raises:
        InputError: the file is missing or invalid; ``file``, ``line`` and ``column`` give the location.
    """
    return Scene(_native.read_scene(os.fspath(file), confined), confined=confined)


def a_scene(scene: Union[Scene, PathLike]) -> Scene:
    """Returns the scene itself, or the scene of the file with this name."""
    if isinstance(scene, Scene):
        return scene
    if isinstance(scene, (str, os.PathLike)):
        return load(scene)
    raise TypeError(f"expected a tubefoot.Scene or the name of a scene file, not {type(scene).__name__}")


@contextmanager
def _explained(text: Optional[Text], file: str) -> Iterator[None]:
    try:
        yield
    except InputError as error:
        if text is None:
            raise
        raise text.explained(error, file) from None


def _without_arrays(keys: Mapping[str, Any]) -> tuple[dict[str, Any], list[tuple]]:
    plain = dict(keys)
    meshes: list[tuple] = []
    for section, is_terrain in (("terrain", True), ("objects", False)):
        if section not in plain:
            continue
        entries = plain[section]
        single = isinstance(entries, Mapping)
        replaced = []
        for i, entry in enumerate([entries] if single else list(entries)):
            path = section if single else f"{section}[{i}]"
            if isinstance(entry, Mapping) and (_MESH_KEYS | {"heights"}) & set(entry):
                mesh, entry = _mesh_of(entry, is_terrain, path)
                meshes.append((is_terrain, i, *mesh))
            replaced.append(entry)
        plain[section] = replaced[0] if single else replaced
    return plain, meshes


def _mesh_of(entry: Mapping[str, Any], is_terrain: bool, path: str) -> tuple[tuple, dict[str, Any]]:
    rest = dict(entry)
    if "heights" in rest:
        if not is_terrain or _MESH_KEYS & set(rest):
            raise UsageError(f"{path}: 'heights' needs a terrain without 'vertices' and 'facets'")
        if "cell_m" not in rest:
            raise UsageError(f"{path}: 'heights' needs 'cell_m', the distance between neighbours in metres")
        mesh = _heights(rest, path)
        own = _HEIGHT_KEYS
    else:
        if not _MESH_KEYS <= set(rest):
            raise UsageError(f"{path}: 'vertices' and 'facets' need each other: give both")
        mesh = (_array(rest["vertices"], path + ".vertices", np.float64),
                _array(rest["facets"], path + ".facets", np.int64))
        own = _MESH_KEYS
    if mesh[1].size and (mesh[1].min() < 0 or mesh[1].max() >= len(mesh[0])):
        raise UsageError(f"{path}.facets: vertex indices must be 0 to {len(mesh[0]) - 1}, "
                         f"not {mesh[1].min()} to {mesh[1].max()}")
    for key in own:
        rest.pop(key, None)
    kind = "kind" if is_terrain else "shape"
    if kind in rest:
        raise UsageError(f"{path}: '{kind}' and arrays exclude each other: leave out one of them")
    rest.update({"kind": "flat", "width_m": 1.0, "length_m": 1.0} if is_terrain else {"shape": "box"})
    return (mesh[0], mesh[1].astype(np.uint32)), rest


def _array(values: npt.ArrayLike, path: str, kind: type) -> np.ndarray:
    array = unmasked(values, path)
    if array.ndim != 2 or array.shape[1] != 3:
        raise UsageError(f"{path}: expected an array of shape (n, 3), not {array.shape}")
    if kind is np.int64 and array.size and not np.issubdtype(array.dtype, np.integer):
        raise UsageError(f"{path}: expected integers, not {array.dtype}")
    return np.ascontiguousarray(finite(array, path) if kind is np.float64 else array, kind)


def _heights(entry: Mapping[str, Any], path: str) -> tuple[np.ndarray, np.ndarray]:
    heights = with_holes(entry["heights"], path + ".heights")
    if heights.ndim != 2 or min(heights.shape) < 2:
        raise UsageError(f"{path}.heights: expected an array of at least (2, 2), not {heights.shape}")
    cell = float(entry["cell_m"])
    if not cell > 0 or not np.isfinite(cell):
        raise UsageError(f"{path}.cell_m: expected metres above 0, not {cell}")
    origin = finite(entry.get("origin_m", (0, 0)), path + ".origin_m")
    if origin.shape != (2,):
        raise UsageError(f"{path}.origin_m: expected (east, north), not an array of shape {origin.shape}")
    east, north = origin
    rows, columns = heights.shape
    y, x = np.mgrid[0:rows, 0:columns]
    vertices = np.stack([east + cell * x, north + cell * y, heights], axis=-1).reshape(-1, 3)
    south_west = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    south_east, north_west, north_east = south_west + 1, south_west + columns, south_west + columns + 1
    facets = np.stack([south_west, south_east, north_east, south_west, north_east, north_west], -1).reshape(-1, 3)
    known = np.isfinite(vertices[:, 2])
    facets = facets[known[facets].all(axis=1)]
    if not len(facets):
        holes = np.isnan(heights)
        raise UsageError(f"{path}.heights: {holes.sum()} of {holes.size} heights are holes, the first in "
                         f"{place_of(first_of(holes))}: expected adjacent heights that form a facet; replace holes by metres")
    vertices[~known] = 0  # These vertices belong to no facet.
    return vertices, facets
