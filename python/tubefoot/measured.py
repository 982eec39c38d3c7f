# SPDX-License-Identifier: GPL-3.0-or-later
"""Comparison of a measured multibeam water column with a simulated one.

    python3 -m tubefoot.measured MEASURED.nc SIMULATED.nc -o FOLDER

Both files are echo files (docs/output-files.md) with the same sensors, beams and range bins. The same estimators process
both, and each figure has a 95 % interval from a bootstrap over blocks of beams and pings. The levels of the measured file may
contain an unknown constant factor.

The comparison needs netCDF4 and SciPy, and its pictures need Matplotlib.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import Optional

from . import _measured_report as _report
from ._errors import InputError, UsageError
from ._measured_echoes import library as _library
from ._measured_study import COLUMNS, FITTED, QUANTITIES, Comparison, compare_measured

__all__ = ["COLUMNS", "FITTED", "QUANTITIES", "Comparison", "compare_measured", "main"]


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Runs the command with the given arguments, by default those of the process. Returns its exit code."""
    parser = argparse.ArgumentParser(prog="python3 -m tubefoot.measured",
                                     description="Compare a measured multibeam water column with a simulated one.")
    parser.add_argument("measured", metavar="MEASURED.nc", help="echo file of the measured data")
    parser.add_argument("simulated", metavar="SIMULATED.nc", help="echo file of the simulated data")
    parser.add_argument("-o", "--output", metavar="FOLDER", required=True, help="folder for the table, report and pictures")
    parser.add_argument("--sensor", metavar="NAME", help="compare only this sensor")
    parser.add_argument("--seed", type=int, default=1, help="seed of the bootstrap (default 1)")
    parser.add_argument("--resamples", type=int, default=400, help="resamples per figure (default 400)")
    parser.add_argument("--simulated-lambert-db", type=float, metavar="DB",
                        help="Lambert strength of the simulated seabed; fitted_material.csv then contains strengths, and seabed_table.csv is a table for a scene")
    options = parser.parse_args(arguments)
    try:
        _report.check_folder(options.output, (options.measured, options.simulated))
        _library("matplotlib", "the report")
        comparison = compare_measured(options.measured, options.simulated, sensor=options.sensor, seed=options.seed,
                                      resamples=options.resamples, simulated_lambert_db=options.simulated_lambert_db)
        _report.write(comparison, options.measured, options.simulated, options.output)
    except (InputError, UsageError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    print("\n".join(_report.summary(comparison)))
    print(f"wrote {options.output}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
