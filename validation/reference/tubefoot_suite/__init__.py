# SPDX-License-Identifier: GPL-3.0-or-later
"""Checker of the tubefoot benchmark suite. It needs NumPy, and netCDF4 for netCDF files only."""
from .echoes import Refused, errors_of
from .judge import compare_suite

__version__ = "3.0"
__all__ = ["Refused", "compare_suite", "errors_of"]
