#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the published boundary-element results of the BeTSSi models as tables: make_tables.py FOLDER [-o FOLDER]

FOLDER contains the source code of ASIGA (https://github.com/Zetison/ASIGA). The tables m3.csv, m5a.csv and m5b.csv contain
the monostatic target strength of rigid bodies at each published frequency. The aspects are 0 to 180 degrees in steps of 0.2
degrees. At 10 kHz, ASIGA has no monostatic result for M5B. Its bistatic result for a source at 60 degrees contains one
monostatic value, at 60 degrees."""
import argparse
import pathlib
import re

RESULTS = "miscellaneous/refSolutions"
# model: (frequency in Hz, file, the only aspect to read, or None for all)
SOURCES = {
    "m3": ((1000, "M3_SHBC_MS_f1000.txt", None),),
    "m5a": tuple((1000 * khz, f"M5A_HWBC_MS_AS_E0_F{khz}.txt", None) for khz in (1, 3, 10)),
    "m5b": (*((1000 * khz, f"M5B_HWBC_MS_AS_E0_F{khz}.txt", None) for khz in (1, 3)),
            (10000, "M5B_HWBC_BI_A60_E0_F10.txt", 60)),
}


def published(file):
    """Target strength in dB by tenths of a degree."""
    values = {}
    for line in file.read_text().splitlines():
        pair = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*,?\s+(-?\d+\.\d+)\s*", line)
        if pair:
            values[round(10 * float(pair[1]))] = float(pair[2])
    if sorted(values) != list(range(3601)):
        raise SystemExit(f"{file}: expected a target strength for each tenth of a degree from 0 to 360: fetch the file again")
    return values


def table(folder, model):
    rows = []
    for hertz, name, only in SOURCES[model]:
        values = published(folder / RESULTS / name)
        for tenths in range(0, 1801, 2) if only is None else (10 * only,):
            rows.append((tenths, hertz, values[tenths]))
    lines = [f"# BeTSSi model {model.upper()}, rigid, boundary elements (ASIGA, GPL-3.0); written by make_tables.py",
             "azimuth_deg,frequency_hz,target_strength_db"]
    lines += [f"{tenths / 10:g},{hertz},{db:.4f}" for tenths, hertz, db in sorted(rows)]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="folder with the source code of ASIGA")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent,
                        help="folder of the tables (default: the folder of this script)")
    options = parser.parse_args()
    missing = [name for sources in SOURCES.values() for _, name, _ in sources
               if not (options.folder / RESULTS / name).is_file()]
    if missing:
        parser.error(f"{options.folder}: {RESULTS}/{missing[0]} is missing: expected the source code of ASIGA")
    options.output.mkdir(parents=True, exist_ok=True)
    for model in SOURCES:
        (options.output / f"{model}.csv").write_text(table(options.folder, model))


if __name__ == "__main__":
    main()
