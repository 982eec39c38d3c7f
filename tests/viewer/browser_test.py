# SPDX-License-Identifier: GPL-3.0-or-later
"""Clicks in pages of `tubefoot view` and holds what lights up against the footprints' own file and echoes.nc.

browser_test.py TUBEFOOT: needs chromium, chromium-driver, python3-selenium, python3-netcdf4; exits with 77
where they are absent.
"""
import csv
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

from browser import Page, skip

try:
    import netCDF4
    import numpy as np
except ImportError:
    skip("python3-netcdf4 is not installed")

PROGRAM = sys.argv.pop(1)

SCENE = """
title = "Box </script> & bed"
[[materials]]
name = "sand"
[[materials]]
name = "steel"
lambert_db = -8
[[terrain]]
name = "bed"
kind = "fractal"
material = "sand"
width_m = {width}
length_m = {width}
cell_m = {cell}
rms_height_m = 0.05
[[objects]]
name = "box"
material = "steel"
shape = "box"
position_m = [0.2, 5, 0.3]
heading_deg = 20
[trajectory]
kind = "line"
start_m = [0, -1, 2.5]
end_m = [0, 1, 2.5]
[[sensors]]
name = "camera"
kind = "didson"
pings = 3
tilt_deg = 25
beams = 24
samples = 128
window_start_m = 3
window_length_m = 6
[[sensors]]
name = "sidescan"
kind = "sidescan"
pings = 12
range_max_m = 12
samples = 120
"""

# Stops of the scales that the page draws with.
CIVIDIS = [[0, 34, 78], [26, 56, 111], [66, 78, 108], [92, 101, 109], [116, 124, 115], [142, 148, 119],
           [170, 173, 113], [200, 199, 102], [233, 227, 77], [254, 232, 56]]
VIRIDIS = [[68, 1, 84], [72, 36, 117], [65, 68, 135], [53, 95, 141], [42, 120, 142], [33, 145, 140], [34, 168, 132],
           [68, 191, 112], [122, 209, 81], [189, 223, 38], [253, 231, 37]]
LIT = [255, 45, 120]
RATIO = [[33, 102, 172], [103, 169, 207], [224, 224, 224], [239, 138, 98], [178, 24, 43]]


def between(stops, x):
    at = min(max(x, 0), 1) * (len(stops) - 1)
    k = min(int(at), len(stops) - 2)
    return [stops[k][c] + (at - k) * (stops[k + 1][c] - stops[k][c]) for c in range(3)]


def tubefoot(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(done.stderr)
    return done.stdout


class Oracle:
    """What should light up, by the file of footprints and the recorded energies alone."""

    def __init__(self, folder, scene, sensor, pings, page):
        file = folder / f"{sensor}-{pings.replace(':', '-')}.csv"
        tubefoot("footprints", scene, "--sensor", sensor, "--pings", pings, "-o", file, "--quiet")
        csv.field_size_limit(10 ** 9)
        with open(file) as rows:
            self.rows = list(csv.DictReader(rows))
        facts = page.js("const { pings, beams, samples } = tubefootView.facts; return { pings, beams, samples }")
        self.beams, self.samples = facts["beams"], facts["samples"]
        self.pings = [p["number"] for p in facts["pings"]]
        # The page's footprints by their names in the file.
        names = zip(page.array("ping"), page.array("tube"), page.array("facet"))
        number = {(self.pings[p], t, f): k for k, (p, t, f) in enumerate(names)}
        self.number = [number[int(r["ping"]), int(r["tube"]), int(r["facet"])] for r in self.rows]
        self.row_of = {n: r for n, r in zip(self.number, self.rows)}

    def read_echoes(self, file, sensor):
        with netCDF4.Dataset(file) as data:
            group = data.groups.get(sensor, data)
            self.energy = np.array(group["energy"][:])
            self.bounds = np.array(group["slant_range_bounds"][:])

    def overlap(self, row, sample):
        low, high = self.bounds[sample]
        return min(high, float(row["slant_range_max_m"])) - max(low, float(row["slant_range_min_m"]))

    def place(self, cell):
        return cell // (self.beams * self.samples), cell // self.samples % self.beams, cell % self.samples

    def footprints_of(self, cell):
        """Those that must be lit, and those that may be: footprints may end at a sample's border."""
        ping, beam, sample = self.place(cell)
        near = [(n, self.overlap(r, sample)) for n, r in zip(self.number, self.rows)
                if int(r["ping"]) == self.pings[ping] and int(r["beam"]) == beam]
        return {n for n, o in near if o > 1e-9}, {n for n, o in near if o > -1e-9}

    def cells_of(self, footprint):
        row = self.row_of[footprint]
        ping = self.pings.index(int(row["ping"]))
        first = (ping * self.beams + int(row["beam"])) * self.samples
        near = [(first + k, self.overlap(row, k)) for k in range(self.samples)]
        return {c for c, o in near if o > 1e-9}, {c for c, o in near if o > -1e-9}


class Viewer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.scene = cls.folder / "scene.toml"
        cls.scene.write_text(SCENE.format(width=40, cell=0.4))
        cls.result = cls.folder / "result"
        tubefoot("run", cls.scene, "-o", cls.result, "--quiet")
        cls.page = Page()

    @classmethod
    def tearDownClass(cls):
        cls.page.close()
        cls.temporary.cleanup()

    def show(self, name, sensor, *more):
        file = self.folder / f"{name}.html"
        tubefoot("view", self.result, "-o", file, "--sensor", sensor, "--quiet", *more)
        self.page.open(file)

    def tearDown(self):
        self.assertEqual(self.page.messages(), [])

    def between_sets(self, lit, must_and_may):
        must, may = must_and_may
        self.assertLessEqual(must, lit)
        self.assertLessEqual(lit, may)

    def click_cell(self, cell):
        x, y = self.page.js("return tubefootView.cellOnCanvas(arguments[0])", int(cell))
        self.page.click("picture", x, y)

    def check_pixel(self, oracle, cell):
        """Clicks a pixel and holds what lights up against the oracle."""
        self.click_cell(cell)
        footprints, cells = self.page.lit()
        self.assertEqual(cells, {cell})
        self.between_sets(footprints, oracle.footprints_of(cell))
        ping, beam, sample = oracle.place(cell)
        energy = oracle.energy[oracle.pings[ping], beam, sample]
        text = self.page.element("chosen").text
        self.assertIn(f"beam {beam}, range bin {sample}", text)
        if energy > 0:
            levels = [float(t) for t in re.findall(r"(-?[\d.]+) dB\b", text)[:2]]
            for level in levels:  # of the pixel, and of its footprints' sum
                self.assertAlmostEqual(level, 10 * math.log10(energy), delta=0.006)
        else:
            self.assertIn("No footprint", text)
            self.assertEqual(footprints, set())

    def some_cells(self, oracle, count):
        """Bright ones, faint ones and one without echo, of the pings shown."""
        energy = oracle.energy[oracle.pings].ravel()
        order = np.argsort(energy)
        lit = order[energy[order] > 0]
        picked = [int(c) for c in lit[np.linspace(0, len(lit) - 1, count).astype(int)]]
        return picked + [int(order[0])]

    def test_pixels_of_a_camera_light_the_footprints_that_made_them(self):
        self.show("camera", "camera", "--pings", "0")
        oracle = Oracle(self.folder, self.scene, "camera", "0", self.page)
        oracle.read_echoes(self.result / "echoes.nc", "camera")
        self.assertEqual(len(oracle.rows), self.page.js("return tubefootView.arrays.area.length"))
        self.assertEqual(self.page.element("title").text, "Box </script> & bed")
        for layout in ("fan", "beams"):
            self.page.select("layout", layout)
            for cell in self.some_cells(oracle, 4):
                self.check_pixel(oracle, cell)
        # Arrow keys go to the neighbour.
        cell = self.page.js("return tubefootView.cellOf(0, 11, 60)")
        self.click_cell(cell)
        self.page.keys("picture", "\ue014")  # right
        self.assertEqual(self.page.lit()[1], {cell + oracle.samples})
        self.between_sets(self.page.lit()[0], oracle.footprints_of(cell + oracle.samples))
        self.page.keys("picture", "\ue00c")  # escape
        self.assertEqual(self.page.lit(), (set(), set()))

    def test_footprints_light_their_pixels_and_take_the_colours_of_their_numbers(self):
        page = self.page
        self.show("camera-2", "camera", "--pings", "1:2")
        oracle = Oracle(self.folder, self.scene, "camera", "1:2", page)
        oracle.read_echoes(self.result / "echoes.nc", "camera")
        page.slide(1)
        page.element("show-tubes").click()
        page.element("from-above").click()
        page.settle()
        # The bed's largest footprints that lie well inside the samples and are not cut: convex, seen from above.
        whole = sorted((r for r in oracle.rows if r["ping"] == "2" and r["component"] == "bed" and r["pieces"] == "1"
                        and not r["occluders"] and 4 < float(r["slant_range_min_m"]) < 8),
                       key=lambda r: -float(r["area_m2"]))[:40:8]
        numbers = [oracle.number[oracle.rows.index(r)] for r in whole]
        self.assertEqual(len(numbers), 5)
        places = [page.js("return tubefootView.footprintOnCanvas(arguments[0])", n) for n in numbers]
        seen = {}
        for colour in ("grazing", "energy", "beam"):
            page.select("colour-by", colour)
            seen[colour] = page.colours("scene", places)
        for row, found in zip(whole, seen["grazing"]):
            want = between(CIVIDIS, float(row["grazing_deg"]) / 90)
            self.assertLess(max(abs(found - want)), 4, f"{found} for {row['grazing_deg']} degrees")
        beams = [r["beam"] for r in whole]
        for a in range(5):
            for b in range(a):
                same = max(abs(seen["beam"][a] - seen["beam"][b])) < 3
                self.assertEqual(same, beams[a] == beams[b])
        page.select("colour-by", "energy")
        for number, (x, y), row in zip(numbers, places, whole):
            page.click("scene", x, y)
            footprints, cells = page.lit()
            self.assertEqual(footprints, {number})
            self.between_sets(cells, oracle.cells_of(number))
            for cell in cells:
                ping, beam, sample = oracle.place(cell)
                self.assertGreater(oracle.energy[oracle.pings[ping], beam, sample], 0)
            text = page.element("chosen").text
            self.assertIn(f"beam {row['beam']}, facet {row['facet']}", text)
            self.assertIn(f"{float(row['grazing_deg']):.2f}\u00b0", text)
            self.assertIn(f"{float(row['slant_range_min_m']):.3f} to {float(row['slant_range_max_m']):.3f} m", text)
            found = page.colours("scene", [(x, y)])[0]
            self.assertLess(max(abs(found - LIT)), 3)
        # Brighter footprints are higher on the scale: green rises along it.
        levels = [page.js("return tubefootView.arrays.energy[arguments[0]]", n) for n in numbers]
        order = np.argsort(levels)
        green = np.array([seen["energy"][k][1] for k in order])
        self.assertTrue((np.diff(green) >= -1).all(), f"{green} for {np.sort(levels)}")
        # Without footprints there is nothing to click.
        page.element("show-footprints").click()
        page.click("scene", *places[0])
        self.assertEqual(page.lit(), (set(), set()))

    def test_a_sidescan_line_is_one_picture(self):
        page = self.page
        self.show("sidescan", "sidescan")
        oracle = Oracle(self.folder, self.scene, "sidescan", ":", page)
        oracle.read_echoes(self.result / "echoes.nc", "sidescan")
        self.assertEqual(oracle.pings, list(range(12)))
        for cell in self.some_cells(oracle, 5):
            self.check_pixel(oracle, cell)
        # A button of the list of footprints goes on to that footprint.
        self.click_cell(self.some_cells(oracle, 2)[1])
        page.element("chosen").find_element("css selector", "td button").click()
        page.settle()
        (footprint,), cells = page.lit()
        self.between_sets(cells, oracle.cells_of(footprint))

    def test_a_slider_shows_each_ping_and_plays_through_them(self):
        page = self.page
        self.show("slider", "camera")
        oracle = Oracle(self.folder, self.scene, "camera", ":", page)
        oracle.read_echoes(self.result / "echoes.nc", "camera")
        self.assertEqual(oracle.pings, [0, 1, 2])
        page.select("layout", "beams")
        heard = np.sort(oracle.energy[oracle.energy > 0])
        top = 10 * math.log10(heard[min(int(0.999 * len(heard)), len(heard) - 1)])
        # Where the pings differ: the box's edges and shadow.
        least, most = oracle.energy.min(axis=0), oracle.energy.max(axis=0)
        places = np.argwhere((least > 1e-4 * most) & (most > 3 * least) & (most > 1e-4 * heard[-1]))[::7][:12]
        self.assertGreater(len(places), 5)
        for ping in (2, 0, 1):
            page.slide(ping)
            self.assertEqual(page.js("return tubefootView.shownPings"), [ping, ping + 1])
            self.assertIn(f"ping {ping},", page.element("ping-text").text)
            cells = [page.js("return tubefootView.cellOf(...arguments)", ping, int(b), int(k)) for b, k in places]
            spots = [page.js("return tubefootView.cellOnCanvas(arguments[0])", c) for c in cells]
            for (beam, sample), found in zip(places, page.colours("picture", spots)):
                level = 1 + (10 * math.log10(oracle.energy[ping, beam, sample]) - top) / 50
                self.assertLess(max(abs(found - between(VIRIDIS, level))), 5, f"ping {ping}, {beam}, {sample}")
            self.check_pixel(oracle, cells[0])
            footprints, _ = page.lit()
            self.assertEqual({int(oracle.row_of[f]["ping"]) for f in footprints}, {ping})
        now = lambda: page.js("return tubefootView.pings.now")
        page.keys("picture", ".")
        self.assertEqual(now(), 2)
        self.assertEqual(page.lit(), (set(), set()), "what was lit is of another ping")
        page.keys("picture", ".")
        self.assertEqual(now(), 0, "after the last comes the first")
        page.keys("picture", ",")
        self.assertEqual(now(), 2)
        page.element("ping-play").click()
        self.assertEqual(page.element("ping-play").text, "Pause")
        page.wait_until(lambda: now() == 0)
        page.wait_until(lambda: now() == 1)
        page.keys("picture", " ")
        self.assertEqual(page.element("ping-play").text, "Play")
        stopped = now()
        page.js("return new Promise((done) => setTimeout(done, 1500))")
        self.assertEqual(now(), stopped)

    def test_a_line_is_shown_whole_or_ping_by_ping(self):
        page = self.page
        self.show("line", "sidescan")
        self.assertEqual(page.js("return tubefootView.shownPings"), [0, 12])
        page.slide(4)
        self.assertEqual(page.js("return tubefootView.shownPings"), [4, 5])
        self.assertFalse(page.element("all-pings").is_selected())
        self.click_cell(page.js("return tubefootView.cellOf(7, 1, 60)"))
        self.assertEqual(page.js("return tubefootView.shownPings"), [7, 8])
        page.element("all-pings").click()
        page.settle()
        self.assertEqual(page.js("return tubefootView.shownPings"), [0, 12])

    def test_texts_of_the_picture_stay_apart_in_windows_of_any_size(self):
        page = self.page
        for sensor, layouts in (("camera", ("fan", "beams")), ("sidescan", (None,))):
            self.show("texts", sensor)
            for layout in layouts:
                if layout:
                    page.select("layout", layout)
                for width, height in ((360, 500), (640, 400), (801, 300), (1280, 800), (2400, 1300)):
                    page.resize(width, height)
                    canvas = page.js("const c = document.getElementById('picture'); return [c.clientWidth, c.clientHeight]")
                    boxes = page.js("return tubefootView.labels")
                    self.assertGreater(len(boxes), 3 if min(canvas) < 150 else 9, f"{width} x {height}")
                    for k, a in enumerate(boxes):
                        self.assertTrue(a[0] >= 0 and a[1] >= 0 and a[2] <= canvas[0] and a[3] <= canvas[1], a)
                        for b in boxes[:k]:
                            self.assertFalse(a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3],
                                             f"{width} x {height}: {a} {b}")
        page.resize(1280, 800)

    def test_ground_outside_of_the_terrain_is_no_shadow(self):
        page = self.page
        scene, file = self.folder / "small.toml", self.folder / "small.html"
        scene.write_text(SCENE.format(width=12, cell=0.4))
        tubefoot("view", scene, "-o", file, "--sensor", "camera", "--pings", "0", "--quiet")
        page.open(file)
        page.select("layout", "beams")
        beyond = page.js("return tubefootView.cellOf(0, 3, 127)")  # 9 m on; the bed ends 7 m ahead
        shadow = page.js("""const v = tubefootView;
            return v.arrays.cellEnergy.findIndex((e, cell) => !(e > 0) && !v.isBeyond(cell) &&
                v.placeOf(cell).sample > 60 && v.placeOf(cell).beam > 8);""")  # behind the box
        self.assertTrue(page.js("return tubefootView.isBeyond(arguments[0])", beyond))
        spots = [page.js("return tubefootView.cellOnCanvas(arguments[0])", c) for c in (beyond, shadow)]
        colours = page.colours("picture", spots)
        wanted = [page.js("""const c = getComputedStyle(document.documentElement).getPropertyValue(arguments[0]).trim();
            return [1, 3, 5].map((k) => parseInt(c.slice(k, k + 2), 16));""", name) for name in ("--beyond", "--no-echo")]
        self.assertEqual(colours.tolist(), wanted)
        page.click("picture", *spots[0])
        self.assertIn("this beam has no farther surface", page.element("chosen").text)
        page.click("picture", *spots[1])
        self.assertIn("shadow", page.element("chosen").text)

    def test_cycles_of_a_moving_camera_explain_its_stripes(self):
        page = self.page
        scene, file = self.folder / "cycles.toml", self.folder / "cycles.html"
        text = SCENE.format(width=20, cell=1).replace("beams = 24", "beams = 24\ncycles = 4\ncycle_interval_s = 0.02")
        scene.write_text(text)
        tubefoot("view", scene, "-o", file, "--sensor", "camera", "--pings", "0", "--quiet")
        page.open(file)
        said = page.element("stripes").text
        self.assertIn("24 beams in 4 cycles", said)
        self.assertIn("within 60 ms", said)
        self.click_cell(page.js("return tubefootView.cellOf(0, 10, 60)"))
        self.assertRegex(page.element("chosen").text, r"cycle\s+2 of 0 to 3")
        self.assertRegex(page.element("chosen").text, r"transmitted\s+after 40.0 ms")
        # At rest there is nothing to explain.
        scene.write_text(text.replace('kind = "line"\nstart_m = [0, -1, 2.5]\nend_m = [0, 1, 2.5]',
                                      'kind = "fixed"\nposition_m = [0, -1, 2.5]'))
        tubefoot("view", scene, "-o", file, "--sensor", "camera", "--pings", "0", "--quiet")
        page.open(file)
        self.assertFalse(page.element("stripes").is_displayed())

    def test_asks_nobody_and_follows_the_browser_into_the_dark(self):
        self.show("dark", "camera")
        self.assertEqual(self.page.js("return performance.getEntriesByType('resource').length"), 0)
        corner = [(3, 3)]  # water, without the scene's facets
        self.page.element("show-mesh").click()
        self.page.settle()
        self.assertGreater(self.page.background("#panel"), 200)
        self.assertGreater(self.page.colours("scene", corner).min(), 200)
        self.page.prefer("dark")
        self.assertLess(self.page.background("#panel"), 70)
        self.assertLess(self.page.colours("scene", corner).max(), 70)
        self.page.prefer("light")

    def test_a_hundred_thousand_footprints(self):
        fine = self.folder / "fine.toml"
        fine.write_text(SCENE.format(width=16, cell=0.03).replace("beams = 24", "beams = 96"))
        file = self.folder / "fine.html"
        said = tubefoot("view", fine, "-o", file, "--sensor", "camera", "--pings", "0:2", "--quiet")
        count = int(re.search(r"(\d+) footprints", said)[1])
        self.assertGreater(count, 100_000)
        self.page.open(file)
        self.assertEqual(self.page.js("return tubefootView.arrays.area.length"), count)
        oracle = Oracle(self.folder, fine, "camera", "0:2", self.page)
        oracle.energy = self.page.array("cellEnergy").reshape(3, oracle.beams, oracle.samples)
        oracle.energy *= self.page.js("return tubefootView.facts.energyScale")
        oracle.bounds = np.array([[3 + 6 * (k + e) / oracle.samples for e in (0, 1)] for k in range(oracle.samples)])
        self.page.select("layout", "beams")
        for cell in self.some_cells(oracle, 3)[1:3]:
            if oracle.place(cell)[0] != 0:
                cell %= oracle.beams * oracle.samples
            self.check_pixel(oracle, cell)


    def test_a_candidate_is_shown_beside_the_picture_and_the_scene(self):
        page = self.page
        rays, file = self.folder / "rays", self.folder / "compared.html"
        tubefoot("run", self.scene, "-o", rays, "--quiet", "--engine", "ray", "--rays-per-beam", "300")
        tubefoot("view", self.scene, "--sensor", "camera", "--pings", "1:2", "-o", file, "--quiet",
                 "--reference", self.result / "echoes.nc", "--candidate", rays / "echoes.nc")
        page.open(file)
        page.slide(1)
        oracle = Oracle(self.folder, self.scene, "camera", "1:2", page)
        oracle.read_echoes(self.result / "echoes.nc", "camera")
        reference = oracle.energy[1:3].ravel()
        oracle.read_echoes(rays / "echoes.nc", "camera")
        candidate = oracle.energy[1:3].ravel()
        shown = page.array("candidateEnergy") * page.js("return tubefootView.facts.energyScale")
        np.testing.assert_allclose(shown, candidate, rtol=2e-5)
        cells = range(oracle.beams * oracle.samples, 2 * oracle.beams * oracle.samples)
        full = page.js("return tubefootView.ratioRangeDb")
        threshold = 1e-3 * page.array("cellEnergy")[page.array("cellEnergy") > 0].mean() * page.js(
            "return tubefootView.facts.energyScale")
        # Cells of several pixels each, so that a click meets the one that is meant.
        page.resize(1600, 2000)
        self.addCleanup(page.resize, 1280, 800)
        # One that is much too weak, one as it should be, one much too strong: colours and numbers.
        lit = [c for c in cells if reference[c] > 3 * threshold and candidate[c] > 0]
        order = sorted(lit, key=lambda c: candidate[c] / reference[c])
        page.select("layout", "beams")
        for cell in (order[0], order[len(order) // 2], order[-1]):
            x, y = page.js("return tubefootView.cellOnCanvas(arguments[0], 2)", cell)
            found = page.colours("difference-picture", [[x, y]])[0]
            db = 10 * math.log10(candidate[cell] / reference[cell])
            self.assertAlmostEqual(page.js("return tubefootView.ratioDb(arguments[0])", cell), db, delta=0.001)
            want = between(RATIO, 0.5 + 0.5 * max(-1, min(1, db / full)))
            self.assertLess(max(abs(found - want)), 4, f"{found} for {db} dB")
            for number, canvas in ((1, "candidate-picture"), (2, "difference-picture")):
                page.click(canvas, *page.js("return tubefootView.cellOnCanvas(...arguments)", cell, number))
                footprints, cells_lit = page.lit()
                self.assertEqual(cells_lit, {cell})
                self.between_sets(footprints, oracle.footprints_of(cell))
                text = page.element("chosen").text
                self.assertIn(f"{db:.2f} dB", text.replace("-0.00", "0.00"))
                page.js("tubefootView.choose(null)")
        # All three zoom together.
        page.keys("picture", "+", "+", "+", "+")
        cell = page.js("return tubefootView.cellAt(200, 100, 1)")
        page.click("candidate-picture", 200, 100)
        seen = page.js("return [0, 1, 2].map((k) => tubefootView.cellOnCanvas(arguments[0], k)[0])", cell)
        self.assertLess(max(seen) - min(seen), 1)
        self.assertEqual(page.lit()[1], {cell})
        # Without a candidate there is one picture.
        self.show("alone", "camera", "--pings", "0")
        self.assertFalse(page.element("candidate-picture").is_displayed())
        self.assertFalse(page.element("difference-picture").is_displayed())


class CommandLine(unittest.TestCase):
    def fails(self, *arguments):
        done = subprocess.run([PROGRAM, "view", *map(str, arguments)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2, done.stderr)
        return done.stderr

    def test_refuses_a_scene_that_changed_and_folders_of_others(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            scene, result, page = folder / "scene.toml", folder / "result", folder / "page.html"
            scene.write_text(SCENE.format(width=20, cell=1))
            tubefoot("run", scene, "-o", result, "--quiet")
            self.assertIn("no stats.json", self.fails(folder, "-o", page))
            self.assertIn("sonar", self.fails(result, "-o", page, "--sensor", "sonar"))
            self.assertIn("pings 0 to 2", self.fails(result, "-o", page, "--pings", "3"))
            self.assertIn("is a folder", self.fails(result, "-o", folder))
            self.assertIn("--candidate", self.fails(result, "-o", page, "--reference", result / "echoes.nc"))
            other = folder / "other.toml"
            other.write_text(SCENE.format(width=21, cell=1))
            tubefoot("run", other, "-o", folder / "another", "--quiet")
            tubefoot("run", scene, "-o", folder / "few", "--quiet", "--sensor", "camera", "--beams", "3:5")
            self.assertIn("scene_hash", self.fails(scene, "-o", page, "--candidate", folder / "another/echoes.nc"))
            self.assertIn("3 beams", self.fails(scene, "-o", page, "--candidate", folder / "few/echoes.nc"))
            self.assertIn("none.nc", self.fails(scene, "-o", page, "--candidate", folder / "none.nc"))
            for name in ("another", "few"):
                shutil.rmtree(folder / name)
            other.unlink()
            scene.rename(folder / "moved.toml")
            self.assertIn("--scene", self.fails(result, "-o", page))
            tubefoot("view", result, "--scene", folder / "moved.toml", "-o", page, "--quiet")
            self.assertTrue(page.exists())
            page.unlink()
            (folder / "moved.toml").write_text(SCENE.format(width=21, cell=1))
            self.assertIn("has changed", self.fails(result, "--scene", folder / "moved.toml", "-o", page))
            (result / "stats.json").write_text("{")
            self.assertIn("stats.json", self.fails(result, "-o", page))
            self.assertEqual(sorted(p.name for p in folder.iterdir()), ["moved.toml", "result"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
