#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What pings cost, and how runs scale over ranks: study.py PROGRAM PAGE FIGURES KEPT [--rounds N] [--quick].

Measures (least of N interleaved rounds), simulates the dealing of 10^5 pings from what was measured, and writes
PAGE and figures. KEPT is a JSON file of the measurements: those that it has are not made again. --quick:
fewer points and shorter runs.
"""
import argparse
import json
import os
import pathlib
import tempfile

import cost
import pages
import ranks

MEASUREMENTS = {"cost": cost.measure, "ranks": ranks.measure, "lead": ranks.lead_cost}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("program", "page", "figures", "kept"):
        parser.add_argument(name, type=lambda word: pathlib.Path(word).resolve())
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--quick", action="store_true")
    asked = parser.parse_args()
    measured = json.loads(asked.kept.read_text()) if asked.kept.exists() else {}
    measured.setdefault("rounds", asked.rounds)
    measured.setdefault("cores", os.cpu_count())
    measured.setdefault("load_average", [os.getloadavg()[1]] * 2)
    for name, measure in MEASUREMENTS.items():
        if name in measured:
            continue
        with tempfile.TemporaryDirectory(prefix="tubefoot-scaling-") as folder:
            measured[name] = measure(asked.program, pathlib.Path(folder), asked.rounds, asked.quick)
        measured["load_average"][1] = os.getloadavg()[1]
        asked.kept.write_text(json.dumps(measured, default=list))
    asked.page.write_text(pages.page(measured, asked.figures))


if __name__ == "__main__":
    main()
