#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the checker of the benchmark suite on small suites that the test writes: measures, versions, bad input, installation."""
import importlib.util
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

try:
    import numpy as np
except ImportError:
    print("skipped: NumPy is not installed (Debian: python3-numpy)")
    sys.exit(77)

REFERENCE = pathlib.Path(__file__).resolve().parents[2] / "validation" / "reference"
sys.dont_write_bytecode = True
sys.path.insert(0, str(REFERENCE))
from tubefoot_suite import Refused, compare_suite  # noqa: E402
from tubefoot_suite.submission import REQUIRED, read_description, submission  # noqa: E402

SHAPE = 2, 8, 64  # pings, beams, samples


class Suite:
    """A suite with one scene, and results that equal its answer."""

    def __init__(self, folder, measures, version="3.0", **scene):
        self.folder, self.results = pathlib.Path(folder) / "suite", pathlib.Path(folder) / "results"
        shutil.rmtree(self.folder, ignore_errors=True)
        shutil.rmtree(self.results, ignore_errors=True)
        for part in (self.folder / "scenes" / "one", self.folder / "answers" / "one", self.results):
            part.mkdir(parents=True)
        beams = {"axes_deg": list(range(8))} | scene.pop("beams", {})
        content = {"tests": "t", "samples": {"first_m": 4, "step_m": 0.0625, "count": 64}, "beams": beams,
                   "judged_by": [{"measure": name, "limit": limit} for name, limit in measures.items()]} | scene
        (self.folder / "scenes/one/scene.json").write_text(json.dumps(content))
        (self.folder / "pack.json").write_text(json.dumps({"version": version, "set": "debug"}))
        self.energy = np.zeros(SHAPE)
        self.energy[:, :, 20:40] = 1.0
        self.answer("energy", self.energy)
        self.result("one", self.energy)

    def answer(self, name, values):
        np.save(self.folder / "answers" / "one" / f"{name}.npy", values)

    def result(self, name, values):
        np.save(self.results / f"{name}.npy", values)

    def report(self):
        return compare_suite(self.folder, self.results)

    def measure(self, name):
        (scene,) = self.report()["scenes"]
        return scene["measures"][name]["value"], scene["agrees"]


def near(found, value):
    assert abs(found - value) < 1e-9, (found, value)


def test_displacements_have_a_sign_from_version_3(folder):
    for version, signs in (("3.0", (1, -1)), ("2.0", (1, 1))):
        for shift, sign in zip((1, -1), signs):
            suite = Suite(folder, {"samples_moved": 0.25}, version)
            assert suite.measure("samples_moved") == (0.0, True)
            suite.result("one", (suite.energy + np.roll(suite.energy, shift, axis=2)) / 2)
            value, agrees = suite.measure("samples_moved")
            near(value, sign * 0.5)
            assert not agrees


def test_opposite_displacements_do_not_cancel(folder):
    suite = Suite(folder, {"samples_moved": 0.5})
    suite.result("one", (np.roll(suite.energy, 4, axis=2) + np.roll(suite.energy, -4, axis=2)) / 2)
    value, agrees = suite.measure("samples_moved")
    assert abs(value) > 0.5 and not agrees, value


def test_water_is_judged_in_front_of_surfaces(folder):
    suite = Suite(folder, {"volume_db": 0.25}, water_to_m=6)
    near(suite.measure("volume_db")[0], 0)
    for change, value in ((lambda e: e.__setitem__((..., slice(0, 32)), 2 * e[..., :32]), 10 * np.log10(2)),
                          (lambda e: e.__setitem__((..., slice(0, 32)), 0), -60)):
        other = suite.energy.copy()
        change(other)
        suite.result("one", other)
        near(suite.measure("volume_db")[0], value)
        assert not suite.measure("volume_db")[1]
    other = suite.energy.copy()
    other[..., 33:] *= 5  # behind
    suite.result("one", other)
    assert suite.measure("volume_db")[1]


def test_sectors_are_judged_by_their_levels(folder):
    sectors = [{"first_beam": 0, "end_beam": 4}, {"first_beam": 4, "end_beam": 8}]
    suite = Suite(folder, {"sectors_db": 0.5}, beams={"sectors": sectors})
    suite.result("one", 7 * suite.energy)  # a common gain is not an error of sectors
    near(suite.measure("sectors_db")[0], 0)
    other = suite.energy.copy()
    other[:, 4:] /= 3
    suite.result("one", other)
    value, agrees = suite.measure("sectors_db")
    near(value, 10 * np.log10(0.5))
    assert not agrees


def test_diffracted_energy_is_judged_in_geometric_shadow(folder):
    suite = Suite(folder, {"border_db": 1})
    sharp = suite.energy.copy()
    sharp[..., 30:] = 0
    suite.answer("sharp", sharp)
    assert suite.measure("border_db") == (0.0, True)
    suite.result("one", sharp)
    assert suite.measure("border_db") == (-60.0, False)


def test_derivatives_are_judged_by_the_worst_parameter(folder):
    suite = Suite(folder, {"gradient_l1": 0.1}, gradient=[{"name": "a"}, {"name": "b"}])
    gradient = np.random.default_rng(1).normal(size=(2, 8, 64))
    suite.answer("gradient", gradient)
    report_missing = suite.report
    try:
        report_missing()
        raise AssertionError("a scene without derivatives must be missing")
    except Refused as refused:
        assert "no result of any scene" in str(refused)
    suite.result("one-gradient", gradient)
    assert suite.measure("gradient_l1") == (0.0, True)
    for factor in (-1, np.pi / 180):
        other = gradient.copy()
        other[1] *= factor
        suite.result("one-gradient", other)
        value, agrees = suite.measure("gradient_l1")
        near(value, 1 - factor)
        assert not agrees
    for wrong in (gradient[:1], np.where(gradient > 2, np.nan, gradient), gradient.astype(int)):
        suite.result("one-gradient", wrong)
        (scene,) = suite.report()["scenes"]
        assert not scene["agrees"] and "refused" in scene, scene


def test_seeds_are_among_the_answers(folder):
    suite = Suite(folder, {"samples_moved": 0.25})
    (suite.folder / "pack.json").write_text(json.dumps({"version": "3.0", "set": "validation"}))
    (suite.folder / "answers/seed.json").write_text(json.dumps({"seed": "snow"}))
    assert suite.report()["suite"] == {"version": "3.0", "set": "validation", "seed": "snow"}


def expect_refused(suite, text):
    try:
        suite.report()
    except Refused as refused:
        assert text in str(refused), refused
        return
    raise AssertionError(text)


def test_damaged_suites_are_refused(folder):
    suite = Suite(folder, {"coarse_l1": 0.1})
    file = suite.folder / "scenes/one/scene.json"
    whole = json.loads(file.read_text())
    for damage in ("", "[]", "{}", "null", json.dumps(whole | {"samples": 3}), json.dumps(whole | {"beams": None}),
                   json.dumps(whole | {"judged_by": [{}]})):
        file.write_text(damage)
        expect_refused(suite, "not a scene of a benchmark suite")
    file.write_text(json.dumps(whole | {"judged_by": [{"measure": "magic", "limit": 0}]}))
    expect_refused(suite, "unknown measure magic")
    file.write_text(json.dumps(whole))
    for damage in ("", "{}", "[1]", '{"version": "new"}'):
        (suite.folder / "pack.json").write_text(damage)
        expect_refused(suite, "does not describe a benchmark suite")


def test_headers_cannot_ask_for_memory(folder):
    suite = Suite(folder, {"coarse_l1": 0.1})
    header = "{'descr': '<f8', 'fortran_order': False, 'shape': (4000000, 4000000, 1), }".ljust(117) + "\n"
    (suite.results / "one.npy").write_bytes(b"\x93NUMPY\x01\x00" + bytes([118, 0]) + header.encode() + b"\0" * 64)
    (scene,) = suite.report()["scenes"]
    assert "cannot read the file" in scene["refused"], scene


class StrengthSuite:
    """A suite with a scene of target strength. The published values are those of BeTSSi M3; the Kirchhoff values differ from them."""

    def __init__(self, folder):
        self.folder, self.results = pathlib.Path(folder) / "suite", pathlib.Path(folder) / "results"
        for part in (self.folder / "scenes" / "body", self.folder / "answers" / "body", self.results):
            part.mkdir(parents=True)
        lines = (REFERENCE.parents[1] / "scenes/betssi/m3.csv").read_text().splitlines()[2:]
        rows = [[float(cell) for cell in line.split(",")] for line in lines]
        self.published = {azimuth: level for azimuth, _, level in rows if azimuth % 5 == 0}
        # 3 dB below 60 degrees, as at a body with two parts, and the small difference of one convex body elsewhere
        self.kirchhoff = {azimuth: level + (3 if azimuth < 60 else 0.2) for azimuth, level in self.published.items()}
        scene = {"tests": "t", "body": {"obj": "m3.obj"}, "azimuths_deg": [int(a) for a in self.published], "frequencies_hz": [1000],
                 "judged_by": [{"measure": name, "limit": 1} for name in ("kirchhoff_db", "boundary_db")]}
        (self.folder / "scenes/body/scene.json").write_text(json.dumps(scene))
        (self.folder / "pack.json").write_text(json.dumps({"version": "3.0", "set": "debug"}))
        self.answer(0.01)

    def answer(self, bound):
        rows = [f"0,{a:g},1000,{self.kirchhoff[a]},{bound},{'' if a == 90 else level}\n" for a, level in self.published.items()]
        (self.folder / "answers/body/strength.csv").write_text(
            "elevation_deg,azimuth_deg,frequency_hz,target_strength_db,target_strength_bound_db,compared_strength_db\n" + "".join(rows))

    def result(self, levels):
        (self.results / "body.csv").write_text(
            "# any comment\nazimuth_deg,frequency_hz,target_strength_db\n"
            + "".join(f"{azimuth:.1f},1e3,{level}\n" for azimuth, level in reversed(levels.items())))

    def report(self):
        return compare_suite(self.folder, self.results)

    def entry(self):
        (entry,) = self.report()["scenes"]
        return entry


def test_target_strengths_agree_with_either_reference(folder):
    suite = StrengthSuite(folder)
    for levels, kept in ((suite.kirchhoff, [True, False]), (suite.published, [False, True])):
        suite.result(levels)
        entry = suite.entry()
        assert [entry["measures"][name]["kept"] for name in ("kirchhoff_db", "boundary_db")] == kept and entry["agrees"], entry
    aspects = {row["azimuth_deg"]: row for row in suite.entry()["aspects"]}
    assert len(aspects) == 37 and aspects[90]["boundary_elements_db"] is None
    for azimuth, difference in ((0, 3), (180, 0.2)):
        near(aspects[azimuth]["kirchhoff_minus_boundary_elements_db"], difference)
        near(aspects[azimuth]["minus_boundary_elements_db"], 0)
    assert compare_suite(suite.folder, suite.folder / "answers")["scenes"][0]["agrees"]


def test_planted_errors_of_target_strength_are_found(folder):
    suite = StrengthSuite(folder)
    planted = {
        "amplitude instead of energy": lambda levels: {a: level / 2 for a, level in levels.items()},
        "length in feet": lambda levels: {a: level + 20 * np.log10(1 / 0.3048) for a, level in levels.items()},
        "cross-section without 1 / 4 pi": lambda levels: {a: level + 10 * np.log10(4 * np.pi) for a, level in levels.items()},
        "cross-section instead of its level": lambda levels: {a: 10 ** (level / 10) for a, level in levels.items()},
        "aspects reversed": lambda levels: {180 - a: level for a, level in levels.items()},
        "aspects from broadside": lambda levels: {(a + 90) % 185: level for a, level in levels.items()},
        "aspects moved by five degrees": lambda levels: {(a + 5) % 185: level for a, level in levels.items()}}
    for name, change in planted.items():
        for levels in (suite.kirchhoff, suite.published):
            assert change(levels).keys() == levels.keys()
            suite.result(change(levels))
            assert not suite.entry()["agrees"], name
    suite.result({a: level + 10 * np.log10(4 * np.pi) for a, level in suite.kirchhoff.items()})
    near(suite.entry()["level_db"]["kirchhoff"], 10 * np.log10(4 * np.pi))


def test_bounds_of_target_strength_excuse_differences(folder):
    suite = StrengthSuite(folder)
    suite.result({a: level + 1.5 for a, level in suite.kirchhoff.items()})
    near(suite.entry()["measures"]["kirchhoff_db"]["value"], 1.49)
    suite.answer(1.25)
    near(suite.entry()["measures"]["kirchhoff_db"]["value"], 0.25)
    # A tenth of the aspects may differ, because nulls have no significant digits.
    for wrong, agrees in ((3, True), (4, False)):
        suite.result({a: level + 40 * (k < wrong) for k, (a, level) in enumerate(suite.kirchhoff.items())})
        assert suite.entry()["agrees"] == agrees, wrong


def test_damaged_tables_are_refused(folder):
    suite = StrengthSuite(folder)
    try:
        suite.report()
        raise AssertionError("a scene without a table must be missing")
    except Refused as refused:
        assert "no result of any scene" in str(refused)
    suite.result(suite.kirchhoff)
    file = suite.results / "body.csv"
    whole = file.read_text()
    for damage, expected in (("", "no column"), (whole.replace("target_strength_db", "ts"), "no column 'target_strength_db'"),
                             (whole.replace("90.0,1e3", "90.1,1e3"), "no row for azimuth 90 and 1000 Hz"),
                             (whole.replace("90.0,1e3", "95.0,1e3"), "second value for azimuth 95"),
                             (whole.replace("90.0,1e3", "90.0,1"), "no row for azimuth 90"),
                             (whole.replace("95.0,1e3,", "95.0,1e3,nan"), ":20: 'target_strength_db' is 'nan"),
                             (whole.replace("90.0,1e3,", "90.0,1e3,-inf#"), "a finite number was expected"),
                             (whole.replace("90.0,1e3,", "90.0\n#"), "a finite number was expected")):
        assert damage != whole
        file.write_text(damage)
        entry = suite.entry()
        assert not entry["agrees"] and expected in entry["refused"] and str(file) in entry["refused"], (expected, entry)
    file.write_bytes(b"\xff\xfe\x00")
    assert "cannot read the file" in suite.entry()["refused"]


def test_entries_contain_target_strengths(folder):
    suite = StrengthSuite(folder)
    suite.result(suite.published)
    scene = submission(suite.report(), {}, False)["scenes"]["body"]
    assert scene["agrees"] and scene["measures"]["boundary_db"] == {"value": 0.0, "standard_error": 0.0, "limit": 1, "kept": True}
    assert "aspects" not in scene and "l1_error" not in scene, scene
    from tubefoot_suite.judge import print_report
    print_report(suite.report())


def test_entries_need_a_whole_description(folder):
    suite = Suite(folder, {"samples_moved": 0.25})
    about = pathlib.Path(folder) / "about.json"
    description = {key: "text" for key in REQUIRED} | {"remarks": "none"}
    about.write_text(json.dumps(description))
    entry = submission(suite.report(), read_description(about), False)
    assert entry["suite"] == {"version": "3.0", "set": "debug"} and entry["scenes"]["one"]["agrees"] and entry["engine"] == "text"
    for damage in ("", "[]", json.dumps({**description, "engine": " "}), json.dumps({**description, "score": "1"}),
                   json.dumps({key: "x" for key in list(REQUIRED)[1:]})):
        about.write_text(damage)
        try:
            read_description(about)
            raise AssertionError(damage)
        except Refused as refused:
            assert str(about) in str(refused)


def test_installs_with_pip(folder):
    folder = pathlib.Path(folder)
    if any(importlib.util.find_spec(name) is None for name in ("pip", "setuptools", "wheel")):
        print("skipped: pip, setuptools or wheel are not installed (Debian: python3-pip)")
        return
    source = folder / "source"
    shutil.copytree(REFERENCE / "tubefoot_suite", source / "tubefoot_suite", ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("compare.py", "pyproject.toml"):
        shutil.copy(REFERENCE / name, source)
    done = subprocess.run([sys.executable, "-m", "pip", "install", "--no-build-isolation", "--no-deps", "--no-index", "--quiet",
                           "--target", folder / "installed", source], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    suite = Suite(folder, {"samples_moved": 0.25})
    for words in ([sys.executable, "-m", "tubefoot_suite"], [folder / "installed/bin/tubefoot-suite"]):
        ran = subprocess.run([*words, suite.folder, suite.results], capture_output=True, text=True, cwd=folder,
                             env={"PYTHONPATH": str(folder / "installed")})
        assert ran.returncode == 0 and "differs in: nothing" in ran.stdout, ran


def test_versions_are_the_same():
    import tubefoot_suite
    version = f'version = "{tubefoot_suite.__version__}"'
    assert version in (REFERENCE / "pyproject.toml").read_text()
    assert json.loads((REFERENCE / "datacite.json").read_text())["version"] == tubefoot_suite.__version__


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            if test.__code__.co_argcount:
                with tempfile.TemporaryDirectory() as place:
                    test(place)
            else:
                test()
            print(f"{name}: passed")
