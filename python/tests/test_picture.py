# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of echoes: those of the program, as arrays, files and in notebooks."""

import base64
import re

import netCDF4
import numpy as np
import pytest

import tubefoot
from conftest import SCENE, png_pixels

DOWN = """[[sensors]]
name = "down"
kind = "echosounder"
samples = 80
range_max_m = 6
pings = 4
ping_interval_s = 0.2
[[sensors]]
name = "fan"
kind = "multibeam"
beams = 15
swath_deg = 90
beam_across_deg = 5
samples = 80
range_max_m = 6
pings = 2
[[sensors]]
name = "ahead"
kind = "imaging"
tilt_deg = 20
samples = 60
beams = 12
"""


@pytest.fixture
def result(folder):
    (folder / "all.toml").write_text(SCENE + DOWN)
    return tubefoot.run(folder / "all.toml", output=folder / "out")


def bytes_of(picture, folder):
    picture.save(folder / "saved.png")
    return (folder / "saved.png").read_bytes()


@pytest.mark.parametrize("sensor, ping, file", [
    ("camera", None, "camera-sequence.png"), ("camera", 0, "camera-0000.png"), ("camera", -1, "camera-0002.png"),
    ("side", None, "side.png"), ("down", None, "down.png"), ("ahead", 0, "ahead-0000.png"),
])
def test_a_picture_is_the_programs_file(result, folder, sensor, ping, file):
    assert bytes_of(result[sensor].picture(ping), folder) == (folder / "out" / file).read_bytes()


def test_a_notebook_shows_the_pixels_of_the_array(result):
    picture = result["side"].picture()
    pixels = picture.pixels
    assert pixels.dtype == np.uint8 and pixels.ndim == 3 and pixels.shape[2] == 3
    assert (png_pixels(picture._repr_png_()) == pixels).all()
    assert np.asarray(picture).tobytes() == pixels.tobytes() and np.asarray(picture, float).dtype == float
    assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 50  # something is drawn
    with pytest.raises(ValueError):
        pixels[0, 0, 0] = 1
    assert repr(picture) == f"<tubefoot.Picture 'side': {pixels.shape[1]} x {pixels.shape[0]} pixels>"


def test_results_show_themselves(result):
    page = result._repr_html_()
    shown = re.findall(r'<b>(\w+)</b> (\w+): .*?base64,([^"]+)"', page)
    assert [s[:2] for s in shown] == [("camera", "didson"), ("side", "sidescan"), ("down", "echosounder"),
                                      ("fan", "multibeam"), ("ahead", "imaging")]
    assert base64.b64decode(shown[1][2]) == result["side"].picture()._repr_png_()
    assert "3 pings, 8 beams, 64 samples from" in page and "1 ping, 12 beams" in page


def test_names_cannot_become_markup(folder):
    with netCDF4.Dataset(folder / "odd.nc", "w") as file:
        for name, length in (("ping", 1), ("beam", 3), ("sample", 4)):
            file.createDimension(name, length)
        file.sensor_name = "<b>&"
        for name, dimensions, units, values in [("energy", ("ping", "beam", "sample"), "J m-2", np.ones((1, 3, 4))),
                                                ("slant_range", ("sample",), "m", [1, 2, 3, 4]),
                                                ("beam_azimuth", ("beam",), "degree", [-5, 0, 5])]:
            file.createVariable(name, "f8", dimensions).units = units
            file[name][:] = values
    page = tubefoot.open(folder / "odd.nc")["<b>&"]._repr_html_()
    assert "<b>&lt;b&gt;&amp;</b>" in page and 'alt="&lt;b&gt;&amp;"' in page


def test_a_multibeams_picture_is_the_echogram_of_its_steepest_beam(result):
    picture, fan = result["fan"].picture().pixels, result["fan"]
    steepest = np.argmin(fan.beam_elevations)
    assert fan.beam_elevations[steepest] == pytest.approx(-90, abs=1)
    bright = picture.astype(int).sum(axis=2)[:, 150:700]
    rows = np.flatnonzero(bright.max(axis=1) > 500)
    assert len(rows)  # the bottom, 2 m below
    sample = fan.energy[0, steepest].argmax()
    assert fan.slant_ranges[sample] == pytest.approx(2, abs=0.1)


def test_one_ping_of_what_is_drawn_side_by_side(result):
    for sensor in ("side", "down", "fan"):
        with pytest.raises(tubefoot.UsageError, match=f"sensor '{sensor}' has no picture of a single ping"):
            result[sensor].picture(0)
    with pytest.raises(IndexError, match="ping 3: sensor 'camera' has pings 0 to 2"):
        result["camera"].picture(3)
    with pytest.raises(tubefoot.UsageError, match="ping: expected a whole number, not 'first'"):
        result["camera"].picture("first")
    with pytest.raises(tubefoot.UsageError, match="no ping to draw"):
        result["camera"][3:].picture()


def test_a_slice_is_drawn_by_itself(result, folder):
    camera, side = result["camera"], result["side"]
    whole, part = camera.picture(1).pixels, camera[1].picture().pixels
    assert np.array_equal(part, whole)  # title and all: a slice's pings keep their numbers
    assert (camera[:].picture().pixels == camera.picture().pixels).all()
    assert not np.array_equal(camera[::-1].picture().pixels, camera.picture().pixels)
    assert (side[[0, 1]].picture().pixels == side.picture().pixels).all()


def test_places_that_cannot_be_written(result, folder):
    picture = result["camera"].picture(0)
    with pytest.raises(tubefoot.UsageError, match="the name of a picture must end in .png"):
        picture.save(folder / "picture.jpg")
    with pytest.raises(tubefoot.UsageError):
        picture.save(folder / "scene.toml" / "picture.png")
    assert not list(folder.glob("picture*"))


def test_two_receivers_are_drawn_as_their_waterfall(folder):
    (folder / "two.toml").write_text(SCENE.replace('kind = "sidescan"', 'kind = "interferometric"'))
    result = tubefoot.run(folder / "two.toml", output=folder / "two")
    assert bytes_of(result["side"].picture(), folder) == (folder / "two" / "side.png").read_bytes()
    again = result["side"][:].picture().pixels  # of one channel
    assert (again == result["side"].picture().pixels).all()
