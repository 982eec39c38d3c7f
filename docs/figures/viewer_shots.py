# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages of `tubefoot view` as a headless Chromium shows them."""
import raster


def viewer(tools, path):
    """A pixel of the well head's picture is selected; the view is that of the sonar."""
    page = raster.Browser.get()
    page.resize(1280, 800)
    page.open(tools.work / "out/wellhead.html")
    page.js("""for (const button of document.querySelectorAll("button")) if (button.textContent.trim() === "Sonar") button.click();
        tubefootView.choose({ cell: tubefootView.cellOf(0, 48, 150) });""")
    page.settle()
    page.settle()
    raster.Browser.shot(path, 1280, 800)
