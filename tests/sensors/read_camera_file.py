# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a DIDSON (DDF_03) or ARIS (DDF_05) file the way public readers do and prints: number of frames, column
of the brightest pixel of the last frame counted from the left of the display, its range in metres, its value."""
import os
import sys

import numpy

path = sys.argv[1]
version = numpy.fromfile(path, "u1", 4)[3]
file_size, frame_size = {3: (512, 256), 5: (1024, 1024)}[version]
header = numpy.fromfile(path, "<u4", file_size // 4)
frames, high, beams, samples = (int(header[i]) for i in (1, 3, 4, 6))
frame = numpy.dtype([("header", "u1", (frame_size,)), ("picture", "u1", (samples, beams))])
assert os.path.getsize(path) == file_size + frames * frame.itemsize
records = numpy.fromfile(path, frame, frames, offset=file_size)
fields = records["header"][-1].tobytes()


def field(kind, offset):
    return numpy.frombuffer(fields, kind, 1, offset)[0].item()


picture = records["picture"][-1][:, ::-1]  # the file's first beam is the right-most
row, column = numpy.unravel_index(picture.argmax(), picture.shape)
if version == 3:
    assert field("<u4", 192) & 3 == 0, "extended windows, no long-range camera"
    start = field("<u4", 52) * (0.42 if high else 0.84)
    length = (1.25, 2.5, 5, 10, 20, 40)[field("<u4", 56) + (0 if high else 2)]
    spacing = 1500 / (2 * header[5:6].view("<f4")[0].item())
    assert abs(spacing * samples - length) < 1e-9, "the sample rate and the code give one length"
    distance = start + (row + 0.5) * spacing
else:
    beams_of_mode = {1: 48, 3: 96, 6: 64, 9: 128}
    assert beams_of_mode[field("<u4", 436)] == beams and field("<u4", 468) == samples
    assert field("<u4", 516) == 1, "already in the order of samples and beams"
    distance = (field("<u4", 476) + row * field("<u4", 452)) * 1e-6 * field("<f4", 464) / 2
print(frames, column, repr(float(distance)), picture[row, column])
