#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes GeoTIFF files and a virtual raster of them: terrain/*.tif and terrain/terrain.vrt in the folder of this script.

  make_terrain.py                        7073 x 7073 pixels of 0.5 m, 200 MB: a seabed of 10^8 facets
  make_terrain.py --side 300 -o folder   a small seabed for a test

The seabed undulates about 40 m below the level of the origin, with ripples and a few gullies. Its heights do not depend
on the size of the GeoTIFF files. The centre of the raster is at easting 500000, northing 5300000 in EPSG:32630. The
script needs NumPy."""
import argparse
import pathlib
import struct

import numpy

CELL = 0.5
BLOCK = 256


def heights(east, north):
    """Returns the heights of a grid of positions: a sum of waves of 900 m to 3 m length, each with its own direction."""
    east, north = east[None, :], north[:, None]
    sum_ = numpy.full((north.size, east.size), -40.0)
    for k in range(10):
        length, turn = 900 * 0.53**k, 2.4 * k + 0.3
        phase = 2 * numpy.pi * (numpy.cos(turn) * east + numpy.sin(turn) * north) / length
        sum_ += 0.004 * length**0.95 * numpy.sin(phase + 1.3 * k + 0.4 * numpy.sin(phase / 7))
    return sum_.astype("<f4")


def write_geotiff(file, pixels, west, north):
    """Writes uncompressed blocks of 256 x 256 pixels with a projected coordinate reference system. Pixels are areas."""
    rows, columns = pixels.shape
    down, across = -(-rows // BLOCK), -(-columns // BLOCK)
    blocks = down * across
    padded = numpy.zeros((down * BLOCK, across * BLOCK), "<f4")
    padded[:rows, :columns] = pixels
    long_, short, double = 4, 3, 12
    size = 4 * BLOCK * BLOCK
    tags = [(256, long_, [columns]), (257, long_, [rows]), (258, short, [32]), (259, short, [1]), (262, short, [1]),
            (277, short, [1]), (322, short, [BLOCK]), (323, short, [BLOCK]), (324, long_, [0] * blocks),
            (325, long_, [size] * blocks), (339, short, [3]), (33550, double, [CELL, CELL, 0]),
            (33922, double, [0, 0, 0, west, north, 0]),
            (34735, short, [1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32630])]
    form = {short: "H", long_: "I", double: "d"}
    header = 8 + 2 + 12 * len(tags) + 4
    first = header + sum(struct.calcsize(f"{len(v)}{form[t]}") for _, t, v in tags)
    tags[8] = (324, long_, [first + k * size for k in range(blocks)])
    entries, values = b"", b""
    for tag, kind, value in tags:
        data = struct.pack(f"<{len(value)}{form[kind]}", *value)
        if len(data) <= 4:
            place = data.ljust(4, b"\0")
        else:
            place = struct.pack("<I", header + len(values))
            values += data
        entries += struct.pack("<HHI", tag, kind, len(value)) + place
    values = values.ljust(first - header, b"\0")
    with open(file, "wb") as out:
        out.write(b"II*\0" + struct.pack("<IH", 8, len(tags)) + entries + b"\0\0\0\0" + values)
        for block_row in padded.reshape(down, BLOCK, across, BLOCK).swapaxes(1, 2):
            out.write(block_row.tobytes())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--side", type=int, default=7073, help="pixels per side of the raster")
    parser.add_argument("--tile", type=int, default=1024, help="pixels per side of a GeoTIFF file")
    parser.add_argument("-o", dest="folder", type=pathlib.Path, default=pathlib.Path(__file__).parent / "terrain",
                        help="folder for the files (default: terrain in the folder of this script)")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    half = options.side * CELL / 2
    west, top = 500000 - half, 5300000 + half
    places = CELL * (numpy.arange(options.side) + 0.5) - half
    sources = []
    for row in range(0, options.side, options.tile):
        for column in range(0, options.side, options.tile):
            pixels = heights(places[column:column + options.tile], -places[row:row + options.tile])
            name = f"{row // options.tile:02}-{column // options.tile:02}.tif"
            write_geotiff(options.folder / name, pixels, west + CELL * column, top - CELL * row)
            height, width = pixels.shape
            sources.append(f'    <SimpleSource>\n      <SourceFilename relativeToVRT="1">{name}</SourceFilename>\n'
                           f'      <SourceBand>1</SourceBand>\n'
                           f'      <SrcRect xOff="0" yOff="0" xSize="{width}" ySize="{height}"/>\n'
                           f'      <DstRect xOff="{column}" yOff="{row}" xSize="{width}" ySize="{height}"/>\n'
                           f'    </SimpleSource>\n')
    (options.folder / "terrain.vrt").write_text(
        f'<VRTDataset rasterXSize="{options.side}" rasterYSize="{options.side}">\n  <SRS>EPSG:32630</SRS>\n'
        f'  <GeoTransform>{west}, {CELL}, 0, {top}, 0, {-CELL}</GeoTransform>\n'
        f'  <VRTRasterBand dataType="Float32" band="1">\n{"".join(sources)}  </VRTRasterBand>\n</VRTDataset>\n')
    print(f"wrote {options.folder / 'terrain.vrt'}: {options.side} x {options.side} pixels, "
          f"{2 * (options.side - 1)**2} facets")


if __name__ == "__main__":
    main()
