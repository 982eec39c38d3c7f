# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of array arguments: values must be finite and not hidden by a mask."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ._errors import UsageError


def _has_masks(values: Any) -> bool:
    return isinstance(values, np.ma.MaskedArray) or (isinstance(values, (list, tuple)) and any(map(_has_masks, values)))


def values_and_mask(values: Any) -> tuple[npt.NDArray[Any], npt.NDArray[np.bool_]]:
    """Returns the values as an array, and a boolean array that is true for each masked value.

    The values may be lists or tuples of masked arrays.
    """
    if isinstance(values, (list, tuple)) and _has_masks(values):
        parts = [values_and_mask(v) for v in values]
        return np.array([shown for shown, _ in parts]), np.array([hidden for _, hidden in parts])
    if isinstance(values, np.ma.MaskedArray):
        return np.ma.getdata(values), np.ma.getmaskarray(values)
    shown = np.asarray(values)
    return shown, np.zeros(shown.shape, bool)


def place_of(index: tuple[int, ...]) -> str:
    """Returns the position in an array as text: ``row 2, column 5``."""
    if len(index) == 2:
        return f"row {index[0]}, column {index[1]}"
    return f"element {', '.join(map(str, index))}" if index else "it"


def first_of(chosen: npt.NDArray[np.bool_]) -> tuple[int, ...]:
    """Returns the index of the first true element. At least one element must be true."""
    return tuple(int(k) for k in np.unravel_index(int(np.argmax(chosen)), chosen.shape))


def unmasked(values: Any, name: str) -> npt.NDArray[Any]:
    """Returns the values as an array.

    Raises:
        UsageError: a mask hides a value; the message names the first position.
    """
    shown, hidden = values_and_mask(values)
    if hidden.any():
        raise UsageError(f"{name}: {place_of(first_of(hidden))} is masked: expected values without a mask; "
                         "replace masked values by numbers, or leave them out")
    return shown


def finite(values: Any, name: str, dtype: type = float) -> npt.NDArray[Any]:
    """Returns the values as an array of the given type. All values must be finite.

    Raises:
        UsageError: a value is infinite or NaN, or a mask hides a value; the message names the first position.
    """
    array = np.asarray(unmasked(values, name), dtype)
    wrong = ~np.isfinite(array)
    if wrong.any():
        index = first_of(wrong)
        raise UsageError(f"{name}: expected finite numbers, but {place_of(index)} is {array[index]}")
    return array


def with_holes(values: Any, name: str) -> npt.NDArray[np.float64]:
    """Returns the values as a float64 array with NaN for each masked value.

    Raises:
        UsageError: a value is infinite; the message names the first position.
    """
    shown, hidden = values_and_mask(values)
    array = np.where(hidden, np.nan, np.asarray(shown, np.float64))
    wrong = np.isinf(array)
    if wrong.any():
        index = first_of(wrong)
        raise UsageError(f"{name}: {place_of(index)} is {array[index]}: expected metres, or nan for a hole")
    return array
