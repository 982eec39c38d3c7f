# SPDX-License-Identifier: GPL-3.0-or-later
"""Grey 8-bit PNG files, written with the standard library: pictures as engines leave them."""
import struct
import zlib

import numpy as np

SIGNATURE = b"\x89PNG\r\n\x1a\n"


def write_png(path, picture):
    picture = np.ascontiguousarray(picture, np.uint8)
    rows, columns = picture.shape
    lines = b"".join(b"\0" + row.tobytes() for row in picture)
    with open(path, "wb") as file:
        file.write(SIGNATURE)
        for kind, data in ((b"IHDR", struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)),
                           (b"IDAT", zlib.compress(lines, 9)), (b"IEND", b"")):
            file.write(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)))
