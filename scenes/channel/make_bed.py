#!/usr/bin/env python3
"""Writes bed.asc, the seabed of a channel for scene.toml: 160 m x 96 m in cells of 1 m, 14 m to 22 m deep.

  python3 scenes/channel/make_bed.py

The seabed has a trough along the track with sloping sides, a ledge to port and three dunes across the track.
The script needs only the standard library of Python, and the repository contains its output.
"""
import math
import pathlib

COLUMNS, ROWS, CELL_M = 161, 97, 1.0


def depth_m(east, north):
    trough = 14 + 7.5 / (1 + (abs(east - 5 * math.sin(north / 30)) / 32) ** 4)
    ledge = 1.6 / (1 + math.exp(-(east + 24 + 3 * math.cos(north / 9)) / 0.8))
    dunes = 0.5 * math.cos(2 * math.pi * (north + 0.2 * east) / 31) * math.exp(-((east - 12) / 20) ** 2)
    return trough + ledge - 1.6 + dunes


def main():
    west, south = -COLUMNS // 2 + 1, -ROWS // 2 + 1
    lines = [f"ncols {COLUMNS}", f"nrows {ROWS}", f"xllcenter {west * CELL_M}", f"yllcenter {south * CELL_M}",
             f"cellsize {CELL_M}"]
    for row in reversed(range(ROWS)):
        north = (south + row) * CELL_M
        lines.append(" ".join(f"{-depth_m((west + column) * CELL_M, north):.2f}" for column in range(COLUMNS)))
    pathlib.Path(__file__).with_name("bed.asc").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
