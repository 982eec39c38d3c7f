# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes from files, from dicts and from arrays; what is wrong with them."""

import pickle
import subprocess
import sys
import tomllib

import numpy as np
import pytest

import tubefoot
from conftest import FACETS, SCENE, TETRAHEDRON, VERTICES, equal_energies
from tubefoot._toml import Text

KEYS_WITHOUT_FILES = {
    "materials": [{"name": "sand"}],
    "terrain": {"kind": "flat", "width_m": 20, "length_m": 30, "material": "sand"},
    "trajectories": [{"kind": "fixed", "position_m": [0, 0, 2]}],
    "sensors": [{"name": "camera", "kind": "didson", "tilt_deg": 30}],
}


def test_a_scene_of_a_dict_equals_that_of_its_file(scene, folder, keys):
    built = tubefoot.Scene.from_dict(keys, base=folder)
    assert equal_energies(tubefoot.run(built), tubefoot.run(scene))
    assert (built.title, built.sensors, built.materials) == (scene.title, scene.sensors, scene.materials)
    assert built.pings("camera") == 3 and built.transmissions("camera") == 1


def test_the_text_of_a_dict_is_a_scene_file(folder, keys):
    built = tubefoot.Scene.from_dict(keys, base=folder)
    (folder / "again.toml").write_text(built.to_toml())
    again = tubefoot.load(folder / "again.toml")
    assert again.hash == built.hash
    assert equal_energies(tubefoot.run(again), tubefoot.run(built))


def test_texts_with_all_sorts_of_characters(folder, keys):
    keys["title"] = 'a "quoted" \\ title with an \u00e9 and a \U0001f41f'
    assert tubefoot.Scene.from_dict(keys, base=folder).title == keys["title"]
    keys["title"] = "two\nlines"
    with pytest.raises(tubefoot.InputError, match="title: 'title' must be one line of text"):
        tubefoot.Scene.from_dict(keys, base=folder)


def test_the_text_is_toml_that_says_what_the_keys_say():
    keys = {"text": "".join(map(chr, range(1, 0x250))), "": -0.0, "a b.c": [1, [True, "x"], {"n": 1e300}], "empty": [],
            "none": {}, "tables": [{"deep": {"er": [{"x": 0.1}, {"y": -2**63}]}}, {}], "inf": float("-inf")}
    assert tomllib.loads(str(Text(keys))) == keys


def test_arrays_in_place_of_a_mesh_file(scene, folder, keys):
    keys["objects"][0] = {"name": "thing", "material": "steel", "vertices": VERTICES, "facets": FACETS}
    built = tubefoot.Scene.from_dict(keys, base=folder)
    assert equal_energies(tubefoot.run(built), tubefoot.run(scene))
    keys["objects"][0]["vertices"] = VERTICES + [0, 0, 0.5]
    other = tubefoot.Scene.from_dict(keys, base=folder)
    assert other.hash != built.hash and not equal_energies(tubefoot.run(other), tubefoot.run(scene))


def test_arrays_are_placed_as_objects_are(folder, keys):
    keys["objects"][0].update(heading_deg=30, scale=[2, 1, 1], position_m=[0.5, 0, 0])
    file = tubefoot.run(tubefoot.Scene.from_dict(keys, base=folder))
    for key in ("shape", "file"):
        del keys["objects"][0][key]
    keys["objects"][0].update(vertices=VERTICES, facets=FACETS)
    assert equal_energies(tubefoot.run(tubefoot.Scene.from_dict(keys, base=folder)), file)


def test_heights_are_a_terrain(folder, keys):
    flat = tubefoot.run(tubefoot.Scene.from_dict(keys, base=folder))
    keys["terrain"] = {"material": "sand", "heights": np.zeros((4, 3)), "cell_m": 10, "origin_m": (-10, -15)}
    heights = tubefoot.run(tubefoot.Scene.from_dict(keys, base=folder))
    for name in flat:
        assert np.allclose(heights[name].energy, flat[name].energy, rtol=1e-9, atol=0)


def test_heights_lie_from_south_to_north_and_west_to_east_with_holes(folder, keys):
    heights = np.arange(12.0).reshape(3, 4)
    heights[2, 3] = np.nan
    keys["terrain"] = {"material": "sand", "heights": heights, "cell_m": 2, "origin_m": (-3, -20)}
    transmission = tubefoot.transmission(tubefoot.Scene.from_dict(keys, base=folder), "camera")
    bed = transmission.facets[transmission.component == 0]
    assert len(bed) == 2 * 6 - 2  # both of a cell touch its north-east corner
    corners = {tuple(v) for v in transmission.vertices_m[np.unique(bed)].round(3)}
    assert corners == {(-3 + 2 * x, -20 + 2 * y, heights[y, x]) for y in range(3) for x in range(4)
                       if (y, x) != (2, 3)}
    sides = transmission.vertices_m[bed]
    assert (np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])[:, 2] > 0).all()  # face up


@pytest.mark.parametrize("wrong, text", [
    ({"vertices": VERTICES}, "objects[0]: 'vertices' and 'facets' need each other: give both"),
    ({"vertices": VERTICES[:, :2], "facets": FACETS},
     "objects[0].vertices: expected an array of shape (n, 3), not (4, 2)"),
    ({"vertices": VERTICES, "facets": FACETS + 1},
     "objects[0].facets: vertex indices must be 0 to 3, not 1 to 4"),
    ({"vertices": VERTICES, "facets": FACETS - 1},
     "objects[0].facets: vertex indices must be 0 to 3, not -1 to 2"),
    ({"vertices": VERTICES, "facets": FACETS * 1.0}, "objects[0].facets: expected integers, not float64"),
    ({"vertices": VERTICES * np.nan, "facets": FACETS}, "objects[0].vertices: expected finite numbers, but row 0, column 0 is nan"),
    ({"vertices": VERTICES, "facets": FACETS, "shape": "box"}, "objects[0]: 'shape' and arrays exclude each other: leave out one of them"),
    ({"heights": np.zeros((2, 2))}, "objects[0]: 'heights' needs a terrain without 'vertices' and 'facets'"),
])
def test_wrong_arrays(folder, keys, wrong, text):
    keys["objects"][0] = {"name": "thing", "material": "steel", **wrong}
    with pytest.raises(tubefoot.UsageError) as error:
        tubefoot.Scene.from_dict(keys, base=folder)
    assert str(error.value) == text


@pytest.mark.parametrize("path, change, text", [
    ("sensors[0].beams", lambda k: k["sensors"][0].update(beams=0), "sensors[0].beams: "),
    ("sensors[1].rangemax", lambda k: k["sensors"][1].update(rangemax=3), "sensors[1].rangemax: "),
    ("water.ph", lambda k: k["water"].update(ph="acid"), "water.ph: "),
    ("objects[0].file", lambda k: k["objects"][0].update(file="gone.obj"), "objects[0].file: "),
    ("materials[1].name", lambda k: k["materials"][1].update(name="sand"), "already used at materials[0].name"),
    ("objects[0].material", lambda k: k["objects"][0].update(material="stele"), 'did you mean "steel"?'),
])
def test_errors_name_the_path_of_the_key(folder, keys, path, change, text):
    change(keys)
    with pytest.raises(tubefoot.InputError) as error:
        tubefoot.Scene.from_dict(keys, base=folder)
    assert error.value.key == path
    assert str(error.value).startswith(path + ": ") and text in str(error.value)


def test_errors_of_loading_name_the_path_of_the_key_too(folder, keys):
    keys["sensors"][0]["pings"] = 50
    built = tubefoot.Scene.from_dict(keys, base=folder)
    for call in (tubefoot.run, tubefoot.reference, lambda s: tubefoot.history(s, "side"), lambda s: s.warnings()):
        with pytest.raises(tubefoot.InputError) as error:
            call(built)
        assert error.value.key == "sensors[0]"
        assert "is at " in str(error.value) and "outside of its trajectory" in str(error.value)


@pytest.mark.parametrize("value", [object(), b"bytes", 1 << 70, {1: 2}, [None]])
def test_values_that_no_scene_holds(keys, value):
    keys["title"] = value
    with pytest.raises(tubefoot.UsageError, match="title"):
        tubefoot.Scene.from_dict(keys)


@pytest.mark.parametrize("old, new", [
    ("beams = 8", "beams = many"),
    ("beams = 8", 'beams = "many"'),
    ("beams = 8", "beems = 8"),
    ("thing.obj", "nothing.obj"),
    ("pings = 3", "pings = 300"),
])
def test_input_errors_say_what_the_command_says(folder, program, old, new):
    file = folder / "wrong.toml"
    file.write_text((folder / "scene.toml").read_text().replace(old, new, 1))
    said = program("check", file, fails=True)
    with pytest.raises(tubefoot.InputError) as error:
        tubefoot.run(tubefoot.load(file))
    assert str(error.value) == said
    assert error.value.file == str(file)
    assert said.startswith(f"{file}:{error.value.line}:{error.value.column}: ") and error.value.line > 0
    again = pickle.loads(pickle.dumps(error.value))
    assert (str(again), again.file, again.line) == (said, error.value.file, error.value.line)


def test_a_file_that_is_not_there(folder, program):
    said = program("check", folder / "none.toml", fails=True)
    with pytest.raises(tubefoot.InputError) as error:
        tubefoot.load(folder / "none.toml")
    assert str(error.value) == said
    assert (error.value.line, error.value.column, error.value.key) == (0, 0, "")


def test_a_confined_scene_reads_nothing_outside_of_its_folder(folder, keys, tmp_path_factory):
    elsewhere = tmp_path_factory.mktemp("elsewhere") / "other.obj"
    elsewhere.write_text(TETRAHEDRON)
    inside, outside = folder / "inside.toml", folder / "outside.toml"
    inside.write_text(SCENE)
    outside.write_text(SCENE.replace("thing.obj", str(elsewhere)))
    assert tubefoot.load(inside, confined=True).hash == tubefoot.load(inside).hash
    assert any("lies outside of the scene's folder" in warning for warning in tubefoot.load(outside).warnings())
    with pytest.raises(tubefoot.InputError, match="lies outside of the scene's folder"):
        tubefoot.load(outside, confined=True)


def test_gdal_of_the_program_around_it_stays_as_it_is(folder):
    gdal = pytest.importorskip("osgeo.gdal")
    gdal.UseExceptions()
    (folder / "grid.asc").write_text("ncols 3\nnrows 3\nxllcorner -15\nyllcorner -15\ncellsize 10\n" + "0 0 0\n" * 3)
    flat = next(line for line in SCENE.splitlines() if line == 'kind = "flat"')
    scene = SCENE.replace(flat, 'kind = "raster"\nfile = "grid.asc"', 1)
    scene = "\n".join(line for line in scene.splitlines() if not line.startswith(("width_m", "length_m")))
    (folder / "raster.toml").write_text(scene)
    assert tubefoot.load(folder / "raster.toml").pings("camera") == 3
    other = str(folder / "other.tif")
    gdal.Translate(other, str(folder / "grid.asc"))
    gdal.FileFromMemBuffer("/vsimem/zip/one.tif", open(other, "rb").read())
    assert gdal.Open(other).RasterXSize == gdal.Open("/vsimem/zip/one.tif").RasterXSize == 3
    assert "other.tif" in gdal.ReadDir(str(folder))


def test_a_deleted_current_folder_is_named(folder):
    (folder / "gone").mkdir()
    script = f"""
import os, pickle, tubefoot, warnings
os.chdir({str(folder / 'gone')!r})
os.rmdir({str(folder / 'gone')!r})
scene = tubefoot.load({str(folder / 'scene.toml')!r})
near = tubefoot.Scene.from_dict({{**{KEYS_WITHOUT_FILES!r}, "title": "near"}})
result = tubefoot.run(scene, output={str(folder / 'out')!r})
calls = [lambda: tubefoot.run(scene, output="here"), lambda: tubefoot.coverage(scene, output="here.csv"),
         lambda: tubefoot.chart(scene, output="here"), lambda: result["camera"].picture().save("here.png"),
         lambda: pickle.dumps(near), lambda: tubefoot.load("here.toml"), lambda: tubefoot.open("here")]
for call in calls:
    try:
        call()
    except (tubefoot.UsageError, tubefoot.InputError) as error:
        print(error)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    said = done.stdout.splitlines()
    assert len(said) == 7 and "filesystem error" not in done.stdout
    deleted = "the current folder has been deleted, so the relative name cannot be resolved"
    assert all(deleted in line for line in said[:5]) and all(line.startswith("here") for line in said[5:])
