#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the checker in the folder tubefoot_suite without an installation: compare.py SUITE RESULTS. --help shows all options."""
import pathlib
import sys

sys.dont_write_bytecode = True  # a suite keeps its files
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
try:
    from tubefoot_suite.__main__ import main
except ImportError as error:
    sys.exit(f"compare.py: {error}: it needs the folder tubefoot_suite and NumPy (Debian: python3-numpy; or pip install numpy)")

if __name__ == "__main__":
    main()
