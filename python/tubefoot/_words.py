# SPDX-License-Identifier: GPL-3.0-or-later
"""Messages adapted to Python, suggestions of similar names, and former names."""

from __future__ import annotations

import functools
import inspect
import re
import warnings
from collections.abc import Callable, Iterable
from typing import ParamSpec, TypeVar

from . import _native

CHOICES = {"engine": ("tube", "ray"), "arithmetic": ("fixed", "filtered", "rational", "double"),
           "binning": ("exact", "spread", "centroid"),
           "sampling": ("stratified", "sobol", "adaptive", "regular", "random", "column")}

_FLAGS = ("any-scene", "confined")
FORMER_ARGUMENTS = {"truth": "labels", "shot": "transmission"}

P = ParamSpec("P")
R = TypeVar("R")


def in_python(text: str) -> str:
    """Returns a message of the command line with arguments in place of its options.

    For example, ``rays_per_beam`` replaces ``--rays-per-beam``, and ``engine="ray"`` replaces ``--engine ray``. Commands of
    GDAL between backticks do not change.
    """
    text = re.sub(r"\b[Aa] --reference\b|'run --reference'|--reference\b", "tubefoot.reference", text)
    for name, choices in CHOICES.items():
        text = re.sub(rf"--{name} ({'|'.join(choices)})\b", rf'{name}="\1"', text)

    def argument(match: re.Match[str]) -> str:
        option = match[1]
        if option is None:  # The match is a command of GDAL.
            return match[0]
        name = option.replace("-", "_")
        return f"{name}=True" if option in _FLAGS else name
    return re.sub(r"`(?:gdal|ogr)[^`]*`|(?<![\w-])--([a-z]+(?:-[a-z]+)*)", argument, text)


def meant(word: object, names: Iterable[str]) -> str:
    """Returns ``": did you mean 'camera'?"``, or an empty text if no name is similar to the word."""
    near = _native.nearest(word, [str(n) for n in names]) if isinstance(word, str) else ""
    return f": did you mean {near!r}?" if near else ""


def one_of(names: Iterable[str]) -> str:
    """Returns the names as a choice: ``'a', 'b' or 'c'``."""
    quoted = [repr(n) for n in names]
    return " or ".join([", ".join(quoted[:-1]), quoted[-1]] if len(quoted) > 1 else quoted)


def former(before: str, now: str) -> None:
    """Warns that a name of the module has changed."""
    warnings.warn(f"{before!r} is now {now!r}", DeprecationWarning, stacklevel=3)


def with_named_arguments(function: Callable[P, R]) -> Callable[P, R]:
    """Returns the function with support for former names of its arguments, which give a DeprecationWarning.

    The error about an unknown argument suggests the most similar name.
    """
    names = list(inspect.signature(function).parameters)

    @functools.wraps(function)
    def called(*args: P.args, **kwargs: P.kwargs) -> R:
        for name in list(kwargs):
            if FORMER_ARGUMENTS.get(name) in names:
                present = FORMER_ARGUMENTS[name]
                if present in kwargs:
                    raise TypeError(f"{function.__name__}() has {present!r} and its former name {name!r}: give one of them")
                warnings.warn(f"the argument {name!r} is now {present!r}", DeprecationWarning, stacklevel=2)
                kwargs[present] = kwargs.pop(name)
            elif name not in names:
                raise TypeError(f"{function.__name__}() has no argument {name!r}{meant(name, names)}")
        return function(*args, **kwargs)
    return called
