# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures, as the program draws them."""

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
    """A picture that the program would write, with its labels and scale. Notebooks show it; ``np.asarray(picture)``,
    and so ``plt.imshow(picture)``, take its pixels."""

    def __init__(self, native: _native.Picture) -> None:
        self._native = native
        self._pixels: Optional[np.ndarray] = None

    @property
    def title(self) -> str:
        """What it shows, as its file's description says."""
        return self._native.title

    @property
    def pixels(self) -> np.ndarray:
        """(height, width, 3) uint8: red, green and blue (sRGB), rows from the top. Read-only."""
        if self._pixels is None:
            self._pixels = self._native.pixels()
            self._pixels.flags.writeable = False
        return self._pixels

    def save(self, file: PathLike) -> None:
        """Writes a PNG, as the program does: whole or not at all.

        Raises:
            UsageError: the name does not end with ``.png``, or the place cannot be written.
        """
        if os.path.splitext(os.fspath(file))[1] != ".png":
            raise UsageError(f"{os.fspath(file)!r}: a picture is a .png")
        self._native.write(os.fspath(file))

    def __array__(self, dtype: npt.DTypeLike = None, copy: Optional[bool] = None) -> np.ndarray:
        return np.array(self.pixels, dtype) if dtype is not None or copy else self.pixels

    def _repr_png_(self) -> bytes:
        return self._native.png()

    def __repr__(self) -> str:
        height, width, _ = self.pixels.shape
        return f"<tubefoot.Picture {self.title!r}: {width} x {height} pixels>"


def as_html(heading: str, facts: str, picture: Optional[Picture]) -> str:
    """A heading, a line and a picture for notebooks."""
    page = f"<div><b>{html.escape(heading)}</b> {html.escape(facts)}"
    if picture is not None:
        data = base64.b64encode(picture._repr_png_()).decode()
        page += f'<br><img alt="{html.escape(picture.title)}" style="max-width: 100%" src="data:image/png;base64,{data}">'
    return page + "</div>"


def plural(count: int, what: str) -> str:
    """``3 pings``."""
    return f"{count} {what}" + ("" if count == 1 else "s")


def drawn(*arguments: Any) -> Picture:
    """Of what the native module draws."""
    return Picture(_native.picture(*arguments))
