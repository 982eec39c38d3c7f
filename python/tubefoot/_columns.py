# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables as columns by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ._words import meant


class Columns(Mapping[str, np.ndarray]):
    """Base class of tables: columns of equal length by name. Each derived class has a property ``rows``."""

    _columns: dict[str, np.ndarray]

    def __getitem__(self, column: str) -> np.ndarray:
        try:
            return self._columns[column]
        except KeyError:
            raise KeyError(f"no column {column!r}; the columns are {', '.join(self)}{meant(column, self)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        """Number of columns. The property ``rows`` is the number of rows."""
        return len(self._columns)
