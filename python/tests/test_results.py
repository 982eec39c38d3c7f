# SPDX-License-Identifier: GPL-3.0-or-later
"""Results that are opened, and pings of them; scenes on their way to other processes."""

import copy
import pickle
import subprocess
import sys

import netCDF4
import numpy as np
import pytest
import xarray

import tubefoot
from conftest import FACETS, VERTICES, equal_energies

ARRAYS = ("energy", "times", "positions", "attitudes", "poses", "slant_ranges", "slant_range_bounds", "beam_azimuths",
          "beam_elevations", "pings")


@pytest.fixture
def result(scene, folder):
    return tubefoot.run(scene, output=folder / "out")


@pytest.mark.parametrize("place", ["out", "out/echoes.nc"])
def test_an_opened_result_is_the_runs(result, folder, place):
    again = tubefoot.open(folder / place)
    assert isinstance(again, tubefoot.Result) and list(again) == ["camera", "side"]
    for name in again:
        for array in ARRAYS:
            mine, runs = getattr(again[name], array), getattr(result[name], array)
            assert mine.tobytes() == runs.tobytes() and mine.shape == runs.shape and mine.dtype == runs.dtype, array
            assert not mine.flags.writeable or array in ("poses", "pings")
        assert (again[name].name, again[name].kind) == (name, result[name].kind)
        assert again[name].energy_bound is None and np.isnan(again[name].altitudes).all()
        xarray.testing.assert_identical(again[name].to_xarray(), result[name].to_xarray())
        assert again[name].picture().pixels.any()  # without the grey where no surface is, which a file does not know
    assert again.stats == (result.stats if place == "out" else {})
    assert again.warnings == (result.warnings if place == "out" else [])
    assert tubefoot.compare(result, again)["sensors"][0]["l1_error"] == 0
    assert tubefoot.compare(folder / "out", again)["sensors"][1]["l1_error"] == 0


def test_an_opened_reference_has_its_bounds_and_two_receivers_their_products(folder):
    (folder / "two.toml").write_text((folder / "scene.toml").read_text().replace('"sidescan"', '"interferometric"'))
    result = tubefoot.reference(folder / "two.toml", 1e-6, output=folder / "out")
    again = tubefoot.open(folder / "out")
    for name in ("energy_bound", "energy_lower", "cross"):
        assert getattr(again["side"], name).tobytes() == getattr(result["side"], name).tobytes()
    assert (again["camera"].energy_bound == result["camera"].energy_bound).all()
    assert again["camera"].cross is None


RECEIVER = 'speckle = "rayleigh"\nsource_level_db = 200\nnoise_level_db = 100\n'


def test_received_data_are_those_of_the_file(folder):
    (folder / "noisy.toml").write_text((folder / "scene.toml").read_text() + RECEIVER)
    result = tubefoot.run(folder / "noisy.toml", output=folder / "out")
    again = tubefoot.open(folder / "out")
    assert result["camera"].received is None and again["camera"].received is None
    side = result["side"].received
    assert side.shape == result["side"].energy.shape and side.dtype == np.float64 and not side.flags.writeable
    assert again["side"].received.tobytes() == side.tobytes()
    assert again["side"].received_lower is None and result["side"].received_lower is None
    with netCDF4.Dataset(folder / "out" / "echoes.nc") as file:
        assert file["side"]["received"][:].filled().tobytes() == side.tobytes()
    assert (side > 0).all() and abs(np.mean(side / (result["side"].energy + 1e-10)) - 1) < 5 / np.sqrt(side.size)
    assert (result["side"][1:].received == side[1:]).all()
    assert (tubefoot.run(folder / "noisy.toml", pings=1, sensor="side")["side"].received == side[1]).all()
    assert (tubefoot.run(folder / "noisy.toml", seed=2)["side"].received != side).all()
    xarray.testing.assert_identical(again["side"].to_xarray(), result["side"].to_xarray())
    assert "received" in result["side"].to_xarray() and "received" not in result["camera"].to_xarray()


def test_a_receiver_pair_has_the_received_data_of_both(folder):
    text = (folder / "scene.toml").read_text().replace('"sidescan"', '"interferometric"')
    (folder / "two.toml").write_text(text + RECEIVER)
    result = tubefoot.run(folder / "two.toml", output=folder / "out")
    again = tubefoot.open(folder / "out")
    for name in ("received", "received_lower"):
        assert getattr(again["side"], name).tobytes() == getattr(result["side"], name).tobytes()
    assert (result["side"].received != result["side"].received_lower).any()


def test_warnings_of_a_run_are_kept(folder):
    text = (folder / "scene.toml").read_text().replace("tilt_deg = 30", "tilt_deg = -40", 1)
    (folder / "silent.toml").write_text(text)
    with pytest.warns(tubefoot.SilenceWarning):
        result = tubefoot.run(folder / "silent.toml", output=folder / "out")
    assert tubefoot.open(folder / "out").warnings == result.warnings != []


def test_a_strangers_file_with_the_least_that_it_must_have_and_more_of_its_own(folder):
    with netCDF4.Dataset(folder / "least.nc", "w") as file:
        for name, length in (("ping", 3), ("beam", 2), ("sample", 4), ("colour", 2)):
            file.createDimension(name, length)
        for name, dimensions, units, values in [
                ("energy", ("ping", "beam", "sample"), "J", np.arange(24.0).reshape(3, 2, 4)),
                ("slant_range", ("sample",), "m", [1, 2, 4, 8]), ("beam_azimuth", ("beam",), "degree", [-1, 1]),
                ("share", ("ping", "colour"), "1", np.arange(6.0).reshape(3, 2))]:
            file.createVariable(name, "f8", dimensions).units = units
            file[name][:] = values
        file["share"].long_name = "of each colour"
    echoes = tubefoot.open(folder / "least.nc")["sensor"]
    assert (echoes.energy == np.arange(24).reshape(3, 2, 4)).all() and echoes.kind == ""
    assert np.isnan(echoes.times).all() and echoes.times.shape == (3,)
    assert echoes.poses.shape == (3, 6) and echoes.slant_range_bounds.shape == (4, 2)
    dataset = echoes[1:].to_xarray()
    assert dataset["share"].dims == ("ping", "colour") and dataset["share"].attrs == {"units": "1",
                                                                                    "long_name": "of each colour"}
    assert dataset["share"].values.tolist() == [[2, 3], [4, 5]]
    with pytest.raises(tubefoot.InputError, match="not evenly spaced: sample .* pictures need evenly spaced samples"):
        echoes.picture()
    assert "<img" not in echoes._repr_html_() and "3 pings" in echoes._repr_html_()


def test_what_cannot_be_opened(result, folder):
    for place, text in [("none", "there is no such file"), ("scene.toml", "cannot be read as netCDF")]:
        with pytest.raises(tubefoot.InputError, match=text):
            tubefoot.open(folder / place)
    with pytest.raises(tubefoot.InputError, match="the folder has no echoes.nc: name a result folder of a run"):
        tubefoot.open(folder)
    for wrong in ("{", "[]", '{"warnings": 3}'):
        (folder / "out" / "stats.json").write_text(wrong)
        with pytest.raises(tubefoot.InputError, match="stats.json is not a valid result of a run"):
            tubefoot.open(folder / "out")
    data = (folder / "out" / "echoes.nc").read_bytes()
    (folder / "cut.nc").write_bytes(data[:len(data) // 2])
    with pytest.raises(tubefoot.InputError, match="cut off or damaged"):
        tubefoot.open(folder / "cut.nc")


@pytest.mark.parametrize("pings", [
    slice(1, 3), slice(2, 5), slice(None, None, -1), slice(-2, None), slice(5, 9), [2, 0, -1], (), range(2),
    np.array([True, False, True]), np.array([1, 1], np.uint8),
])
def test_pings_are_counted_as_numpy_counts(result, pings):
    camera = result["camera"]
    part = camera[pings]
    numbers = np.arange(3)[np.array(pings, int) if isinstance(pings, (list, range, tuple)) else pings]
    assert len(part) == len(numbers) and (part.pings == numbers).all()
    for name in ("energy", "times", "positions", "attitudes", "poses", "altitudes"):
        values = getattr(part, name)
        assert values.tobytes() == getattr(camera, name)[numbers].tobytes(), name
        assert name in ("poses", "altitudes") or not values.flags.writeable
    for name in ("slant_ranges", "beam_azimuths"):
        assert getattr(part, name) is getattr(camera, name)
    xarray.testing.assert_identical(part.to_xarray(), camera.to_xarray().isel(ping=numbers))


def test_one_ping_is_a_result_with_one_ping(result):
    camera = result["camera"]
    assert camera[-1].energy.shape == (1, 8, 64) and camera[-1].pings.tolist() == [2]
    assert np.shares_memory(camera[1:].energy, camera.energy) and camera[1:][1].pings.tolist() == [2]
    assert [len(ping) for ping in camera] == [1, 1, 1]
    assert repr(camera[np.int64(1)]) == "<tubefoot.SensorResult 'camera': 1 pings x 8 beams x 64 samples>"
    assert len(camera[0:0]) == 0 and repr(camera[0:0]).endswith("0 pings x 8 beams x 64 samples>")


@pytest.mark.parametrize("pings, error, text", [
    (3, IndexError, "ping 3: sensor 'camera' has pings 0 to 2"),
    (-4, IndexError, "ping -4: sensor 'camera' has pings 0 to 2"),
    ([0, 7], IndexError, "ping 7: sensor 'camera' has pings 0 to 2"),
    ([True, False], IndexError, "there are 2 booleans for 3 pings"),
    ("1", TypeError, "expected a ping, a slice or ping numbers, not str"),
    (1.0, TypeError, "expected a ping, a slice or ping numbers, not float"),
    ([0.5], TypeError, "expected integers as ping numbers, not float64"),
])
def test_wrong_pings(result, pings, error, text):
    with pytest.raises(error) as raised:
        result["camera"][pings]
    assert str(raised.value) == text


def test_a_pickled_scene_runs_elsewhere(scene, folder, keys, tmp_path_factory, monkeypatch):
    keys["objects"][0] = {"name": "thing", "material": "steel", "vertices": VERTICES, "facets": FACETS}
    built = tubefoot.Scene.from_dict(keys, base=folder, name="built")
    monkeypatch.chdir(folder)
    near = tubefoot.load("scene.toml")
    (folder / "scenes").write_bytes(pickle.dumps([scene, built, near]))
    script = f"""
import pickle, tubefoot
for scene in pickle.load(open({str(folder / 'scenes')!r}, "rb")):
    print(scene.hash, tubefoot.run(scene)["camera"].energy.tobytes().hex())
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True,
                          cwd=tmp_path_factory.mktemp("elsewhere"))
    expected = [f"{s.hash} {tubefoot.run(s)['camera'].energy.tobytes().hex()}" for s in (scene, built, near)]
    assert done.stdout.splitlines() == expected
    again = pickle.loads(pickle.dumps(built))
    assert (again.title, again.sensors, again.to_toml()) == (built.title, built.sensors, built.to_toml())
    assert equal_energies(tubefoot.run(again), tubefoot.run(built))
    assert copy.copy(scene) is scene and copy.deepcopy([scene])[0] is scene


def test_a_scene_that_has_changed_since_is_not_taken_for_it(scene, folder):
    kept = pickle.dumps(scene)
    (folder / "thing.obj").write_text((folder / "thing.obj").read_text() + "# other\n")
    with pytest.raises(tubefoot.InputError, match="has changed since it was pickled"):
        pickle.loads(kept)
    (folder / "scene.toml").unlink()
    with pytest.raises(tubefoot.InputError, match="there is no such scene file"):
        pickle.loads(kept)


def test_a_confined_scene_stays_so(folder):
    again = pickle.loads(pickle.dumps(tubefoot.load(folder / "scene.toml", confined=True)))
    assert pickle.loads(pickle.dumps(again))._confined is True


def test_a_run_omits_files_by_name(scene, folder):
    tubefoot.run(scene, output=folder / "whole")
    result = tubefoot.run(scene, output=folder / "some", without=["scene.png", "side.exr"])
    names = {path.name for path in (folder / "whole").iterdir()} - {"scene.png", "side.exr"}
    assert {path.name for path in (folder / "some").iterdir()} == names
    assert result.stats["omitted_files"] == ["scene.png", "side.exr"]
    with pytest.raises(tubefoot.UsageError, match="did you mean 'side.exr'"):
        tubefoot.run(scene, output=folder / "other", without=["sid.exr"])
    with pytest.raises(tubefoot.UsageError, match="add 'output'"):
        tubefoot.run(scene, without=["side.exr"])
