#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Engines of others, built and run from given sources: real_engines_test.py PROGRAM HURRIED_RAYS PART. PART is `parts`, which needs no
sources, or `stonefish` or `simple_sonar`, which are skipped unless TUBEFOOT_STONEFISH_SOURCE or TUBEFOOT_SIMPLE_SONAR_SOURCE name them."""
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import types
import unittest
import xml.etree.ElementTree as xml

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = ROOT / "validation" / "engines"
sys.path[:0] = [str(HERE), str(HERE / "real")]
PROGRAM, HURRIED_RAYS, PART = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve(), sys.argv[3]
VARIABLE = {"stonefish": "TUBEFOOT_STONEFISH_SOURCE", "simple_sonar": "TUBEFOOT_SIMPLE_SONAR_SOURCE"}.get(PART)
if VARIABLE and not os.environ.get(VARIABLE):
    print(f"Skipped: {VARIABLE} does not name a folder with the sources of {PART}")
    sys.exit(77)
try:
    import netCDF4
    import numpy as np
    import scipy.spatial  # noqa: F401
except ImportError as error:
    print(f"Skipped: {error}")
    sys.exit(77)
import real_engine  # noqa: E402
import simple_sonar  # noqa: E402
import stonefish  # noqa: E402
import stonefish_near  # noqa: E402
import suite  # noqa: E402
from sonar import Sonar  # noqa: E402

V1 = ROOT / "validation" / "reference" / "v1"


def fan(beams, half_fan_deg, first_m=4.0, last_m=12.0, samples=512, height_deg=20):
    """A sonar without a file."""
    sonar = Sonar.__new__(Sonar)
    sonar.beams, sonar.samples, sonar.shape = beams, samples, (beams, samples)
    sonar.half_fan, sonar.height = np.radians(half_fan_deg), np.radians(height_deg)
    sonar.width = 2 * sonar.half_fan / beams
    sonar.azimuth = (np.arange(beams) + 0.5) * sonar.width - sonar.half_fan
    sonar.edges = np.linspace(first_m, last_m, samples + 1)
    sonar.step = sonar.edges[1] - sonar.edges[0]
    sonar.slant_range = sonar.edges[:-1] + sonar.step / 2
    sonar.axes, sonar.apex = np.eye(3), np.zeros(3)
    return sonar


class Parts(unittest.TestCase):
    def test_views_share_the_beams_and_cover_the_fan(self):
        for beams, half in ((96, 30), (32, 16), (97, 30), (128, 65), (1, 10)):
            sonar = fan(beams, half)
            views = stonefish.views_of(sonar)
            self.assertEqual(len(views), -(-2 * half // 20))
            self.assertEqual(sum(n for _, n, _, _ in views), beams)
            self.assertEqual([first for first, _, _, _ in views], list(np.cumsum([0] + [n for _, n, _, _ in views[:-1]])))
            left = views[0][2] - views[0][3]
            self.assertAlmostEqual(left, -sonar.half_fan, places=12)

    def test_columns_are_the_centres_of_equal_steps_of_the_tangent(self):
        azimuth, local = stonefish.columns(fan(96, 30))
        np.testing.assert_allclose(np.diff(np.tan(local[:32])), 2 * np.tan(np.radians(10)) / 32, atol=1e-14)
        np.testing.assert_allclose(azimuth, -azimuth[::-1], atol=1e-14)
        # One view of 20 degrees: the closed form of the largest difference from equal angles is in the tangent's third derivative.
        alone, _ = stonefish.columns(fan(4096, 10))
        place = np.linspace(-1, 1, 200001)
        furthest = np.abs(np.arctan(place * np.tan(np.radians(10))) - place * np.radians(10)).max()
        self.assertAlmostEqual(np.abs(alone - fan(4096, 10).azimuth).max(), furthest, delta=1e-6)

    def test_the_taper_is_that_of_two_smooth_steps(self):
        np.testing.assert_allclose(stonefish.taper(np.array([0, 0.1, 0.2, 0.5, 0.8, 0.9, 1])), [0, 0.5, 1, 1, 1, 0.5, 0], atol=1e-12)

    def test_the_near_plane_is_a_whole_number_of_bins_before_the_picture(self):
        for first in (0.5, 4.0, 1.0001):
            sonar = fan(32, 16, first)
            bins = (sonar.edges[0] - stonefish_near.near(sonar)) / sonar.step
            self.assertAlmostEqual(bins, round(bins), places=9)
            self.assertGreaterEqual(stonefish_near.near(sonar), 0.02 - 1e-12)
            self.assertLess(stonefish_near.near(sonar), 0.02 + sonar.step)

    def test_clipped_beams_are_those_whose_corner_is_in_front_of_the_near_plane(self):
        sonar = fan(96, 30)
        middle, corner = np.array([0.0]), np.radians([9.9])
        # In the middle of a view the plane is nearer than the first range, at a corner it is farther.
        self.assertLess(stonefish.near_plane(sonar) / np.cos(middle), sonar.edges[0])
        self.assertGreater(stonefish.clipped_below(sonar, corner, corner)[0], sonar.edges[0])
        diagonal = np.sqrt(1 + 2 * np.tan(np.radians(10)) ** 2)
        limit = stonefish.clipped_below(sonar, np.radians([10.0]), np.arctan(np.tan(np.radians([10.0])) * np.cos(np.radians([10.0]))))
        self.assertAlmostEqual(limit[0], 4 * np.cos(np.radians(10)) * diagonal, places=12)

    def test_the_scenario_keeps_the_scene_and_gets_the_settings(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            real_engine.call([PROGRAM, "export", HERE / "yard" / "scene.toml", "--to", "stonefish", "-o", folder / "a"])
            before = len(list(xml.parse(folder / "a" / "scene.scn").getroot().iter("static")))
            chosen = stonefish.settings(fan(96, 30))
            self.assertEqual(stonefish.write_scenario(folder / "a" / "scene.scn", chosen), "camera")
            root = xml.parse(folder / "a" / "scene.scn").getroot()
            sensor = next(root.iter("sensor"))
            self.assertEqual(len(list(root.iter("static"))), before)
            self.assertEqual(sensor.find("specs").get("output_format"), "float32")
            self.assertEqual(sensor.find("settings").get("range_min"), "4")
            self.assertEqual(sensor.find("noise").get("additive"), "0")

    def test_hits_spread_over_more_bins_at_larger_ranges(self):
        number, weights = simple_sonar.spread(fan(96, 30), np.array([6.0, 12.0, 12.0]), np.array([0.5, 0.25, 1.0]))
        self.assertEqual(number.tolist(), [1, 5, 0])
        self.assertAlmostEqual(weights[0], 1 + 2 * np.exp(-0.5), delta=1e-4)
        self.assertAlmostEqual(weights[1], 1 + 2 * sum(np.exp(-0.5 * (k / 5) ** 2) for k in range(1, 6)), delta=1e-3)
        self.assertAlmostEqual(weights[2], 1, places=12)

    def test_scenes_that_the_engines_cannot_describe_are_left_out_with_their_reason(self):
        with tempfile.TemporaryDirectory() as folder:
            real_engine.call([PROGRAM, "suite", "--without-answers", "--quiet", "-o", folder + "/suite"])
            reasons = {file.parent.name: suite.left_out(json.loads(file.read_text()))
                       for file in (pathlib.Path(folder) / "suite" / "scenes").glob("*/scene.json")}
        self.assertEqual({name: reason for name, reason in reasons.items() if reason}, {
            "absorption": "no absorption", "even-tangents": "equiangular beams only", "listed-angles": "equiangular beams only",
            "side-lobes": "no side lobes", "layered-water": "no sound speed profile",
            "surface-multiple": "no reflections at the sea surface", "two-scatterings": "one scattering per path",
            "receivers-apart": "no separate receiver", "volume": "no scattering in the water", "sectors": "no transmit sectors",
            "gradient": "no derivatives", "shadow-border": "no diffraction",
            **{f"strength-{body}": "no target strengths" for body in ("m3", "m5a", "m5b")}})
        self.assertEqual(len(reasons), 28)

    def test_a_folder_without_the_sources_is_rejected(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("stonefish", "simple_sonar"):
                done = subprocess.run([HERE / "real" / f"build_{name}", folder, folder + "/build"], capture_output=True, text=True)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn("expected", done.stderr)

    def test_an_engine_without_sources_is_omitted_and_named(self):
        bare = {key: value for key, value in os.environ.items() if not key.startswith("TUBEFOOT_")}
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, "-B", HERE / "run.py", PROGRAM, HURRIED_RAYS, folder + "/out", "--quick", "--scene",
                                   V1 / "sphere", "--engine", "stonefish"], capture_output=True, text=True, env=bare)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("omitted: stonefish: TUBEFOOT_STONEFISH_SOURCE", done.stdout)


class Run(unittest.TestCase):
    """The yard and other scenes through a real engine."""

    def results(self, scene, *engines):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            words = [sys.executable, "-B", HERE / "run.py", PROGRAM, HURRIED_RAYS, folder / "out", "--quick", "--scene", scene, "--results",
                     folder / "r.json"]
            for name in engines:
                words += ["--engine", name]
            done = subprocess.run(words, capture_output=True, text=True)
            print(done.stdout, done.stderr, flush=True)
            self.assertEqual(done.returncode, 0)
            pictures = {}
            for name in engines:
                with netCDF4.Dataset(folder / "out" / scene.name / name / "echoes.nc") as file:
                    pictures[name] = np.asarray(file["energy"][0])
            self.sonar = Sonar(folder / "out" / scene.name / "truth0" / "echoes.nc")
            return {name: scenes[scene.name] for name, scenes in json.loads((folder / "r.json").read_text()).items()}, pictures

    def found(self, result):
        return {finding["fault"]: finding for finding in result["own"]["findings"]}


class Stonefish(Run):
    def test_the_yard_is_rendered_and_its_faults_are_found(self):
        results, pictures = self.results(HERE / "yard", "stonefish", "stonefish_near", "stonefish_default")
        for name, picture in pictures.items():
            # The sphere is to starboard; only the sphere and the bed are at these ranges.
            rows = picture[:, 190:230]
            self.assertGreater(rows[60:].sum(), 1.2 * rows[:36].sum(), name)
            said = " ".join(results[name]["import"]["said"])
            self.assertNotIn("flip", said, name)
        plain, near, default = (self.found(results[name]) for name in pictures)
        self.assertIn("near-clipping", plain)
        self.assertNotIn("near-clipping", near)
        self.assertIn("8-bits", default)
        for found in (plain, near):
            for fault in ("mirror", "8-bits", "noise", "blur", "beam-shift"):
                self.assertNotIn(fault, found)

    def test_the_corners_of_each_view_are_clipped(self):
        _, pictures = self.results(HERE / "cornice", "stonefish", "stonefish_near")
        _, local = stonefish.columns(self.sonar)
        lower, upper = np.radians([8.4, 9.4])
        gone = stonefish.clipped_below(self.sonar, local, lower) > 4.01
        kept = stonefish.clipped_below(self.sonar, local, upper) < 4.01
        # The blur fills two beams at each side of a gap.
        inside = np.array([gone[max(0, k - 2):k + 3].all() for k in range(len(gone))])
        clipped, whole = pictures["stonefish"].sum(axis=1), pictures["stonefish_near"].sum(axis=1)
        self.assertGreater(inside.sum(), 8)
        self.assertEqual(clipped[inside].max(), 0)
        self.assertGreater(clipped[kept].min(), 0)
        self.assertGreater(whole.min(), 0)


    def picture(self, folder, text, noise=0.0):
        """Numbers of Stonefish for a scene file: rows from the farthest range, columns from port."""
        folder.mkdir()
        (folder / "scene.toml").write_text(text)
        sonar = fan(96, 30)
        sonar.ping = 0
        specs, ranges, _ = stonefish.settings(sonar)
        tools = types.SimpleNamespace(program=PROGRAM)
        stonefish.picture_of(types.SimpleNamespace(path=folder / "scene.toml"), sonar, (specs, ranges, {"multiplicative": 0, "additive": noise}),
                             folder / "sonar.npy", tools)
        return np.load(folder / "sonar.npy")

    def test_surfaces_are_invisible_from_the_back(self):
        with tempfile.TemporaryDirectory() as folder:
            folder, plates = pathlib.Path(folder), {}
            for name, y, half, order in (("far", 9, 1.5, (1, 2, 3, 4)), ("front", 6, 0.5, (1, 2, 3, 4)), ("back", 6, 0.5, (4, 3, 2, 1))):
                a, b, c, d = order
                (folder / f"{name}.obj").write_text("".join(f"v {x} {y} {z}\n" for x, z in (
                    (-half, -half), (half, -half), (half, half), (-half, half))) + f"f {a} {b} {c}\nf {a} {c} {d}\n")
            sonar = ('[water]\nsound_speed_m_s = 1500\nabsorption_db_per_km = 0\n[[materials]]\nname = "m"\nlambert_db = -14\n[trajectory]\n'
                     'kind = "fixed"\nposition_m = [0, 0, 0]\n[[sensors]]\nname = "s"\nkind = "imaging"\nfrequency_khz = 1000\nbeams = 96\n'
                     'horizontal_deg = 60\nvertical_deg = 20\ntilt_deg = 0\nsamples = 512\nrange_min_m = 4\nrange_max_m = 12\n')
            for names in (("far",), ("far", "front"), ("far", "back")):
                objects = "".join(f'[[objects]]\nname = "{name}"\nshape = "mesh"\nmaterial = "m"\nfile = "../{name}.obj"\n' for name in names)
                plates[names[-1]] = self.picture(folder / f"with-{names[-1]}", sonar + objects)
        near = slice(512 - 160, 512)  # ranges below 6.5 m
        self.assertGreater(plates["front"][near].sum(), 1)
        self.assertLess(plates["front"][:-160].sum(), 0.95 * plates["far"].sum())
        np.testing.assert_array_equal(plates["back"], plates["far"])

    def test_noise_of_each_view_repeats_that_of_the_first(self):
        text = re.sub(r'^file = "', f'file = "{HERE / "yard"}/', (HERE / "yard" / "scene.toml").read_text(), flags=re.M)
        with tempfile.TemporaryDirectory() as folder:
            upwards = self.picture(pathlib.Path(folder) / "up", text.replace("tilt_deg = 20", "tilt_deg = -60"), 0.035)
        correlation = np.corrcoef(upwards.T)
        pairs = [correlation[2 * k, 32 + k] for k in range(2, 14)]
        others = [correlation[2 * k + 8, 32 + k] for k in range(2, 10)]
        self.assertGreater(min(pairs), 0.4)
        self.assertLess(np.abs(others).max(), 0.3)

    def test_the_suite_shows_the_near_plane(self):
        with tempfile.TemporaryDirectory() as folder:
            real_engine.call([PROGRAM, "suite", "--quiet", "--scenes", "range-law,near-plane", "-o", folder + "/suite"])
            real_engine.call([sys.executable, "-B", HERE / "real" / "suite.py", PROGRAM, folder + "/suite", folder + "/out", "--entries", folder,
                              "--engine", "stonefish", "--engine", "stonefish_near"])
            shares = [json.loads((pathlib.Path(folder) / f"{name}-3.0-debug.json").read_text())["scenes"]["near-plane"]["measures"]
                      ["lit_in_shadow"]["value"] for name in ("stonefish", "stonefish-near")]
        self.assertGreater(shares[0], 10 * shares[1])


class SimpleSonar(Run):
    def test_a_suite_scene_is_rendered_and_its_faults_are_found(self):
        results, _ = self.results(V1 / "box-and-wall", "simple_sonar")
        found = self.found(results["simple_sonar"])
        # A beam is what its starboard edge meets. This rounds each edge of an object by 0 to 1 beam to port, and here are few edges.
        shift = found["beam-shift"]
        self.assertLess(shift["size"], 0)
        self.assertGreater(shift["size"], -1 - 2 * shift["error"])
        self.assertIn("8-bits", found)
        self.assertNotIn("mirror", found)
        self.assertNotIn("near-clipping", found)

    def test_the_suite_shows_half_a_beam_and_the_law_of_range(self):
        with tempfile.TemporaryDirectory() as folder:
            real_engine.call([PROGRAM, "suite", "--quiet", "--scenes", "range-law,even-angles", "-o", folder + "/suite"])
            real_engine.call([sys.executable, "-B", HERE / "real" / "suite.py", PROGRAM, folder + "/suite", folder + "/out", "--entries", folder,
                              "--engine", "simple_sonar"])
            scenes = json.loads((pathlib.Path(folder) / "simple-sonar-3.0-debug.json").read_text())["scenes"]
        # 26 edges of posts, each rounded by 0 to 1 beam; and no spreading loss.
        self.assertAlmostEqual(scenes["even-angles"]["measures"]["beams_off"]["value"], 0.5, delta=2 * math.sqrt(1 / 12 / 26) + 0.05)
        self.assertAlmostEqual(scenes["range-law"]["measures"]["range_exponent"]["value"], 2, delta=0.02)


if __name__ == "__main__":
    loader = unittest.defaultTestLoader
    case = {"parts": Parts, "stonefish": Stonefish, "simple_sonar": SimpleSonar}[PART]
    result = unittest.TextTestRunner(verbosity=2).run(loader.loadTestsFromTestCase(case))
    sys.exit(not result.wasSuccessful())
