# SPDX-License-Identifier: GPL-3.0-or-later
"""Options of runs in the words of the program."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Optional

from ._errors import UsageError


def without_option(without: Sequence[str], output: Any) -> dict[str, str]:
    names = [without] if isinstance(without, str) else list(without)
    if not names:
        return {}
    if output is None:
        raise UsageError("'without' omits files of a result folder: add 'output', or leave out 'without'")
    return dict(without=",".join(names))


def gradient_option(gradient: Optional[Sequence[str]]) -> dict[str, str]:
    if isinstance(gradient, str):
        raise UsageError(f"gradient: expected a list of names, not the text {gradient!r}")
    return {"gradient": ",".join(gradient)} if gradient is not None and len(gradient) else {}
