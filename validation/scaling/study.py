#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What pings cost, and how runs scale over ranks: study.py PROGRAM PAGE FIGURES KEPT [ROUNDS].

Measures (least of ROUNDS interleaved rounds), simulates the dealing of 10^5 pings from what was measured, and
writes PAGE and figures. KEPT is a JSON file of the measurements: those that it has are not made again.
"""
import json
import pathlib
import sys
import tempfile

import cost
import pages
import ranks

MEASUREMENTS = {"cost": cost.measure, "ranks": ranks.measure, "lead": ranks.lead_cost}


def main():
    program, page, figures, kept = (pathlib.Path(word).resolve() for word in sys.argv[1:5])
    rounds = int(sys.argv[5]) if len(sys.argv) > 5 else 3
    measured = json.loads(kept.read_text()) if kept.exists() else {}
    for name, measure in MEASUREMENTS.items():
        if name in measured:
            continue
        with tempfile.TemporaryDirectory(prefix="tubefoot-scaling-") as folder:
            measured[name] = measure(program, pathlib.Path(folder), rounds)
        kept.write_text(json.dumps(measured, default=list))
    page.write_text(pages.page(measured, figures))


if __name__ == "__main__":
    main()
