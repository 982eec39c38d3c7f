# SPDX-License-Identifier: GPL-3.0-or-later
"""A table as columns by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ._words import meant


class Columns(Mapping[str, np.ndarray]):
    """Columns of equal length by name; what is inherited by tables, which say how many rows they have."""

    _columns: dict[str, np.ndarray]

    def __getitem__(self, column: str) -> np.ndarray:
        try:
            return self._columns[column]
        except KeyError:
            raise KeyError(f"no column {column!r}; there are {', '.join(self)}{meant(column, self)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        """Number of columns; rows are counted by ``rows``."""
        return len(self._columns)
