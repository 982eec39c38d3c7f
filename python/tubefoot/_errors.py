# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors and warnings of the package. Their messages are those of the command line, adapted to Python."""

from __future__ import annotations

import operator
import sys
import warnings

from ._words import in_python as in_python  # The native module imports it and the classes from here.


class InputError(ValueError):
    """A scene, or a file that the scene names, is invalid.

    The message gives the location, the expected value and a remedy. It is the message of ``tubefoot``, with arguments in
    place of options. For a scene that was built in code, the location is the path of a key, such as ``sensors[0].beams``.

    Attributes:
        file: file name, or the name of a scene in code.
        line: line, counted from 1; 0 if it is unknown.
        column: column, counted from 1; 0 if it is unknown.
        key: path of the key in the keys of a scene in code; empty for scene files.
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
    """A request is invalid, for example an argument out of range or a ping that does not exist.

    The message is that of the command line, with arguments in place of options.
    """


def whole(name: str, value: object) -> int:
    """Returns the value as an integer.

    Raises:
        UsageError: the value is not a whole number.
    """
    try:
        return operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        raise UsageError(f"{name}: expected a whole number, not {value!r}") from None


class SceneWarning(UserWarning):
    """The scene loads, but a part of it is probably a mistake."""


class SilenceWarning(SceneWarning):
    """A sensor receives nothing. The message gives the sensor, the location, the reason and a remedy."""


def warn(message: str, is_silence: bool = False) -> None:
    """Issues a warning at the line of the first caller outside the package."""
    level, frame = 1, sys._getframe()
    while frame is not None and frame.f_globals.get("__name__", "").startswith("tubefoot."):
        level, frame = level + 1, frame.f_back  # type: ignore[assignment]
    warnings.warn(message, SilenceWarning if is_silence else SceneWarning, stacklevel=level)
