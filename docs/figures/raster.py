# SPDX-License-Identifier: GPL-3.0-or-later
"""PNG files: encoding of arrays, colour maps, and pages and SVG as the headless Chromium of tests/viewer shows them."""
import base64
import pathlib
import struct
import sys
import zlib

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/viewer"))

# Colours of the sonar pictures of tubefoot: dark copper to pale.
COPPER = np.array([[0.020, 0.016, 0.024], [0.190, 0.105, 0.075], [0.440, 0.240, 0.115], [0.700, 0.420, 0.180],
                   [0.910, 0.665, 0.370], [1.000, 0.950, 0.820]])
NO_ECHO = np.array([0.05, 0.07, 0.20])
# Differences: blue, near white, red.
DIFFERENCE = np.array([[0.05, 0.20, 0.50], [0.30, 0.55, 0.85], [0.94, 0.94, 0.93], [0.93, 0.52, 0.38], [0.58, 0.06, 0.10]])


def colours(levels, stops):
    """sRGB of levels from 0 to 1, linear between stops."""
    at = np.clip(levels, 0, 1) * (len(stops) - 1)
    below = np.minimum(at.astype(int), len(stops) - 2)
    share = (at - below)[..., None]
    return stops[below] * (1 - share) + stops[below + 1] * share


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(rgb):
    """An RGB or RGBA PNG of an array (rows, columns, 3 or 4) of 0 to 1."""
    pixels = np.round(np.clip(rgb, 0, 1) * 255).astype(np.uint8)
    rows, columns, channels = pixels.shape
    lines = np.concatenate([np.zeros((rows, 1), np.uint8), pixels.reshape(rows, -1)], axis=1)
    head = struct.pack(">IIBBBBB", columns, rows, 8, 6 if channels == 4 else 2, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(lines.tobytes(), 9)) +
            chunk(b"IEND", b""))


def uri(rgb):
    return "data:image/png;base64," + base64.b64encode(png(rgb)).decode()


class Browser:
    """One Chromium for all figures that need it; it starts on first use."""
    page = None

    @classmethod
    def get(cls):
        if cls.page is None:
            import browser
            cls.page = browser.Page()
        return cls.page

    @classmethod
    def close(cls):
        if cls.page is not None:
            cls.page.close()
            cls.page = None

    @classmethod
    def shot(cls, path, width, height, scale=1):
        page = cls.get()
        page.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": width, "height": height, "deviceScaleFactor": scale, "mobile": False})
        page.settle()
        shot = page.driver.execute_cdp_cmd("Page.captureScreenshot", {"format": "png"})
        path.write_bytes(base64.b64decode(shot["data"]))


def rasterise(svg, path, width, height, scale=2):
    """A PNG of an SVG, `scale` pixels per unit."""
    page = Browser.get()
    file = path.with_suffix(".html")
    file.write_text(f'<!DOCTYPE html><html><head><meta charset="utf-8"></head><body style="margin:0;background:white">{svg}</body></html>')
    page.driver.get(f"file://{file}")
    Browser.shot(path, width, height, scale)
    file.unlink()
