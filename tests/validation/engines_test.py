#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Engines of others, quickly: engines_test.py PROGRAM HURRIED_RAYS. Their parts by closed forms, their pictures by what must
be where, and what `tubefoot compare` must find in them. Engines whose Python library is missing are left out, visibly."""
import importlib
import json
import pathlib
import subprocess
import sys
import tempfile
import types
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = ROOT / "validation" / "engines"
sys.path.insert(0, str(HERE))
try:
    import netCDF4
    import numpy as np
except ImportError as error:
    print(f"Skipped: {error}")
    sys.exit(77)
import depth_buffer  # noqa: E402
import holoocean_like  # noqa: E402
import pictures  # noqa: E402
import report  # noqa: E402
import run  # noqa: E402
from sonar import Scene, Sonar, Unsupported  # noqa: E402

PROGRAM, HURRIED_RAYS = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
TOOLS = types.SimpleNamespace(program=PROGRAM, hurried_rays=HURRIED_RAYS)
FLAT = ROOT / "validation" / "reference" / "v1" / "flat-bed"
# In the yard: engine, fault, size (None: any), within.
MUST_FIND = [("embree_hurry", "half-sample", 0.5, 0.15), ("embree_hurry", "8-bits", None, 0),
             ("stonefish_like", "near-clipping", None, 0), ("stonefish_like", "scalloped-edge", 1.98, 0.6),
             ("stonefish_like", "8-bits", None, 0), ("dave_like", "mirror", None, 0), ("dave_like", "near-clipping", None, 0),
             ("dave_like", "clamped", None, 0), ("holoocean_like", "near-clipping", None, 0),
             ("simple_rays", "beam-shift", -0.5, 0.06), ("simple_rays", "8-bits", None, 0)]
MUST_NOT_FIND = [("embree_hurry", "mirror"), ("embree_hurry", "beam-shift"), ("embree_hurry", "near-clipping"),
                 ("embree_hurry", "range-scale"), ("stonefish_like", "mirror"), ("stonefish_like", "blur"),
                 ("stonefish_like", "level"), ("stonefish_like", "range-law"), ("simple_rays", "mirror"),
                 ("simple_rays", "near-clipping"), ("holoocean_like", "mirror"), ("holoocean_like", "8-bits")]


def engines_here():
    """Those whose libraries are here."""
    there = []
    for name, library in (("embree_hurry", None), ("stonefish_like", "OpenGL"), ("dave_like", "OpenGL"),
                          ("holoocean_like", None), ("simple_rays", "vtk")):
        try:
            importlib.import_module(library or "numpy")
            there.append(name)
        except ImportError as error:
            print(f"left out: {name}: {error}", flush=True)
    return there


class Parts(unittest.TestCase):
    def test_pictures_come_through_import(self):
        with tempfile.TemporaryDirectory() as folder:
            path, echoes = pathlib.Path(folder) / "a.png", pathlib.Path(folder) / "a.nc"
            sonar = Sonar(FLAT / "echoes.nc")
            picture = np.random.default_rng(1).integers(0, 256, (sonar.samples, sonar.beams), np.uint8)
            pictures.write_png(path, picture)
            run.imported([PROGRAM, "import", path, "--like", FLAT / "echoes.nc", "--order", "range-first", "--scale", "8bit", "-o", echoes])
            with netCDF4.Dataset(echoes) as file:
                np.testing.assert_array_equal(file["energy"][0], picture.T / 255)

    def test_a_direction_is_seen_where_it_points(self):
        sonar = Sonar(FLAT / "echoes.nc")
        azimuth, elevation = np.array([-0.2, 0.1, 0.25]), np.array([0.1, -0.3, 0.0])
        ranges, back, up = sonar.seen_from_here(sonar.apex + 7 * sonar.directions(azimuth, elevation))
        np.testing.assert_allclose([ranges, back, up], [[7] * 3, azimuth, elevation], atol=1e-12)
        self.assertGreater(sonar.directions(0.1, 0.0)[0], 0, "starboard is east where it looks north")

    def test_columns_are_even_in_the_tangent(self):
        sonar = Sonar(FLAT / "echoes.nc")
        columns = depth_buffer.column_azimuths(sonar, 1)
        np.testing.assert_allclose(np.diff(np.tan(columns)), 2 * np.tan(sonar.half_fan) / sonar.beams, atol=1e-12)
        self.assertLess(np.abs(depth_buffer.column_azimuths(sonar, 4) - sonar.azimuth).max(), np.abs(columns - sonar.azimuth).max() / 9)

    def test_the_first_cluster_hides_the_rest_of_its_bin(self):
        sonar = Sonar(FLAT / "echoes.nc")
        ranges = np.array([5.0, 5.1, 5.15, 7.0, 7.1, 6.0])
        azimuth = np.radians([0.5, 0.5, 0.5, 0.5, 0.5, 1.5])  # the last in the next bin
        seen = holoocean_like.lit(sonar, ranges, azimuth, np.full(6, 1e-4), 0.12)
        self.assertEqual(seen.tolist(), [True, True, True, False, False, True])

    def test_leaves_of_a_flat_bed_lie_half_a_leaf_above_it_one_beside_the_other(self):
        scene, sonar = Scene(FLAT / "scene.toml"), Sonar(FLAT / "echoes.nc")
        scene.triangles, scene.normal, scene.mu = scene.triangles[:1], scene.normal[:1], scene.mu[:1]
        scene.triangles = np.array([[[0, -10, 0], [0.8, -10, 0], [0, -9.2, 0]]], float)
        places, normals, _ = holoocean_like.leaves(scene, sonar, 0.1)
        self.assertTrue(np.allclose(places[:, 2], 0.05))
        cells = {tuple(np.rint(p / 0.1 - 0.5).astype(int)) for p in places[:, :2]}
        self.assertEqual(len(cells), len(places))
        self.assertTrue({(x, y - 100) for x in range(8) for y in range(8 - x)} <= cells)

    def test_scenes_that_are_not_meshes_are_refused(self):
        with self.assertRaisesRegex(Unsupported, "terrain"):
            Scene(ROOT / "scenes" / "chart" / "sphere-on-plane.toml")

    def test_verdicts(self):
        known = {"fault": "x", "size": 2.0, "may": False, "within": 0.25}
        finding = lambda size, error=0.0: {"size": size, "error": error}
        self.assertEqual(report.verdict(known, finding(2.4)), "found")
        self.assertEqual(report.verdict(known, finding(3.0)), "found, size off")
        self.assertEqual(report.verdict(known, finding(3.0, 0.4)), "found")
        self.assertEqual(report.verdict(known, None), "missed")
        self.assertEqual(report.verdict({**known, "may": True}, None), "nothing to find")
        self.assertEqual(report.verdict({**known, "size": 0}, finding(5)), "found although 0")


class Engines(unittest.TestCase):
    def test_rays_meet_a_flat_bed_where_it_is(self):
        scene, sonar = Scene(FLAT / "scene.toml"), Sonar(FLAT / "echoes.nc")
        rays = sonar.directions(np.linspace(-0.2, 0.2, 9), np.linspace(-0.5, -0.2, 9))
        expected = -sonar.apex[2] / rays[:, 2]
        import embree_hurry
        distances, hits = embree_hurry.first_hits(HURRIED_RAYS, scene.triangles, sonar.apex, rays)
        np.testing.assert_allclose(distances, expected, rtol=1e-5)
        self.assertTrue((hits < 2).all())
        if "simple_rays" in HERE_NOW:
            import simple_rays
            np.testing.assert_allclose(simple_rays.first_ranges(scene.triangles, sonar.apex, rays, 40), expected, rtol=1e-9)
        if "stonefish_like" in HERE_NOW:
            samples = depth_buffer.samples(scene, sonar, 1, 64)
            middle = depth_buffer.column_azimuths(sonar, 1)
            up = np.arctan(((np.arange(64) + 0.5) / 32 - 1) * np.tan(sonar.height / 2) * np.cos(middle[:, None]))
            z = sonar.directions(middle[:, None], up)[..., 2]
            met = np.isfinite(samples[:, :, 0])
            self.assertGreater(met.sum(), 500)
            np.testing.assert_allclose(samples[met][:, 0], (-sonar.apex[2] / z)[met], rtol=1e-4)
            np.testing.assert_allclose(samples[met][:, 1], -z[met], rtol=1e-3)

    def test_the_yard_is_judged_as_it_must_be(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            words = [sys.executable, "-B", HERE / "run.py", PROGRAM, HURRIED_RAYS, folder / "out", "--quick", "--scene", HERE / "yard",
                     "--results", folder / "r.json"]
            for name in HERE_NOW:
                words += ["--engine", name]
            done = subprocess.run(words, capture_output=True, text=True)
            print(done.stdout, done.stderr, flush=True)
            self.assertEqual(done.returncode, 0)
            results = json.loads((folder / "r.json").read_text())
            # What is declared puts starboard to starboard: the sphere, which is the strongest there is, stands in the right half.
            for name in set(HERE_NOW) - {"dave_like"}:
                with netCDF4.Dataset(folder / "out" / "yard" / name / "echoes.nc") as file:
                    energy = np.asarray(file["energy"][0])
                rows = energy[:, 190:230]  # 7 to 7.6 m, where only the sphere and the bed are
                self.assertGreater(rows[60:].sum(), 1.2 * rows[:36].sum(), name)
        self.assertEqual(set(results), set(HERE_NOW))
        # Import names a mirror image, and no other order of any.
        for name in HERE_NOW:
            said = " ".join(results[name]["yard"]["import"]["said"])
            self.assertEqual("use --flip-beams" in said, name == "dave_like", said)
            self.assertNotIn("ranges reversed", said, name)
        found = {name: {f["fault"]: f for f in scenes["yard"]["own"]["findings"]} for name, scenes in results.items()}
        for name, fault, size, within in MUST_FIND:
            if name in HERE_NOW:
                self.assertIn(fault, found[name], name)
                if size is not None:
                    self.assertAlmostEqual(found[name][fault]["size"], size, delta=within, msg=f"{name}: {fault}")
        for name, fault in MUST_NOT_FIND:
            if name in HERE_NOW:
                self.assertNotIn(fault, found[name], name)

    def test_a_scene_loses_only_the_object_that_is_named(self):
        text = (HERE / "yard" / "scene.toml").read_text()
        less = run.without_objects(text, ["rod"])
        self.assertNotIn("rod.obj", less)
        self.assertEqual(less.count("[[objects]]"), text.count("[[objects]]") - 1)
        self.assertIn("[trajectory]", less)
        self.assertRaises(Unsupported, run.without_objects, text, ["nobody"])


if __name__ == "__main__":
    HERE_NOW = engines_here()
    unittest.main(argv=sys.argv[:1], verbosity=2)
