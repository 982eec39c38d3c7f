#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads exact footprints of both versions of the format, as the figures do: exact_footprints_test.py"""
import importlib.util
import pathlib
import sys
import tempfile

sys.dont_write_bytecode = True

DRAWINGS = pathlib.Path(__file__).resolve().parents[2] / "docs/figures/geometry_drawings.py"
sys.path.insert(0, str(DRAWINGS.parent))
TEXT = """# tubefoot exact footprints
sensor camera
{keyword} 0 0 1/2 3 -4
tube 0 0 1 0 0 1 1 1 1 -1 1 1 -1 -1 1 1 -1
piece 7 3 1 2 3 4 5 6 7 8 9
open 3 1 0 0 1 1 0 1 0 1
"""


def main():
    spec = importlib.util.spec_from_file_location("geometry_drawings", DRAWINGS)
    draw = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(draw)
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "exact.txt"
        for keyword in ("transmission", "shot"):  # version 2, version 1
            file.write_text(TEXT.format(keyword=keyword))
            read = draw.Transmission(file)
            assert tuple(map(float, read.apex)) == (0.5, 3, -4), keyword
            [tube] = read.tubes
            assert len(tube["rays"]) == 4 and len(tube["pieces"]) == 1 and len(tube["open"]) == 1, keyword


main()
