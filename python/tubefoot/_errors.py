# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes wrong, with the texts of the command line in Python's words, and what may not be meant."""

from __future__ import annotations

import operator
import sys
import warnings

from ._words import in_python as in_python  # the native module takes it from here, as the classes


class InputError(ValueError):
    """A scene, or a file that it names, is wrong.

    The text says where, what was expected and what to do, as ``tubefoot`` prints it, with arguments in place of
    options. Of a scene that was built in
    code, the place is the path of a key, such as ``sensors[0].beams``.

    Attributes:
        file: file name, or the scene's name in code.
        line: line, from 1; 0 where it is not known.
        column: column, from 1; 0 where it is not known.
        key: path of the key in the keys that the scene was made of; empty for scene files.
    """

    def __init__(self, message: str, file: str = "", line: int = 0, column: int = 0, key: str = "") -> None:
        super().__init__(message)
        self.file = file
        self.line = line
        self.column = column
        self.key = key

    def __reduce__(self) -> tuple:
        return (type(self), (str(self), self.file, self.line, self.column, self.key))


class UsageError(ValueError):
    """A function is asked for something that cannot be, as the command line says it, with arguments in place of
    options."""


def whole(name: str, value: object) -> int:
    """The number, if it is a whole one."""
    try:
        return operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        raise UsageError(f"{name}: expected a whole number, not {value!r}") from None


class SceneWarning(UserWarning):
    """A scene loads, but something in it may not be meant."""


class SilenceWarning(SceneWarning):
    """A sensor receives nothing: which, where, why, and what to do."""


def warn(message: str, is_silence: bool = False) -> None:
    """Tells whoever called the package."""
    level, frame = 1, sys._getframe()
    while frame is not None and frame.f_globals.get("__name__", "").startswith("tubefoot."):
        level, frame = level + 1, frame.f_back  # type: ignore[assignment]
    warnings.warn(message, SilenceWarning if is_silence else SceneWarning, stacklevel=level)
