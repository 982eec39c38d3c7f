# SPDX-License-Identifier: GPL-3.0-or-later
"""A headless Chromium that opens the viewer's pages, clicks in them, and is looked at."""
import re
import shutil
import sys

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

    def wait_until(self, holds):
        WebDriverWait(self.driver, 60, poll_frequency=0.02).until(lambda _: holds())

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

    def slide(self, ping):
        """Moves the slider of pings, as a hand does."""
        self.js("""const slider = document.getElementById("ping");
            slider.value = String(arguments[0]);
            slider.dispatchEvent(new Event("input", { bubbles: true }));""", ping)
        self.settle()

    def resize(self, width, height):
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})
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

    def colours(self, name, places):
        """What a canvas shows at places, CSS pixels from its upper left corner: red, green, blue."""
        return np.array(self.js("""
            const canvas = document.getElementById(arguments[0]), copy = document.createElement("canvas");
            Object.assign(copy, { width: canvas.width, height: canvas.height });
            const context = copy.getContext("2d", { willReadFrequently: true });
            context.drawImage(canvas, 0, 0);
            const scale = canvas.width / canvas.clientWidth;
            return arguments[1].map(([x, y]) =>
                Array.from(context.getImageData(Math.floor(x * scale), Math.floor(y * scale), 1, 1).data).slice(0, 3));
            """, name, [[float(x), float(y)] for x, y in places])).astype(int)

    def background(self, css):
        """Brightness, 0 to 255, of what lies behind an element."""
        colour = self.js("return getComputedStyle(document.querySelector(arguments[0])).backgroundColor", css)
        return sum(int(c) for c in re.findall(r"\d+", colour)[:3]) / 3

    def prefer(self, scheme):
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia",
                                    {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
        self.settle()
