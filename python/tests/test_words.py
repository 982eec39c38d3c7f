# SPDX-License-Identifier: GPL-3.0-or-later
"""Messages speak Python: arguments in place of the command line's options."""

import inspect
import re

import pytest

import tubefoot
from conftest import SOURCES
from tubefoot._words import in_python

# Of commands that the module has not, and of several processes.
ELSEWHERE = ("src/run/partial_run.cpp", "src/run/part_run.cpp", "src/run/ranks/", "src/viewer/", "src/compare/", "src/import/",
             "src/exchange/", "src/propagation/", "src/suite/", "src/strength/", "src/app/")


@pytest.mark.parametrize("command, python", [
    ("--tolerance selects engine and settings: leave out --rays-per-beam, or --tolerance",
     "tolerance selects engine and settings: leave out rays_per_beam, or tolerance"),
    ("add --engine ray, or leave it out", 'add engine="ray", or leave it out'),
    ("certified bounds need footprints: use --binning exact", 'certified bounds need footprints: use binning="exact"'),
    ("--tolerance of a --reference must be a relative bound", "tolerance of tubefoot.reference must be a relative bound"),
    ("use 'run --reference' for smaller errors", "use tubefoot.reference for smaller errors"),
    ("compare different scenes with --any-scene", "compare different scenes with any_scene=True"),
    ("--beams '3:2': the sensor has beams 0 to 7", "beams '3:2': the sensor has beams 0 to 7"),
    ("use `gdal_translate --config GDAL_NETCDF_BOTTOMUP NO bed.nc bed_new.tif` with --beams 3",
     "use `gdal_translate --config GDAL_NETCDF_BOTTOMUP NO bed.nc bed_new.tif` with beams 3"),
    ("scene.toml:3:1: 5 -- 7 and 'a--b' stay -1", "scene.toml:3:1: 5 -- 7 and 'a--b' stay -1"),
])
def test_options_become_arguments(command, python):
    assert in_python(command) == python


def messages():
    """Texts in the C++ sources that name an option, with their files."""
    for folder in ("src", "sensors", "geometry"):
        for file in sorted((SOURCES / folder).rglob("*.cpp")):
            place = str(file.relative_to(SOURCES))
            if place.startswith(ELSEWHERE):
                continue
            for literal in re.findall(r'"((?:[^"\\\n]|\\.)*)"', file.read_text()):
                if re.search(r"--(?!config )[a-z]", literal):  # --config is GDAL's
                    yield place, literal


def test_every_option_that_a_message_names_is_an_argument():
    known = {name for function in map(tubefoot.__dict__.get, tubefoot.__all__) if inspect.isfunction(function)
             for name in inspect.signature(function).parameters} | {"tubefoot"}
    found = list(messages())
    assert len(found) > 10
    for place, literal in found:
        said = in_python(literal)
        assert "--" not in said, (place, said)
        for option in re.findall(r"--([a-z-]*[a-z])", literal):
            words = in_python("--" + option)
            assert re.match(r"\w+", words)[0] in known, f"{place}: {literal!r} names {words}, which is no argument"


@pytest.mark.parametrize("call, text", [
    (lambda s: tubefoot.footprints(s, "camera", pings=7), "pings '7': the sensor has pings 0 to 2"),
    (lambda s: tubefoot.footprints(s, "camera", beams="9"), "beams '9': the sensor has beams 0 to 7"),
    (lambda s: tubefoot.footprints(s, "camra"),
     "the scene has no sensor 'camra'; it has 'camera', 'side': did you mean 'camera'?"),
    (lambda s: tubefoot.coverage(s, "sid"), "the scene has no sensor 'sid'; it has 'camera', 'side': did you mean 'side'?"),
    (lambda s: tubefoot.coverage(s, pings="3:1"), "pings '3:1': the sensor has pings 0 to 2"),
    (lambda s: tubefoot.chart(s, "tubes"), "engines: 'tubes' is not 'tube' or 'ray': did you mean 'tube'?"),
    (lambda s: tubefoot.advise(s, 1e-9), None),
])
def test_errors_name_arguments(scene, call, text):
    with pytest.raises(tubefoot.UsageError) as error:
        call(scene)
    assert "--" not in str(error.value) and (text is None or str(error.value) == text)


def test_columns_that_were_meant(scene):
    with pytest.raises(KeyError, match="no column 'area'.*did you mean 'area_m2'"):
        tubefoot.footprints(scene, "camera", 0)["area"]
    with pytest.raises(KeyError, match="no column 'seenm2'.*did you mean 'seen_m2'"):
        tubefoot.coverage(scene, "camera", 0)["seenm2"]


@pytest.mark.parametrize("call, name", [
    (lambda s: tubefoot.shot(s, "camera"), "'shot' is now 'transmission'"),
    (lambda s: tubefoot.Shot, "'Shot' is now 'Transmission'"),
    (lambda s: s.shots("camera"), "'shots' is now 'transmissions'"),
    (lambda s: tubefoot.history(s, "camera", shot=0), "'shot' is now 'transmission'"),
    (lambda s: tubefoot.history(s, "camera").shot.shot, "'shot' is now 'transmission'"),
    (lambda s: tubefoot.footprints(s, "camera")["shot"], "'shot' is now 'transmission'"),
    (lambda s: tubefoot.footprints(s, "camera")["mirrors_home"], "'mirrors_home' is now 'rx_reflections'"),
    (lambda s: tubefoot.transmission(s, "camera").staff_m, "'staff_m' is now 'receiver_baseline_m'"),
    (lambda s: tubefoot.advise(s, "50%", pings=2), "'pings' of advise"),
    (lambda s: tubefoot.chart(s, "tube", pings=1, repeats=1, seconds=0.1), "use '0:0'"),
    (lambda s: tubefoot.chart(s, "tube", pings=1000, repeats=1, seconds=0.1), "is deprecated"),
])
def test_former_names_warn(scene, call, name):
    with pytest.warns(DeprecationWarning, match=re.escape(name)):
        call(scene)
