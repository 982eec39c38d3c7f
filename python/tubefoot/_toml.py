# SPDX-License-Identifier: GPL-3.0-or-later
"""Conversion of a scene's keys to TOML, and of lines of this text back to keys."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ._arrays import unmasked
from ._errors import InputError, UsageError

_BARE = re.compile(r"[A-Za-z0-9_-]+\Z")


def _text(value: str) -> str:
    escapes = {"\\": "\\\\", '"': '\\"'}
    return '"' + "".join(escapes.get(c) or (c if c >= " " and c != "\x7f" else f"\\u{ord(c):04x}")
                         for c in value) + '"'


def _key(name: object, path: str) -> str:
    if not isinstance(name, str):
        raise UsageError(f"{path or 'the scene'}: keys must be texts, not {name!r}")
    return name if _BARE.match(name) else _text(name)


def _is_list(value: object) -> bool:
    return isinstance(value, Sequence) and not isinstance(value, (str, bytes))


def _value(value: Any, path: str) -> str:
    """Returns a value as one line of TOML."""
    if isinstance(value, (np.ndarray, np.generic)):
        value = unmasked(value, path).tolist()
    if isinstance(value, os.PathLike):
        value = os.fspath(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        if not -(2**63) <= value < 2**63:
            raise UsageError(f"{path}: {value} does not fit into 64 bits")
        return str(value)
    if isinstance(value, float):
        if math.isnan(value):
            return "nan"
        if math.isinf(value):
            return "inf" if value > 0 else "-inf"
        return repr(value) if "." in repr(value) or "e" in repr(value) else repr(value) + ".0"
    if isinstance(value, str):
        return _text(value)
    if _is_list(value):
        return "[" + ", ".join(_value(v, f"{path}[{i}]") for i, v in enumerate(value)) + "]"
    if isinstance(value, Mapping):
        pairs = (f"{_key(k, path)} = {_value(v, f'{path}.{k}')}" for k, v in value.items())
        return "{" + ", ".join(pairs) + "}"
    raise UsageError(f"{path}: a scene can contain numbers, texts, lists and tables, not {type(value).__name__}")


class Text:
    """The TOML text of a scene's keys with one key per line, and the path of the key in each line."""

    def __init__(self, keys: Mapping[str, Any]) -> None:
        self.lines: list[str] = []
        self.paths: list[str] = []
        self._table(keys, "", "")

    def _add(self, line: str, path: str) -> None:
        self.lines.append(line)
        self.paths.append(path)

    def _table(self, keys: Mapping[str, Any], header: str, path: str) -> None:
        def below(name: str) -> str:
            return f"{path}.{name}" if path else name

        later: list[tuple[str, str, Any]] = []
        for name, value in keys.items():
            toml = _key(name, path)
            if isinstance(value, Mapping) or (_is_list(value) and value
                                              and all(isinstance(v, Mapping) for v in value)):
                later.append((name, f"{header}.{toml}" if header else toml, value))
            else:
                self._add(f"{toml} = {_value(value, below(name))}", below(name))
        for name, inner, value in later:
            tables = [value] if isinstance(value, Mapping) else value
            for i, table in enumerate(tables):
                place = below(name) if isinstance(value, Mapping) else f"{below(name)}[{i}]"
                self._add(f"[{inner}]" if isinstance(value, Mapping) else f"[[{inner}]]", place)
                self._table(table, inner, place)

    def __str__(self) -> str:
        return "\n".join(self.lines) + "\n"

    def _path_of(self, line: int) -> str:
        return self.paths[line - 1] if 0 < line <= len(self.paths) else ""

    def placed(self, message: str, file: str) -> str:
        """Returns the message with paths of keys in place of lines of this text."""
        return re.sub(re.escape(file) + r":(\d+)(?::\d+)?", lambda m: self._path_of(int(m[1])) or m[0], message)

    def explained(self, error: InputError, file: str) -> InputError:
        """Returns the error with paths of keys in place of lines of this text."""
        message = self.placed(str(error), file)
        if error.file != file:
            return InputError(message, error.file, error.line, error.column)
        key = self._path_of(error.line)
        return InputError(message.replace(file + ": ", "", 1) if not key else message, file, 0, 0, key)
