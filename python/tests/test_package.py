# SPDX-License-Identifier: GPL-3.0-or-later
"""The package itself: hints, docstrings, where it is installed, the tutorial."""

import inspect
import os
import pathlib
import re
import shutil
import subprocess
import sys
import typing

import numpy as np
import pytest

import tubefoot
from conftest import PROGRAM, SOURCES

BUILD = pathlib.Path(os.environ["TUBEFOOT_BUILD"])


def public_functions():
    for name in tubefoot.__all__:
        item = getattr(tubefoot, name)
        if not inspect.isclass(item):
            yield name, item
        elif item.__module__.startswith("tubefoot"):
            for member, value in vars(item).items():
                value = value.__func__ if isinstance(value, classmethod) else value
                value = value.fget if isinstance(value, property) else value
                if inspect.isfunction(value) and not member.startswith("_"):
                    yield f"{name}.{member}", value


@pytest.mark.parametrize("name, function", public_functions())
def test_everything_public_has_hints_and_says_what_it_does(name, function):
    signature = inspect.signature(function)
    for parameter in list(signature.parameters.values()):
        if parameter.name not in ("self", "cls"):
            assert parameter.annotation is not inspect.Parameter.empty, f"{name}({parameter.name})"
    assert signature.return_annotation is not inspect.Signature.empty, name
    if name != "Engine.checked":
        hints = {k: v for k, v in function.__annotations__.items() if "xarray" not in v and "geopandas" not in v}
        for hint in hints.values():  # every name in a hint exists
            eval(hint, vars(sys.modules[function.__module__]) | vars(typing))
    assert function.__doc__ and function.__doc__.strip().endswith((".", ")", ":")), name


def test_arrays_say_shape_and_unit():
    for cls in (tubefoot.Transmission, tubefoot.History, tubefoot.SensorResult, tubefoot.Footprints, tubefoot.Coverage,
                tubefoot.Picture, tubefoot.Signals):
        for member, value in vars(cls).items():
            if isinstance(value, property) and "ndarray" in value.fget.__annotations__["return"]:
                assert re.match(r"\([\w, +]*\) (float64|int64|uint8|uint16|uint32|uint64|complex128|text)", value.__doc__), member


def test_hints_of_the_native_module_are_complete():
    hints = (SOURCES / "python/tubefoot/_native.pyi").read_text()
    native = tubefoot._native
    for name in dir(native):
        if name.startswith("__"):
            continue
        item = getattr(native, name)
        assert re.search(rf"^(class|def) {name}\b|^{name}: ", hints, re.M), name
        if inspect.isclass(item):
            body = re.search(rf"^class {name}:\n((?:    .*\n)+)", hints, re.M)[1]
            own = {m for m in vars(item) if not m.startswith("_")}
            assert own == set(re.findall(r"^    (?:def )?(\w+)", body, re.M)), name
    assert (pathlib.Path(tubefoot.__file__).parent / "py.typed").exists()


@pytest.mark.parametrize("call, text", [
    (lambda: tubefoot.run("x.toml", engin="ray"), "run() has no argument 'engin': did you mean 'engine'?"),
    (lambda: tubefoot.run("x.toml", ray_per_beam=3), "run() has no argument 'ray_per_beam': did you mean 'rays_per_beam'?"),
    (lambda: tubefoot.footprints("x.toml", "camera", beem=3), "footprints() has no argument 'beem': did you mean 'beams'?"),
    (lambda: tubefoot.Scene.from_dict({}, bas="."), "from_dict() has no argument 'bas': did you mean 'base'?"),
    (lambda: tubefoot.run("x.toml", wibble=3), "run() has no argument 'wibble'"),
])
def test_a_misspelt_argument_is_told_what_was_meant(call, text):
    with pytest.raises(TypeError) as error:
        call()
    assert str(error.value) == text


def test_signatures_are_those_of_the_functions():
    assert str(inspect.signature(tubefoot.open)) == "(result: 'PathLike') -> 'Result'"
    assert tubefoot.run.__module__ == "tubefoot._result" and "engine" in inspect.signature(tubefoot.run).parameters


def test_the_version_is_the_programs():
    said = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True).stdout
    assert said.splitlines()[0].split() == ["tubefoot", tubefoot.__version__]


def test_an_installed_module_needs_nothing_but_its_folder(tmp_path, folder):
    prefix = tmp_path / "prefix"
    subprocess.run(["cmake", "--install", str(BUILD), "--component", "python", "--prefix", str(prefix)], check=True,
                   capture_output=True)
    place = prefix / "lib/python3/dist-packages"
    assert sorted(p.name for p in place.iterdir()) == ["tubefoot"]
    script = (f"import sys; sys.path.insert(0, {str(place)!r}); import tubefoot; "
              f"print(tubefoot.__file__); print(tubefoot.run(tubefoot.load({str(folder / 'scene.toml')!r})).stats['pings'])")
    done = subprocess.run(["/usr/bin/python3", "-I", "-c", script], capture_output=True, text=True, cwd=tmp_path,
                          env={"PATH": "/usr/bin"})
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == [str(place / "tubefoot/__init__.py"), "5"]


@pytest.mark.parametrize("prefix, place", [
    ("/usr", "usr/lib/python3/dist-packages"),
    ("/usr/local", f"usr/local/lib/python3.{sys.version_info.minor}/dist-packages"),
])
def test_it_is_installed_where_debians_python_looks(tmp_path, prefix, place):
    subprocess.run(["cmake", "--install", str(BUILD), "--component", "python", "--prefix", prefix], check=True,
                   capture_output=True, env={**os.environ, "DESTDIR": str(tmp_path)})
    assert [p.parent for p in tmp_path.rglob("tubefoot/__init__.py")] == [tmp_path / place / "tubefoot"]
    said = subprocess.run(["/usr/bin/python3", "-I", "-c", "import sys; print(*sys.path, sep='\\n')"], check=True,
                          capture_output=True, text=True).stdout
    assert "/" + place in said.splitlines()


def test_the_tutorial_runs(tmp_path, monkeypatch):
    text = (SOURCES / "docs/python.md").read_text()
    blocks = re.findall(r"```python\n(.*?)```", text, re.S)
    assert len(blocks) >= 6
    shutil.copytree(SOURCES / "scenes/chart", tmp_path / "scenes/chart")
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "tutorial"}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)
