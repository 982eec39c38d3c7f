# SPDX-License-Identifier: GPL-3.0-or-later
"""A headless Chromium that opens the viewer's pages, clicks in them, and is looked at."""
import shutil
import struct
import sys
import zlib

import numpy as np

SKIPPED = 77


def skip(why):
    print(f"Skipped: {why}")
    sys.exit(SKIPPED)


try:
    from selenium import webdriver
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.support.ui import Select, WebDriverWait
except ImportError:
    skip("python3-selenium is not installed")


def png_pixels(data):
    """Rows of red, green, blue of an 8-bit PNG without interlacing, as screenshots are."""
    at, idat = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, colour, _, _, interlaced = struct.unpack(">IIBBBBB", body)
            assert depth == 8 and colour in (2, 6) and not interlaced
            channels = 3 if colour == 2 else 4
        elif kind == b"IDAT":
            idat += body
        at += 12 + size
    raw = np.frombuffer(zlib.decompress(idat), np.uint8).reshape(height, 1 + width * channels)
    out = np.zeros((height, width, channels), np.uint8)
    previous = np.zeros((width, channels), np.uint8)
    for y in range(height):
        kind, line = raw[y, 0], raw[y, 1:].reshape(width, channels).copy()
        if kind == 2:
            line += previous
        elif kind == 1:
            line = np.cumsum(line, axis=0, dtype=np.uint64).astype(np.uint8)
        elif kind in (3, 4):
            for x in range(width):
                left = line[x - 1].astype(int) if x else np.zeros(channels, int)
                up = previous[x].astype(int)
                if kind == 3:
                    guess = (left + up) // 2
                else:
                    corner = previous[x - 1].astype(int) if x else np.zeros(channels, int)
                    p = left + up - corner
                    far = np.stack([abs(p - left), abs(p - up), abs(p - corner)])
                    guess = np.choose(np.argmin(far, axis=0), [left, up, corner])
                line[x] = (line[x].astype(int) + guess) % 256
        out[y] = previous = line
    return out[:, :, :3].astype(int)


class Page:
    """One page in a window of 1280 x 800."""

    def __init__(self):
        chromium, driver = shutil.which("chromium"), shutil.which("chromedriver")
        if not chromium or not driver:
            skip("chromium and chromium-driver are not installed")
        options = webdriver.ChromeOptions()
        options.binary_location = chromium
        for flag in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader",
                     "--enable-unsafe-swiftshader", "--window-size=1280,800", "--hide-scrollbars"):
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(service=Service(driver), options=options)
        # The window's own borders would take some of it.
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": 1280, "height": 800, "deviceScaleFactor": 1, "mobile": False})
        self.driver.set_page_load_timeout(300)
        self.driver.set_script_timeout(120)

    def close(self):
        self.driver.quit()

    def open(self, file):
        self.driver.get(f"file://{file}")
        WebDriverWait(self.driver, 300).until(lambda d: self.js("return !!window.tubefootView"))
        self.settle()

    def js(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def settle(self):
        """Until what was asked for is drawn."""
        self.driver.execute_async_script(
            "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()));")

    def array(self, name):
        return np.array(self.js("return Array.from(tubefootView.arrays[arguments[0]])", name))

    def messages(self):
        return [m for m in self.driver.get_log("browser")
                if "GPU stall due to ReadPixels" not in m["message"]]

    def element(self, name):
        return self.driver.find_element(By.ID, name)

    def select(self, name, value):
        Select(self.element(name)).select_by_value(value)
        self.settle()

    def click(self, name, x, y):
        """At x, y of an element, CSS pixels from its upper left corner."""
        element = self.element(name)
        size = self.js("const b = arguments[0].getBoundingClientRect(); return [b.width, b.height]", element)
        assert 0 <= x < size[0] and 0 <= y < size[1], f"{x}, {y} lies beside '{name}'"
        ActionChains(self.driver, duration=0).move_to_element_with_offset(
            element, round(x - size[0] / 2), round(y - size[1] / 2)).click().perform()
        self.settle()

    def keys(self, name, *keys):
        self.element(name).send_keys(*keys)
        self.settle()

    def lit(self):
        lit = self.js("return tubefootView.lit")
        return set(lit["footprints"]), set(lit["cells"])

    def colours(self, name):
        """Of an element, row by row."""
        return png_pixels(self.element(name).screenshot_as_png)

    def prefer(self, scheme):
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia",
                                    {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
        self.settle()
