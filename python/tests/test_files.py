# SPDX-License-Identifier: GPL-3.0-or-later
"""netCDF files that the program writes, opened by netCDF4 to be changed."""

import netCDF4
import numpy as np
import pytest

import tubefoot
from conftest import SCENE

MORE_KINDS = """
[georeference]
origin_lat_lon_deg = [59.44, 10.58]

[[sensors]]
name = "elements"
kind = "array"
tilt_deg = 40
frequency_khz = 300
bandwidth_khz = 20
pulse_length_us = 200
range_min_m = 1
range_max_m = 6
horizontal_deg = 30
vertical_deg = 40
receivers = 3
pings = 2
ping_interval_s = 0.2

[[sensors]]
name = "swath"
preset = "reson-8101"
pings = 2
ping_interval_s = 0.2
range_max_m = 10
samples = 100
"""


def groups_of(group):
    yield group
    for inner in group.groups.values():
        yield from groups_of(inner)


def change(file):
    """Opens a file with r+, changes an attribute of it and of a variable and a number of every variable of numbers. Returns
    what each variable holds then, by its path."""
    expected = {}
    with netCDF4.Dataset(file, "r+") as dataset:
        dataset.set_auto_mask(False)
        for group in groups_of(dataset):
            group.set_auto_mask(False)
            group.setncattr("title", "changed")
            for name, variable in group.variables.items():
                if variable.dtype is str or variable._isvlen or variable._iscompound or variable._isenum or not variable.size:
                    continue
                variable.setncattr("comment", "mine")
                values = variable[...]
                values.flat[-1] = 7
                variable[...] = values
                expected[f"{group.path}/{name}"] = values
    return expected


def written(folder, program):
    """A netCDF file of every kind that the program writes."""
    (folder / "kinds.toml").write_text(SCENE + MORE_KINDS)
    program("run", folder / "kinds.toml", "-o", folder / "kinds")
    program("run", folder / "scene.toml", "-o", folder / "one", "--sensor", "camera")
    program("run", folder / "scene.toml", "-o", folder / "labels", "--labels")
    program("run", folder / "scene.toml", "-o", folder / "bounds", "--reference", "--tolerance", "1e-3")
    program("footprints", folder / "scene.toml", "--sensor", "camera", "-o", folder / "footprints.nc")
    program("strength", folder / "thing.obj", "--frequencies", "5kHz", "-o", folder / "strength.nc")
    return sorted(folder.rglob("*.nc"))


@pytest.fixture
def files(folder, program):
    return written(folder, program)


def test_every_netcdf_file_can_be_changed(files):
    names = {file.name for file in files}
    assert {"echoes.nc", "elements-signals.nc", "swath-sonar.nc", "footprints.nc", "strength.nc"} <= names
    for file in files:
        expected = change(file)
        assert expected, file
        with netCDF4.Dataset(file) as dataset:
            assert dataset.title == "changed", file
            for path, values in expected.items():
                variable = dataset[path]
                variable.set_auto_mask(False)
                assert variable.comment == "mine"
                np.testing.assert_array_equal(variable[...], values)


def test_a_changed_echo_file_is_read_by_tubefoot(folder, program):
    program("run", folder / "scene.toml", "-o", folder / "out")
    with netCDF4.Dataset(folder / "out/echoes.nc", "r+") as file:
        file["camera"]["energy"][1, 2, 3] = 0.5
        file["camera"].createVariable("mine", "f8", ("ping",))[:] = [1, 2, 3]
        file["camera"]["mine"].units = "1"
    echoes = tubefoot.open(folder / "out")["camera"]
    assert echoes.energy[1, 2, 3] == 0.5
    assert echoes.to_xarray()["mine"].values.tolist() == [1, 2, 3]
