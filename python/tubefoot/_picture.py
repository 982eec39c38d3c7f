# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures that the program draws."""

from __future__ import annotations

import base64
import html
import os
from typing import Any, Optional

import numpy as np
import numpy.typing as npt

from . import _native
from ._errors import UsageError
from ._scene import PathLike


class Picture:
    """A picture of the program, with labels and a scale.

    Notebooks display the picture. ``np.asarray(picture)`` returns its pixels, and ``plt.imshow(picture)`` draws them.
    """

    def __init__(self, native: _native.Picture) -> None:
        self._native = native
        self._pixels: Optional[np.ndarray] = None

    @property
    def title(self) -> str:
        """Title of the picture, as in the description in its file."""
        return self._native.title

    @property
    def pixels(self) -> np.ndarray:
        """(height, width, 3) uint8: red, green and blue (sRGB), rows from the top. The array is read-only."""
        if self._pixels is None:
            self._pixels = self._native.pixels()
            self._pixels.flags.writeable = False
        return self._pixels

    def save(self, file: PathLike) -> None:
        """Writes a PNG file as the program does. The file appears only when complete.

        Raises:
            UsageError: the name does not end with ``.png``, or the file cannot be written.
        """
        if os.path.splitext(os.fspath(file))[1] != ".png":
            raise UsageError(f"{os.fspath(file)!r}: the name of a picture must end in .png")
        self._native.write(os.fspath(file))

    def __array__(self, dtype: npt.DTypeLike = None, copy: Optional[bool] = None) -> np.ndarray:
        return np.array(self.pixels, dtype) if dtype is not None or copy else self.pixels

    def _repr_png_(self) -> bytes:
        return self._native.png()

    def __repr__(self) -> str:
        height, width, _ = self.pixels.shape
        return f"<tubefoot.Picture {self.title!r}: {width} x {height} pixels>"


def as_html(heading: str, facts: str, picture: Optional[Picture]) -> str:
    """Returns a heading, a line of text and a picture as HTML for notebooks."""
    page = f"<div><b>{html.escape(heading)}</b> {html.escape(facts)}"
    if picture is not None:
        data = base64.b64encode(picture._repr_png_()).decode()
        page += f'<br><img alt="{html.escape(picture.title)}" style="max-width: 100%" src="data:image/png;base64,{data}">'
    return page + "</div>"


def plural(count: int, what: str) -> str:
    """Returns a count and its noun, for example ``3 pings``."""
    return f"{count} {what}" + ("" if count == 1 else "s")


def drawn(*arguments: Any) -> Picture:
    """Returns the picture that the native module draws."""
    return Picture(_native.picture(*arguments))
