# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs and references against the files that the command writes."""

import gc
import signal
import subprocess
import sys
import threading
import time
import warnings

import netCDF4
import numpy as np
import pytest
import xarray

import tubefoot
from conftest import equal_energies, said_by
from tubefoot._words import in_python


def test_energies_are_those_of_the_commands_file(scene, folder, program):
    program("run", folder / "scene.toml", "-o", folder / "out")
    result = tubefoot.run(scene)
    with netCDF4.Dataset(folder / "out" / "echoes.nc") as file:
        assert list(result) == list(file.groups) == ["camera", "side"]
        for name, group in file.groups.items():
            assert result[name].energy.tobytes() == group["energy"][:].filled().tobytes()
            assert result[name].energy.sum() > 0
            assert (result[name].times == group["ping_time"][:]).all()
            assert (result[name].slant_ranges == group["slant_range"][:]).all()
            poses = np.column_stack([group["sensor_position"], group["sensor_heading"], group["sensor_pitch"],
                                     group["sensor_roll"]])
            assert (result[name].poses == poses).all()
    assert result["camera"].energy.shape == (3, 8, 64)
    assert result["camera"].altitudes == pytest.approx([2, 2, 2], abs=1e-5)


def test_labels_go_by_a_level_below_the_patterns_peak(folder, program):
    text = (folder / "scene.toml").read_text()
    scene = folder / "scene.toml"
    scene.write_text(text.replace("beams = 8\n", 'beams = 8\nreceive_pattern = "line"\nreceive_aperture_m = 0.1\n'))
    program("run", folder / "scene.toml", "-o", folder / "out", "--labels", "--label-level", "3")
    result = tubefoot.run(scene, labels=True, label_level=3, output=folder / "module")
    assert (folder / "module" / "echoes.nc").read_bytes() == (folder / "out" / "echoes.nc").read_bytes()
    whole = tubefoot.run(scene, labels=True, label_level=1000)
    for name in result:
        few, all_ = result[name].labels["object_label"], whole[name].labels["object_label"]
        assert ((few >= 0) <= (all_ >= 0)).all()
        assert (result[name].labels["object_share"] == whole[name].labels["object_share"]).all()
    with pytest.raises(tubefoot.UsageError, match="label_level"):
        tubefoot.run(scene, label_level=3)
    with pytest.raises(tubefoot.UsageError, match="label_level"):
        tubefoot.run(scene, labels=True, label_level=-3)


def test_whose_energies_are_is_what_the_commands_file_says(scene, folder, program):
    program("run", folder / "scene.toml", "-o", folder / "out", "--labels")
    result = tubefoot.run(scene, labels=True, output=folder / "module")
    assert tubefoot.run(scene)["camera"].labels is None
    with netCDF4.Dataset(folder / "out" / "echoes.nc") as file:
        for name, group in file.groups.items():
            labels = result[name].labels
            assert labels["objects"] == list(group["object_name"][:])
            assert labels["materials"] == list(group["material_name"][:]) == ["sand", "steel"]
            for variable in ("object_share", "material_share", "mean_height", "mean_range"):
                fill = np.nan if variable.startswith("mean") else 0
                np.testing.assert_array_equal(labels[variable], group[variable][:].filled(fill))
            assert (labels["object_label"] == group["object_label"][:].filled(-1)).all()
            heard = result[name].energy > 0
            assert labels["object_share"].sum(axis=1)[heard] == pytest.approx(1, abs=1e-14)
    assert {0, 1} <= set(np.unique(result["camera"].labels["object_label"]))
    assert (folder / "module" / "echoes.nc").read_bytes() == (folder / "out" / "echoes.nc").read_bytes()
    read = tubefoot.open(folder / "out")["camera"].labels
    for name, values in result["camera"].labels.items():
        np.testing.assert_array_equal(read[name], values)
        if not isinstance(values, list):
            assert read[name].dtype == values.dtype
            np.testing.assert_array_equal(tubefoot.open(folder / "out")["camera"][1:].labels[name], values[1:])
            np.testing.assert_array_equal(result["camera"][1:].labels[name], values[1:])


def test_the_former_name_of_labels_warns(scene):
    with pytest.warns(DeprecationWarning, match="'truth' is now 'labels'"):
        result = tubefoot.run(scene, truth=True)
    with pytest.warns(DeprecationWarning, match="'labels'"):
        former = result["camera"].truth
    np.testing.assert_array_equal(former["object_label"], result["camera"].labels["object_label"])
    with pytest.raises(TypeError, match="'labels' and its former name 'truth'"):
        tubefoot.run(scene, truth=True, labels=False)


def test_an_output_folder_is_the_commands_byte_by_byte(scene, folder, program):
    program("run", folder / "scene.toml", "-o", folder / "command")
    tubefoot.run(scene, output=folder / "module")
    names = sorted(p.name for p in (folder / "command").iterdir())
    assert names == sorted(p.name for p in (folder / "module").iterdir())
    assert "echoes.nc" in names and any(n.endswith(".png") for n in names)
    for name in names:
        if name != "stats.json":  # tells seconds
            assert (folder / "module" / name).read_bytes() == (folder / "command" / name).read_bytes(), name


@pytest.mark.parametrize("options, arguments", [
    (dict(engine="ray", rays_per_beam=50, sampling="random", seed=7),
     ["--engine", "ray", "--rays-per-beam", 50, "--sampling", "random", "--seed", 7]),
    (dict(binning="centroid", threads=1), ["--binning", "centroid", "--threads", 1]),
    (dict(tolerance="1dB"), ["--tolerance", "1dB"]),
    (dict(arithmetic="rational"), ["--arithmetic", "rational"]),
])
def test_options_are_those_of_the_command(scene, folder, program, options, arguments):
    program("run", folder / "scene.toml", "-o", folder / "out", *arguments)
    result = tubefoot.run(scene, **options)
    with netCDF4.Dataset(folder / "out" / "echoes.nc") as file:
        for name, group in file.groups.items():
            assert result[name].energy.tobytes() == group["energy"][:].filled().tobytes()
        assert result["side"].to_xarray().attrs["engine"] == file.engine


def test_threads_do_not_change_energies(scene):
    assert equal_energies(tubefoot.run(scene, threads=1), tubefoot.run(scene, threads=4))


def test_a_reference_has_the_commands_bounds(scene, folder, program):
    program("run", folder / "scene.toml", "--reference", "--tolerance", "1e-6", "-o", folder / "out")
    result = tubefoot.reference(scene, 1e-6)
    assert result.stats["reference"]["tolerance"] == 1e-6
    plain = tubefoot.run(scene)
    with netCDF4.Dataset(folder / "out" / "echoes.nc") as file:
        for name, group in file.groups.items():
            assert result[name].energy_bound.tobytes() == group["energy_bound"][:].filled().tobytes()
            assert result[name].energy.tobytes() == group["energy"][:].filled().tobytes()
            assert (np.abs(plain[name].energy - result[name].energy)
                    <= result[name].energy_bound + 1e-9 * result[name].energy).all()
    assert plain["camera"].energy_bound is None


def test_datasets_are_laid_out_as_the_file(scene, folder):
    result = tubefoot.reference(scene, 1e-6, output=folder / "out")
    path = folder / "out" / "echoes.nc"
    for name, dataset in result.to_xarray().items():
        root = xarray.open_dataset(path)
        file = xarray.open_dataset(path, group=name, decode_coords=False)
        assert dataset.attrs == {**root.attrs, **file.attrs}
        plain = dataset.reset_coords()
        assert set(plain.variables) == set(file.variables)
        for variable in plain.variables:
            expected = file[variable].variable
            expected.attrs.pop("coordinates", None)  # xarray keeps these itself
            xarray.testing.assert_identical(plain[variable].variable, expected)
        assert {"ping_time", "slant_range", "beam_azimuth"} <= set(dataset.coords)
        assert dataset["energy"].dims == ("ping", "beam", "sample") and dataset["energy"].units == "J m-2"


def test_datasets_of_a_place_on_earth_say_where_and_when(folder):
    path = folder / "placed.toml"
    path.write_text((folder / "scene.toml").read_text()
                    + '[georeference]\ncrs = "EPSG:32633"\norigin_crs = [614000, 7770000]\n')
    result = tubefoot.run(tubefoot.load(path), output=folder / "placed")
    with xarray.open_dataset(folder / "placed" / "echoes.nc", group="side", decode_coords=False) as file:
        dataset = result["side"].to_xarray()
        for name in ("sensor_longitude", "sensor_latitude", "sensor_height", "sensor_true_heading", "ping_utc"):
            xarray.testing.assert_identical(dataset.reset_coords()[name].variable, file[name].variable)
    assert dataset.ping_utc.values[0] == np.datetime64("2000-01-01") + np.timedelta64(
        round(1e9 * float(dataset.ping_time[0])), "ns")
    # Meridians converge at the zone's edge.
    turned = dataset.sensor_true_heading - dataset.sensor_heading
    assert np.allclose(np.mod(turned, 360), 2.8, atol=0.02)
    assert "UTM zone 33N" in dataset.attrs["map_crs_wkt"]


def test_arrays_are_the_runs_own_memory(scene):
    result = tubefoot.run(scene)
    sensor = result["camera"]
    again = result._native.arrays(0)["energy"]
    assert sensor.energy.ctypes.data == again.ctypes.data
    assert np.shares_memory(sensor.energy, sensor.to_xarray()["energy"].values)
    assert sensor.energy.base is not None and not sensor.energy.flags.owndata
    assert np.shares_memory(sensor.positions, result._native.arrays(0)["sensor_position"])
    # Pings of one sensor lie one after the other in one block.
    assert sensor.energy.flags.c_contiguous
    with pytest.raises(ValueError):
        sensor.energy[0, 0, 0] = 1


def test_arrays_outlive_scene_and_result(scene):
    result = tubefoot.run(scene)
    energy, copy = result["camera"].energy, result["camera"].energy.copy()
    del scene, result
    gc.collect()
    for _ in range(3):
        np.full(copy.size, np.nan)  # where the memory would be, had it been let go of
    assert energy.tobytes() == copy.tobytes()


def test_two_receivers(folder):
    text = (folder / "scene.toml").read_text().replace('kind = "sidescan"', 'kind = "interferometric"')
    (folder / "two.toml").write_text(text)
    result = tubefoot.run(tubefoot.load(folder / "two.toml"), output=folder / "out")
    with netCDF4.Dataset(folder / "out" / "echoes.nc") as file:
        side = file["side"]
        cross = side["cross_real"][:].filled() + 1j * side["cross_imag"][:].filled()
        assert (result["side"].cross == cross).all() and np.abs(cross).max() > 0
        assert result["side"].energy.tobytes() == side["energy"][:].filled().tobytes()


def test_a_tolerance_picks_the_settings(scene):
    result = tubefoot.run(scene, tolerance="1dB")
    exact = tubefoot.run(scene)
    assert tubefoot.compare(exact, result)["sensors"][0]["rms_db_error"] < 1.5
    fine = tubefoot.compare(exact, tubefoot.run(scene, tolerance=1e-6))["sensors"]
    assert [s["l1_error"] <= 1e-6 for s in fine] == [True, True]


def test_other_threads_run_meanwhile(scene):
    ticks, over = [], threading.Event()

    def tick():
        while not over.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.002)
    other = threading.Thread(target=tick)
    other.start()
    start = time.perf_counter()
    tubefoot.run(scene, engine="ray", rays=10_000_000, threads=1)
    end = time.perf_counter()
    over.set()
    other.join()
    inside = [t for t in ticks if start < t < end]
    # Seconds long; with the lock held, at most the moments before and after would be in here.
    assert len(inside) >= 10 and max(np.diff(inside), default=1) < (end - start) / 2


def test_runs_in_several_threads_are_each_their_own(scene):
    expected = {e: tubefoot.run(scene, engine=e, rays=3000 if e == "ray" else None) for e in ("tube", "ray")}
    found = {}

    def one(i, e):
        found[i] = (e, tubefoot.run(scene, engine=e, rays=3000 if e == "ray" else None))
    threads = [threading.Thread(target=one, args=(i, e)) for i, e in enumerate(["tube", "ray"] * 3)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert len(found) == 6
    assert all(equal_energies(result, expected[e]) for e, result in found.values())


def test_progress_counts_pings(scene):
    seen = []
    tubefoot.run(scene, progress=lambda done, total: seen.append((done, total)))
    assert seen[-1] == (5, 5) and seen == sorted(seen)


def test_what_progress_raises_ends_the_run_and_leaves_nothing(scene, folder):
    class Enough(Exception):
        pass

    def stop(done, total):
        raise Enough
    before = sorted(folder.iterdir())
    with pytest.raises(Enough):
        tubefoot.run(scene, engine="ray", rays=500_000, threads=1, output=folder / "out", progress=stop)
    assert sorted(folder.iterdir()) == before


def test_ctrl_c_ends_a_run_and_leaves_nothing(folder):
    before = sorted(folder.iterdir())
    script = f"""
import sys, tubefoot
scene = tubefoot.load({str(folder / 'scene.toml')!r})
def told(done, total):
    print(done, flush=True)
try:
    # Four more pings, of the better part of a second each, to be interrupted in.
    tubefoot.run(scene, engine="ray", rays=20_000_000, threads=1, output={str(folder / 'out')!r}, progress=told)
except KeyboardInterrupt:
    tubefoot.run(scene)  # and another one works
    sys.exit(42)
"""
    child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline().strip() == "1"
    child.send_signal(signal.SIGINT)
    child.communicate(timeout=300)
    assert child.returncode == 42
    assert sorted(folder.iterdir()) == before


def test_ctrl_c_ends_a_ping_in_its_middle(folder):
    script = f"""
import sys, tubefoot
scene = tubefoot.load({str(folder / 'scene.toml')!r})
print("begun", flush=True)
try:
    tubefoot.run(scene, engine="ray", rays=10_000_000_000)  # a ping takes many minutes
except KeyboardInterrupt:
    tubefoot.run(scene)  # and another one works
    sys.exit(42)
"""
    child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    try:
        assert child.stdout.readline().strip() == "begun"
        time.sleep(1)
        child.send_signal(signal.SIGINT)
        child.communicate(timeout=60)
        assert child.returncode == 42
    finally:
        child.kill()


@pytest.mark.parametrize("options, text", [
    (dict(engine="tubes"), "engine: 'tubes' is not 'tube' or 'ray': did you mean 'tube'?"),
    (dict(engine="magic"), "engine: 'magic' is not 'tube' or 'ray'"),
    (dict(binning="centroids"), "binning: 'centroids' is not 'exact', 'spread' or 'centroid': did you mean 'centroid'?"),
    (dict(threads=0), "threads: 0 is not within 1 to 4096"),
    (dict(engine="ray", rays=1e6), "rays: expected a whole number, not 1000000.0"),
    (dict(threads="2"), "threads: expected a whole number, not '2'"),
    (dict(rays=10, rays_per_beam=10), "rays and rays_per_beam exclude each other: leave out one of them"),
    (dict(output=""), "output: the name of a folder is empty"),
])
def test_wrong_options(scene, options, text):
    with pytest.raises(tubefoot.UsageError, match="") as error:
        tubefoot.run(scene, **options)
    assert str(error.value) == text and isinstance(error.value, ValueError)


def test_a_file_name_is_a_scene(scene, folder):
    file = folder / "scene.toml"
    plain = tubefoot.run(scene)
    assert equal_energies(tubefoot.run(file), plain) and equal_energies(tubefoot.run(str(file)), plain)
    assert equal_energies(tubefoot.reference(file, 1e-6), tubefoot.reference(scene, 1e-6))
    assert (tubefoot.footprints(file, "camera")["area_m2"] == tubefoot.footprints(scene, "camera")["area_m2"]).all()
    assert (tubefoot.transmission(str(file), "side", ping=1).apex_m == tubefoot.transmission(scene, "side", ping=1).apex_m).all()
    assert len(tubefoot.history(file, "camera")) == len(tubefoot.history(scene, "camera"))
    assert tubefoot.chart([file], "tube", repeats=1)[0]["scene"] == tubefoot.chart(file, "tube", repeats=1)[0]["scene"]


def test_what_is_neither_scene_nor_name(scene):
    for call in (tubefoot.run, tubefoot.reference, lambda s: tubefoot.chart([s]), tubefoot.coverage,
                 lambda s: tubefoot.advise(s, 1e-3), lambda s: tubefoot.footprints(s, "camera"),
                 lambda s: tubefoot.history(s, "camera"), lambda s: tubefoot.transmission(s, "camera")):
        with pytest.raises(TypeError, match="expected a tubefoot.Scene or the name of a scene file, not (Result|dict)"):
            call({} if call is not tubefoot.run else tubefoot.run(scene))
    with pytest.raises(tubefoot.InputError, match="none.toml: there is no such scene file"):
        tubefoot.run("none.toml")


@pytest.mark.parametrize("arguments, call", [
    (["--tolerance", "1e-3", "--binning", "spread"], lambda s: tubefoot.run(s, tolerance="1e-3", binning="spread")),
    (["--tolerance", "1e-09"], lambda s: tubefoot.run(s, tolerance=1e-9)),
    (["--tolerance", "much"], lambda s: tubefoot.run(s, tolerance="much")),
    (["--reference", "--tolerance", "0.5"], lambda s: tubefoot.reference(s, 0.5)),
    (["--reference", "--arithmetic", "double"], lambda s: tubefoot.reference(s, arithmetic="double")),
    (["--rays-per-beam", "10"], lambda s: tubefoot.run(s, rays_per_beam=10)),
])
def test_usage_errors_say_what_the_command_says_in_pythons_words(scene, folder, program, arguments, call):
    said = program("run", folder / "scene.toml", "-o", folder / "out", *arguments, fails=True)
    with pytest.raises(tubefoot.UsageError) as error:
        call(scene)
    assert in_python(said) == "tubefoot: " + str(error.value)
    assert "--" in said and "--" not in str(error.value)


def test_a_strangers_folder_is_not_overwritten(scene, folder, program):
    (folder / "mine").mkdir()
    (folder / "mine" / "letter.txt").write_text("dear")
    said = program("run", folder / "scene.toml", "-o", folder / "mine", fails=True)
    with pytest.raises(tubefoot.UsageError) as error:
        tubefoot.run(scene, output=folder / "mine")
    assert said == "tubefoot: " + str(error.value)


def test_results_name_their_sensors(scene):
    result = tubefoot.run(scene)
    with pytest.raises(KeyError, match="no sensor 'sonar'; it has 'camera', 'side'\""):
        result["sonar"]
    with pytest.raises(KeyError, match="it has 'camera', 'side': did you mean 'camera'\\?"):
        result["camra"]
    assert len(result) == 2 and result.stats["pings"] == 5
    assert repr(result["side"]) == "<tubefoot.SensorResult 'side': 2 pings x 2 beams x 100 samples>"


def test_warnings_are_warnings(folder):
    (folder / "inside.toml").write_text((folder / "scene.toml").read_text().replace(
        'name = "thing"\nshape = "mesh"\nfile = "thing.obj"', 'name = "ball"\nshape = "sphere"\nradius_m = 3'))
    with pytest.warns(tubefoot.SceneWarning, match="is inside object 'ball'") as caught:
        result = tubefoot.run(tubefoot.load(folder / "inside.toml"))
    assert caught[0].filename == __file__
    assert result.warnings and result.warnings[0] in str(caught[0].message)


def silent_scene(folder):
    """One of two sensors looks up."""
    text = (folder / "scene.toml").read_text()
    (folder / "silent.toml").write_text(text.replace("tilt_deg = 30", "tilt_deg = -40", 1))
    return folder / "silent.toml"


def test_a_silent_sensor_is_a_warning_of_its_own_with_the_commands_words(folder):
    file = silent_scene(folder)
    with pytest.warns(tubefoot.SilenceWarning) as caught:
        result = tubefoot.run(file)
    silences = [w for w in caught if w.category is tubefoot.SilenceWarning]
    assert len(silences) == 1 and silences[0].filename == __file__
    text = str(silences[0].message)
    assert "sensor 'camera' receives nothing" in text and "degrees up" in text
    assert "warning: " + text in said_by("run", file, "-o", folder / "out")
    assert "warning: " + text in said_by("check", file)
    assert text in result.warnings and text in tubefoot.load(file).warnings()
    assert result.stats["warnings"].count(text) == 1
    assert (result["camera"].energy == 0).all() and result["side"].energy.any()


def test_a_silence_that_is_an_error_ends_the_run_before_its_first_ping(folder):
    seen, before = [], sorted(folder.iterdir())
    with warnings.catch_warnings():
        warnings.simplefilter("error", tubefoot.SilenceWarning)
        with pytest.raises(tubefoot.SilenceWarning, match="receives nothing"):
            tubefoot.run(silent_scene(folder), engine="ray", rays=2_000_000, threads=1, output=folder / "out",
                         progress=lambda done, total: seen.append(done))
    assert len(seen) < 5 and sorted(folder.iterdir()) == sorted([*before, folder / "silent.toml"])


def test_a_silence_of_a_scene_in_code_names_its_key(folder, keys):
    keys["sensors"][0]["tilt_deg"] = -40
    scene = tubefoot.Scene.from_dict(keys, base=folder)
    with pytest.warns(tubefoot.SilenceWarning, match=r"^sensors\[0\]: sensor 'camera' receives nothing"):
        result = tubefoot.run(scene)
    assert result.warnings == [w for w in scene.warnings() if "receives nothing" in w]


def test_a_scene_that_is_heard_warns_of_nothing(scene):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert tubefoot.run(scene).warnings == []


def test_hdf5_says_nothing_beside_another_user_of_netcdf(folder):
    script = f"""
import netCDF4, tubefoot
netCDF4.Dataset({str(folder / 'other.nc')!r}, "w").close()
scene = tubefoot.load({str(folder / 'scene.toml')!r})
tubefoot.run(scene, output={str(folder / 'first')!r})
tubefoot.run(scene, output={str(folder / 'second')!r})
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert "HDF5" not in done.stderr


def test_a_thousand_ray_results_can_be_held(keys, folder):
    keys["sensors"] = [{**keys["sensors"][0], "beams": 1, "samples": 8, "pings": 1}]
    scene = tubefoot.Scene.from_dict(keys, base=folder)
    held = [tubefoot.run(scene, engine="ray", rays=10)["camera"].energy for _ in range(1100)]
    assert (held[0] == held[-1]).all() and held[0].sum() > 0
